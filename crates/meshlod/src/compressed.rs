//! A mesh or a scene to a compressed file in one call.

use std::path::{Path, PathBuf};

use meshlod_codec::{
    CompressError, CompressionTarget, Lattice, LatticeError, Malformed, Scheme, StripsError,
    Transport, TransportError, TransportFile, TransportOptions, TransportQuantization,
};
use meshlod_io::{IoError, Scene, write_file};
use meshlod_mesh::{AttributeBounds, Mesh};
use meshlod_multires::FileError;
use meshlod_simplify::Options;
use meshlod_strip::StripQuality;
use thiserror::Error;

use crate::{Constraints, PlaceError, compressed_strips, place_scene};

/// Options for writing a compressed mesh file with [`compress`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct CompressOptions {
    /// Accuracy or size that the positions must reach; the default is 11 bits per axis.
    pub target: CompressionTarget,
    /// Scheme by which positions are encoded: any in `.mlq`, by default blocks; only the lattice in
    /// `.mlz`.
    pub scheme: Option<Scheme>,
    /// Largest errors allowed for normals, texture coordinates, colours and all other attributes.
    pub attributes: AttributeBounds,
    /// Quality of the triangle strips that faces of parts are stored as; `None` for fewer bits that
    /// must be decoded to draw them.
    pub strips: Option<StripQuality>,
}

impl Default for CompressOptions {
    fn default() -> Self {
        let attributes = AttributeBounds::default();
        Self { target: CompressionTarget::Bits(11), scheme: None, attributes, strips: None }
    }
}

/// Contents and size of the file that [`compress`] wrote.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CompressReport {
    /// Number of vertices in the file.
    pub vertices: usize,
    /// Number of faces in the file; degenerate faces of the mesh are left out.
    pub faces: usize,
    /// Size of the file in bytes.
    pub bytes: usize,
    /// True if the target was met. A mesh can be too small for the requested reduction in size.
    pub reached: bool,
}

