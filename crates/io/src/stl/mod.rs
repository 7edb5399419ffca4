//! STL: triangles without indices, as binary and as text.
//!
//! Corners at the same place, bit for bit (and −0 is 0), become one vertex. Normals in the file are
//! passed over when reading and computed when writing. Several solids of a text that have facets
//! become named objects.

mod binary;
#[cfg(test)]
mod tests;
mod text;
mod weld;

use std::io::{Error, ErrorKind, Result as IoResult, Write};

use glam::DVec3;
use meshlod_mesh::Mesh;

use crate::ParseError;

pub use binary::write;
pub use text::write as write_ascii;

/// How much of the beginning tells text from binary: a binary file of one facet is no longer
/// than this, and its facet always holds a zero byte unless someone colours it oddly.
const SNIFFED: usize = 512;

/// The mesh in the bytes of an STL file.
///
/// Vertices are numbered as they first come. A facet that is so small that its corners meet stays,
/// as a face that repeats a vertex.
/// Cost: O(n) expected, n = facets. Memory: no more than a small multiple of `bytes`, whatever the
/// header claims.
/// # Errors
/// Everything that is not a mesh of at least one face, by line of text or byte of binary data.
pub fn read(bytes: &[u8]) -> Result<Mesh, ParseError> {
    if bytes.is_empty() {
        return Err(ParseError::byte(0, "the file is empty"));
    }
    if is_text(bytes) { text::read(bytes) } else { binary::read(bytes) }
}

/// Some binary files begin with "solid" too: one whose length fits its count is binary for
/// certain, and so is one with zero bytes near its beginning.
fn is_text(bytes: &[u8]) -> bool {
    let begins =
        bytes.trim_ascii_start().get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    begins && !binary::has_fitting_length(bytes) && !bytes[..bytes.len().min(SNIFFED)].contains(&0)
}

/// The unit normal of a triangle; zero where it has no area.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

fn invalid(reason: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Error {
    Error::new(ErrorKind::InvalidInput, reason)
}

fn write_blocks<T>(
    rows: impl IntoIterator<Item = T>,
    mut append: impl FnMut(T, &mut Vec<u8>),
    out: &mut dyn Write,
) -> IoResult<()> {
    const BLOCK: usize = 1 << 16;
    let mut block = Vec::with_capacity(BLOCK + BLOCK / 4);
    for row in rows {
        append(row, &mut block);
        if block.len() >= BLOCK {
            out.write_all(&block)?;
            block.clear();
        }
    }
    out.write_all(&block)
}
