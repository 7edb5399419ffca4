//! Multiresolution files in one call: all levels of a mesh to a file.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use meshlod_io::{IoError, Scene, write_file};
use meshlod_mesh::Mesh;
use meshlod_multires::{Archive, Certificate, ErrorKind, FileError, Forest, Storage, StoredErrors};
use meshlod_simplify::{Method, Options, SimplifyError};
use thiserror::Error;

use crate::{Constraints, CutVolumeError};

/// Options for writing a multiresolution file with [`build`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct BuildOptions {
    /// Simplification method whose contractions define the levels.
    pub method: Method,
    /// Whether the stored errors are estimates, measured, or proven bounds. Measuring takes several
    /// times as long as estimates.
    pub errors: ErrorKind,
    /// True to keep the vertices of the mesh bit for bit, so that the finest level equals the mesh.
    pub lossless: bool,
    /// Precision of the stored vertices, and size of the chunks that are read one by one.
    pub storage: Storage,
    /// Constraints that every level satisfies. The topology is kept whatever they say, so that no
    /// component vanishes, and tied vertices are locked.
    pub constraints: Constraints,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            method: Method::LindstromTurk,
            errors: ErrorKind::Measured,
            lossless: false,
            storage: Storage::default(),
            constraints: Constraints::default(),
        }
    }
}

/// Contents and size of the file that [`build`] wrote.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BuildReport {
    /// Number of faces of the finest level, which leaves out degenerate and duplicate faces of the
    /// mesh.
    pub full_faces: usize,
    /// Number of faces of the coarsest level.
    pub base_faces: usize,
    /// Number of refinement steps between the coarsest level and the finest.
    pub updates: usize,
    /// Proof that no level has a crack.
    pub certificate: Certificate,
    /// Size of the file in bytes.
    pub bytes: usize,
}

/// Reason why a multiresolution file cannot be built, or a mesh extracted from it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LevelsError {
    /// The file cannot be read or written.
    #[error(transparent)]
    Io(#[from] IoError),
    /// The mesh cannot be built into levels, the file is damaged, or the query is invalid.
    #[error("{}: {source}", path.display())]
    File {
        /// Path of the multiresolution file.
        path: PathBuf,
        /// Description of the problem.
        source: FileError,
    },
    /// The extracted mesh cannot get the volume asked for.
    #[error("{}: {source}", path.display())]
    Volume {
        /// Path of the multiresolution file.
        path: PathBuf,
        /// Description of the problem.
        source: CutVolumeError,
    },
}

/// Writes all levels of detail of a mesh to a `.mlod` file, and proves that no level has a crack.
///
/// The file holds the surface with its attributes, and the names of materials and objects;
/// [`place_scene`](crate::place_scene) has what it takes to put a whole scene into it. It is written
/// whole or not at all. [`multires`](crate::multires) has the parts, also for height fields.
///
/// Cost: O(n log n), n = faces, and several times that for [`ErrorKind::Bound`].
/// # Errors
/// A mesh that cannot be simplified, a rounding that is negative or larger than the mesh, and
/// errors of the file system.
///
/// ```
/// use meshlod::{BuildOptions, ExtractOptions, build, extract, samples};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("torus.mlod");
///
/// let torus = samples::torus(3_000);
/// let report = build(&torus, &path, &BuildOptions::default())?;
/// assert_eq!(report.full_faces, torus.faces.len());
///
/// let options = ExtractOptions { max_faces: Some(500), ..Default::default() };
/// assert!(extract(&path, &options)?.faces.len() <= 500);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn build(mesh: &Mesh, path: &Path, options: &BuildOptions) -> Result<BuildReport, LevelsError> {
    let (bytes, report) = build_bytes(mesh, options)
        .map_err(|source| LevelsError::File { path: path.to_owned(), source })?;
    write_file(path, &bytes)?;
    Ok(report)
}

/// Builds all levels of detail of a mesh as [`build`] does, and returns the bytes of the file.
///
/// # Errors
/// As [`build`], but for those of the file system.
pub fn build_bytes(
    mesh: &Mesh,
    options: &BuildOptions,
) -> Result<(Vec<u8>, BuildReport), FileError> {
    let record = if options.lossless { Forest::lossless } else { Forest::new };
    let simplify = Options { method: options.method, ..Options::default() };
    let (mesh, simplify) = constrained(mesh, &options.constraints, simplify)
        .map_err(|error| FileError::Build(error.into()))?;
    let mut forest = record(&mesh, &simplify)?;
    match options.errors {
        ErrorKind::Estimate | ErrorKind::Measured => forest.smooth_errors(),
        ErrorKind::Bound => forest.measure_bounds(),
    }
    let mut storage = options.storage;
    if options.errors == ErrorKind::Measured {
        storage.errors = StoredErrors::Measured;
    }
    let (bytes, certificate) = Archive::write(&forest, &storage)?;
    let archive = Archive::open(bytes)?;
    let (base_faces, updates) = (archive.base_faces(), archive.update_count());
    let (full_faces, bytes) = (forest.full_faces(), archive.into_source());
    let report = BuildReport { full_faces, base_faces, updates, certificate, bytes: bytes.len() };
    Ok((bytes, report))
}

