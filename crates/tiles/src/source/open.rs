//! The choice between reading a file in passing and reading it as a whole.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use meshlod_io::IoError;

use super::{PlySource, Source, StlSource};

/// Bytes from which a file is read in passing where that is possible. A smaller one takes less
/// memory as a scene than the tiles in the making.
pub const LEAST_STREAMED: u64 = 64 << 20;

/// File that is read in passing.
pub struct Streamed {
    /// Its triangles.
    pub source: Box<dyn Source>,
    /// Names of what a scene of the file would have and the source does not.
    pub left_out: Vec<String>,
}

/// Opens a file to be read in passing if it has at least a number of bytes and is binary PLY or STL;
/// `None` if it must be read as a whole.
///
/// PLY is told by its content, STL by the suffix of its name.
/// # Errors
/// Errors of the system, and of the header.
pub fn open_stream(path: &Path, least: u64) -> Result<Option<Streamed>, IoError> {
    let is_large = path.metadata().is_ok_and(|facts| facts.is_file() && facts.len() >= least);
    if !is_large {
        return Ok(None);
    }
    stream(path)
        .map_err(|error| error.downcast().unwrap_or_else(|error| IoError::system(path, error)))
}

fn stream(path: &Path) -> io::Result<Option<Streamed>> {
    let mut begins = [0; 3];
    let is_ply = File::open(path)?.read_exact(&mut begins).is_ok() && begins == *b"ply";
    if is_ply {
        let source = PlySource::open(path)?;
        return Ok(source.map(|source| {
            let left_out = source.left_out().to_vec();
            Streamed { source: Box::new(source), left_out }
        }));
    }
    if !path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("stl")) {
        return Ok(None);
    }
    let source = StlSource::open(path)?;
    Ok(source.map(|source| Streamed { source: Box::new(source), left_out: Vec::new() }))
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
        let cases: [(&str, &[u8], u64, bool); 5] = [
            ("a.ply", &ply, 100, true),
            ("a.PLY.txt", &ply, 100, true),
            ("a.stl", &stl, 100, true),
            ("a.ply", &ply, LEAST_STREAMED, false),
            ("a.ply", text, 100, false),
        ];
        for (name, bytes, least, expected) in cases {
            let path = folder.path().join(name);
            fs::write(&path, bytes).unwrap();
            assert_eq!(open_stream(&path, least).unwrap().is_some(), expected, "{name} {least}");
        }
        assert!(open_stream(folder.path(), 0).unwrap().is_none());
        assert!(open_stream(&folder.path().join("none.ply"), 0).unwrap().is_none());
    }
}
