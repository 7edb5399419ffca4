//! The choice between reading a file in passing and reading it as a whole.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use meshlod_io::{IoError, Scene};

use super::{GltfSource, ObjSource, PlySource, Source, StlSource};

/// Bytes from which a file is read in passing where that is possible. A smaller one takes less
/// memory as a scene than the tiles in the making.
pub const LEAST_STREAMED: u64 = 64 << 20;

/// File that is read in passing.
pub struct Streamed {
    /// Its triangles.
    pub source: Box<dyn Source>,
    /// Names of what a scene of the file would have and the source does not.
    pub left_out: Vec<String>,
    /// Materials, images and notes of the file, if it may have some; its meshes have no faces.
    pub scene: Option<Scene>,
}

/// Opens a file to be read in passing if it has at least a number of bytes, glTF with its buffers and
/// when nothing is compressed, and is binary PLY, binary STL, OBJ or glTF; `None` if it must be read
/// as a whole.
///
/// PLY is told by its content, the others by the suffix of the name. What is read of an OBJ file and
/// what is decompressed goes into files without a name in the folder `scratch`, which must exist.
/// # Errors
/// Errors of the system, and of the header; of OBJ, of all its content, and of glTF, of all but the
/// indices.
pub fn open_stream(path: &Path, least: u64, scratch: &Path) -> Result<Option<Streamed>, IoError> {
    let Ok(facts) = path.metadata() else { return Ok(None) };
    let is_gltf = is_gltf(path);
    if !facts.is_file() || facts.len() < least && !is_gltf {
        return Ok(None);
    }
    stream(path, least, scratch)
        .map_err(|error| error.downcast().unwrap_or_else(|error| IoError::system(path, error)))
}

fn has_suffix(path: &Path, suffix: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(suffix))
}

/// Returns true for a file whose size says little: it may be compressed, or in others.
fn is_gltf(path: &Path) -> bool {
    has_suffix(path, "gltf") || has_suffix(path, "glb")
}

fn stream(path: &Path, least: u64, scratch: &Path) -> io::Result<Option<Streamed>> {
    let mut begins = [0; 3];
    let is_ply = File::open(path)?.read_exact(&mut begins).is_ok() && begins == *b"ply";
    if is_ply {
        let source = PlySource::open(path)?;
        return Ok(source.map(|source| {
            let left_out = source.left_out().to_vec();
            Streamed { source: Box::new(source), left_out, scene: None }
        }));
    }
    let plain = |source: Box<dyn Source>| Streamed { source, left_out: Vec::new(), scene: None };
    if is_gltf(path) {
        let opened = GltfSource::open(path, least, scratch)?;
        return Ok(opened
            .map(|(source, scene)| Streamed { scene: Some(scene), ..plain(Box::new(source)) }));
    }
    if has_suffix(path, "obj") {
        let (source, scene) = ObjSource::open(path, scratch)?;
        return Ok(Some(Streamed { scene: Some(scene), ..plain(Box::new(source)) }));
    }
    if has_suffix(path, "stl") {
        return Ok(StlSource::open(path)?.map(|source| plain(Box::new(source))));
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn large_binary_files_are_read_in_passing() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = meshlod_samples::knot(100);
        let (mut ply, mut stl) = (Vec::new(), Vec::new());
        meshlod_io::ply::write(&mesh, meshlod_io::Precision::Auto, &mut ply).unwrap();
        meshlod_io::stl::write(&mesh, &mut stl).unwrap();
        let text = b"ply\nformat ascii 1.0\nelement vertex 0\nproperty int x\nproperty int y\n\
                     property int z\nelement face 0\nproperty list int int vertex_index\nend_header\n";
        let cases: [(&str, &[u8], u64, bool); 7] = [
            ("a.ply", &ply, 100, true),
            ("a.PLY.txt", &ply, 100, true),
            ("a.stl", &stl, 100, true),
            ("a.ply", &ply, LEAST_STREAMED, false),
            ("a.ply", text, 100, false),
            ("a.OBJ", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 10, true),
            ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 10, false),
        ];
        for (name, bytes, least, expected) in cases {
            let path = folder.path().join(name);
            fs::write(&path, bytes).unwrap();
            assert_eq!(
                open_stream(&path, least, folder.path()).unwrap().is_some(),
                expected,
                "{name} {least}"
            );
        }
        assert!(open_stream(folder.path(), 0, folder.path()).unwrap().is_none());
        assert!(open_stream(&folder.path().join("none.ply"), 0, folder.path()).unwrap().is_none());
    }
}