/// Returns the mesh to simplify, fused if that is asked for, with the constrained options.
fn constrained<'m>(
    mesh: &'m Mesh,
    constraints: &Constraints,
    options: Options,
) -> Result<(Cow<'m, Mesh>, Options), SimplifyError> {
    if *constraints == Constraints::default() {
        return Ok((Cow::Borrowed(mesh), options));
    }
    let mut scene = Scene::from_mesh("", mesh.clone());
    constraints.fuse(&mut scene);
    let (mesh, options) = constraints.flatten(scene, options)?;
    Ok((Cow::Owned(mesh), options))
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::{Connectivity, VertexId};
    use meshlod_multires::{Focus, Query};
    use meshlod_samples as samples;
    use meshlod_simplify::Digits;

    use super::*;
    use crate::{ExtractOptions, extract};

    #[test]
    fn a_lossless_file_restores_the_mesh() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("knot.mlod");
        let mesh = samples::knot(1_000);
        let report = build(&mesh, &path, &BuildOptions { lossless: true, ..Default::default() });
        let report = report.unwrap();
        assert_eq!(report.bytes as u64, std::fs::metadata(&path).unwrap().len());
        let finest = extract(&path, &ExtractOptions::default()).unwrap();
        assert_eq!(finest.faces.len(), mesh.faces.len());
        let sorted = |mesh: &Mesh| {
            let mut bits: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::to_bits)).collect();
            bits.sort_unstable();
            bits
        };
        assert_eq!(sorted(&finest), sorted(&mesh));
    }

    #[test]
    fn bounds_and_budgets_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sphere.mlod");
        let options = BuildOptions { errors: ErrorKind::Bound, ..Default::default() };
        let report = build(&samples::sphere(500), &path, &options).unwrap();
        let budget = ExtractOptions { max_faces: Some(100), ..Default::default() };
        assert!((report.base_faces..=100).contains(&extract(&path, &budget).unwrap().faces.len()));
        let focus = Focus::Sphere { center: [0.0, 1.0, 0.0], radius: 0.3 };
        let query = Query { focus, ..Query::uniform(0.0) };
        let whole = ExtractOptions { query, ..Default::default() };
        let cropped = ExtractOptions { crop: true, ..whole.clone() };
        let faces = |options| extract(&path, options).unwrap().faces.len();
        assert!(faces(&cropped) < faces(&whole));
    }

    #[test]
    fn constraints_hold_in_every_level() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("terrain.mlod");
        let mesh = samples::terrain(600);
        let constraints = Constraints { lock_boundary: true, ..Constraints::default() };
        let options = BuildOptions { lossless: true, constraints, ..Default::default() };
        let free = BuildOptions { lossless: true, ..Default::default() };
        let boundary = |options| {
            build(&mesh, &path, options).unwrap();
            let coarsest = ExtractOptions { query: Query::uniform(f64::MAX), ..Default::default() };
            let level = extract(&path, &coarsest).unwrap();
            let connectivity = Connectivity::new(&level.faces, level.positions.len());
            let on = |v: &usize| connectivity.marks(VertexId::new(*v)).boundary();
            let places = (0..level.positions.len()).filter(on).map(|v| level.positions[v]);
            let mut bits: Vec<_> = places.map(|p| p.map(f64::to_bits)).collect();
            bits.sort_unstable();
            bits
        };
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let on = |v: &usize| connectivity.marks(VertexId::new(*v)).boundary();
        let places = (0..mesh.positions.len()).filter(on).map(|v| mesh.positions[v]);
        let mut expected: Vec<_> = places.map(|p| p.map(f64::to_bits)).collect();
        expected.sort_unstable();
        assert_eq!(boundary(&options), expected);
        assert!(boundary(&free).len() < expected.len());
    }

    #[test]
    fn a_cut_has_the_volume_of_the_mesh() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("knot.mlod");
        let mesh = samples::knot(4_000);
        build(&mesh, &path, &BuildOptions { lossless: true, ..Default::default() }).unwrap();
        let off = |options: &ExtractOptions<'_>| {
            let cut = extract(&path, options).unwrap();
            (meshlod_measure::volume(&cut) / meshlod_measure::volume(&mesh) - 1.0).abs()
        };
        let focus = Focus::Sphere { center: [0.9, 0.0, 0.0], radius: 0.2 };
        let near = Query { focus, ..Query::uniform(0.001) };
        let exact_volume = Some(Digits::F64);
        for query in [near, Query::uniform(0.02)] {
            let cut = ExtractOptions { query, ..Default::default() };
            assert!(off(&cut) > 1e-9, "{:e}", off(&cut));
            let exact = ExtractOptions { exact_volume, ..cut };
            assert!(off(&exact) < 1e-14, "{:e}", off(&exact));
        }
        let cropped = ExtractOptions { crop: true, exact_volume, ..Default::default() };
        let refused = extract(&path, &cropped).unwrap_err().to_string();
        assert!(refused.contains("a cropped cut"), "{refused}");
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 100]).unwrap();
        let whole = ExtractOptions { exact_volume, ..Default::default() };
        let refused = extract(&path, &whole).unwrap_err().to_string();
        assert!(refused.contains("chunks are there"), "{refused}");
    }

    #[test]
    fn failures_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("empty.mlod");
        let options = BuildOptions::default();
        let refused = build(&Mesh::default(), &path, &options).unwrap_err().to_string();
        assert!(refused.contains("empty.mlod") && !path.exists(), "{refused}");
        std::fs::write(&path, b"not one").unwrap();
        let refused = extract(&path, &ExtractOptions::default()).unwrap_err().to_string();
        assert!(refused.contains("empty.mlod"), "{refused}");
    }
}