/// Reason why a compressed file cannot be written or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CompressedFileError {
    /// The file cannot be read or written.
    #[error(transparent)]
    Io(#[from] IoError),
    /// The file name ends in neither `.mlq` nor `.mlz`.
    #[error("{}: a compressed file must end in .mlq or .mlz", .0.display())]
    UnknownFormat(PathBuf),
    /// A `.mlz` file was requested with a scheme or a target that only `.mlq` supports.
    #[error(
        "a .mlz file takes a number of bits or an error, no scheme but the lattice, and no strips"
    )]
    Unsupported,
    /// Strips were requested, but positions are not in parts.
    #[error(transparent)]
    Strips(#[from] StripsError),
    /// The mesh to compress or the target is invalid.
    #[error(transparent)]
    Compress(#[from] CompressError),
    /// The mesh cannot be encoded as a `.mlz` file.
    #[error(transparent)]
    Transport(#[from] TransportError),
    /// The cells of the lattice would be too small or too large to encode.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The scene cannot be merged into one mesh.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// A part of the scene cannot be stored.
    #[error(transparent)]
    Scene(#[from] FileError),
    /// The file is damaged or is not a compressed mesh.
    #[error("{}: {source}", path.display())]
    Malformed {
        /// Path of the damaged file.
        path: PathBuf,
        /// Description of the defect and its place in the file.
        source: Malformed,
    },
}

/// Compresses a mesh to a file: `.mlq`, which can be drawn from directly, or the smaller `.mlz`,
/// for transmission.
///
/// Both hold the faces with their attributes, and the names of materials and objects;
/// [`compress_scene`] adds the rest of a scene. The file is written whole or not at all.
/// [`codec`](crate::codec) has the parts.
///
/// # Errors
/// Another suffix, an invalid mesh, a target that the format does not support, and errors of the
/// file system.
///
/// ```
/// use meshlod::{CompressOptions, compress, decompress, samples};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("gyroid.mlz");
///
/// let gyroid = samples::gyroid(6_000);
/// let report = compress(&gyroid, &path, &CompressOptions::default())?;
/// assert!(report.bytes < 4 * gyroid.faces.len(), "less than 4 bytes per face");
/// assert_eq!(decompress(&path)?.faces.len(), gyroid.faces.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compress(
    mesh: &Mesh,
    path: &Path,
    options: &CompressOptions,
) -> Result<CompressReport, CompressedFileError> {
    compress_with(mesh, Vec::new(), path, options)
}

/// Compresses a mesh as [`compress`] does, and returns the bytes of the file. Only the suffix of
/// `path` counts.
///
/// # Errors
/// As [`compress`], but for those of the file system.
pub fn compress_bytes(
    mesh: &Mesh,
    path: &Path,
    options: &CompressOptions,
) -> Result<(Vec<u8>, CompressReport), CompressedFileError> {
    encode(mesh, Vec::new(), path, options)
}

/// Compresses a scene to a file as [`compress`] does: all its meshes, each once, as [`place_scene`]
/// merges them, and nodes, materials with images, skins and animations beside them. Decompress it
/// with [`decompress_scene`](crate::decompress_scene).
///
/// # Errors
/// As [`compress`], and a scene that does not match its source.
pub fn compress_scene(
    scene: Scene,
    path: &Path,
    options: &CompressOptions,
) -> Result<CompressReport, CompressedFileError> {
    let placed = place_scene(scene, &Constraints::default(), Options::default())?;
    let resources = placed.rest.map(|rest| rest.to_bytes()).transpose()?.unwrap_or_default();
    compress_with(&placed.mesh, resources, path, options)
}

fn compress_with(
    mesh: &Mesh,
    resources: Vec<u8>,
    path: &Path,
    options: &CompressOptions,
) -> Result<CompressReport, CompressedFileError> {
    let (bytes, report) = encode(mesh, resources, path, options)?;
    write_file(path, &bytes)?;
    Ok(report)
}

fn encode(
    mesh: &Mesh,
    resources: Vec<u8>,
    path: &Path,
    options: &CompressOptions,
) -> Result<(Vec<u8>, CompressReport), CompressedFileError> {
    let suffix = path.extension().map(|suffix| suffix.to_ascii_lowercase());
    match suffix.as_ref().and_then(|suffix| suffix.to_str()) {
        Some("mlq") => for_drawing(mesh, resources, options),
        Some("mlz") => for_transport(mesh, &resources, options),
        _ => Err(CompressedFileError::UnknownFormat(path.to_owned())),
    }
}

fn for_drawing(
    mesh: &Mesh,
    resources: Vec<u8>,
    options: &CompressOptions,
) -> Result<(Vec<u8>, CompressReport), CompressedFileError> {
    let scheme = options.scheme.unwrap_or(Scheme::Blocks);
    let done = meshlod_codec::compress(mesh, scheme, options.target, &options.attributes)?;
    let compressed = match options.strips {
        Some(quality) => compressed_strips(done.compressed, quality)?,
        None => done.compressed,
    };
    let (vertices, faces) = (compressed.vertices(), compressed.faces());
    let bytes = compressed.with_resources(resources).to_bytes();
    let report = CompressReport { vertices, faces, bytes: bytes.len(), reached: done.reached };
    Ok((bytes, report))
}

fn for_transport(
    mesh: &Mesh,
    resources: &[u8],
    options: &CompressOptions,
) -> Result<(Vec<u8>, CompressReport), CompressedFileError> {
    if options.strips.is_some() {
        return Err(CompressedFileError::Unsupported);
    }
    let quantization = transport_quantization(mesh, options)?;
    let attributes = options.attributes;
    let options = TransportOptions { quantization, attributes, ..TransportOptions::default() };
    let done = Transport::encode_with_resources(mesh, resources, &options)?;
    let file = TransportFile::open(&done.bytes).expect("a file just encoded opens");
    let (vertices, faces) = (file.vertices(), file.faces());
    let report = CompressReport { vertices, faces, bytes: done.bytes.len(), reached: true };
    Ok((done.bytes, report))
}

/// Returns the cells that meet the target in a `.mlz` file.
fn transport_quantization(
    mesh: &Mesh,
    options: &CompressOptions,
) -> Result<TransportQuantization, CompressedFileError> {
    let Some(cell) = options.target.cell(mesh)? else {
        return Err(CompressedFileError::Unsupported);
    };
    match (options.scheme, options.target) {
        (Some(Scheme::Lattice), _) => Ok(TransportQuantization::Lattice(Lattice::within(cell)?)),
        (Some(_), _) => Err(CompressedFileError::Unsupported),
        (None, CompressionTarget::Bits(bits)) => Ok(TransportQuantization::Bits(bits)),
        (None, _) => {
            let bounds = mesh.bounds();
            let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
            let bits = (longest / cell + 1.0).log2().ceil() as u32;
            Ok(TransportQuantization::Bits(bits.max(1)))
        }
    }
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;
    use crate::decompress;

    #[test]
    fn every_format_and_target_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = samples::fish(1_500);
        let error = CompressionTarget::Error(1e-3);
        for (name, target, scheme) in [
            ("a.mlq", CompressionTarget::Bits(11), None),
            ("b.mlq", error, Some(Scheme::Lattice)),
            ("c.MLQ", CompressionTarget::Reduction(0.5), None),
            ("d.mlz", CompressionTarget::Bits(11), None),
            ("e.mlz", error, None),
            ("f.mlz", error, Some(Scheme::Lattice)),
        ] {
            let path = folder.path().join(name);
            let options = CompressOptions { target, scheme, ..Default::default() };
            let report = compress(&mesh, &path, &options).unwrap();
            let decoded = decompress(&path).unwrap();
            assert_eq!(report.bytes as u64, std::fs::metadata(&path).unwrap().len(), "{name}");
            assert_eq!((report.reached, report.faces), (true, mesh.faces.len()), "{name}");
            assert_eq!(decoded.faces.len(), mesh.faces.len(), "{name}");
            let layers = |mesh: &Mesh| mesh.attributes.as_ref().map(|of| of.layers.len());
            assert_eq!(layers(&decoded), layers(&mesh), "{name}");
        }
    }

    #[test]
    fn what_a_file_cannot_hold_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = samples::sphere(100);
        let refused = |name: &str, options: &CompressOptions| {
            let path = folder.path().join(name);
            let error = compress(&mesh, &path, options).unwrap_err().to_string();
            assert!(!path.exists());
            error
        };
        let default = CompressOptions::default();
        assert!(refused("a.ply", &default).ends_with("must end in .mlq or .mlz"));
        let reduction = CompressOptions { target: CompressionTarget::Reduction(0.5), ..default };
        assert!(refused("a.mlz", &reduction).starts_with("a .mlz file takes"));
        let blocks = CompressOptions { scheme: Some(Scheme::Blocks), ..default };
        assert!(refused("a.mlz", &blocks).starts_with("a .mlz file takes"));
        let path = folder.path().join("b.mlq");
        std::fs::write(&path, b"something else").unwrap();
        assert!(decompress(&path).unwrap_err().to_string().contains("b.mlq"));
    }
}
