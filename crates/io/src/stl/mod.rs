//! STL files: triangles without shared vertices, as binary and as text.
//!
//! Corners at the same position, bit for bit (−0 equals 0), are welded into one vertex. Normals in
//! the file are ignored on reading and computed on writing. If a text file has several solids with
//! facets, they become named objects, and the scene is written as text again: binary files have no
//! names.

mod binary;
#[cfg(test)]
mod tests;
mod text;
mod weld;

use std::io::{Error, ErrorKind, Result as IoResult, Write};

use glam::DVec3;
use meshlod_mesh::Mesh;

use crate::error::ParseError;
use crate::precision::Precision;
use crate::scene::Scene;

pub use binary::{FACET, corners, facet_at, write};
pub use text::write as write_ascii;

/// Bytes at the beginning searched for zeros to recognise binary files. A binary file of one facet
/// is shorter than this, and its facet contains a zero byte in practice.
pub const SNIFFED: usize = 512;

/// Parses an STL file, binary or text, without its notes: see [`read_scene`].
///
/// # Errors
/// Those of [`read_scene`].
pub fn read(bytes: &[u8]) -> Result<Mesh, ParseError> {
    Ok(read_scene(bytes)?.meshes.swap_remove(0).mesh)
}

/// Parses an STL file, binary or text, as one mesh under one node.
///
/// Vertices are numbered in order of appearance. A facet whose corners coincide is kept, as a face
/// that repeats a vertex. Solids without facets, the attribute bytes of binary facets, which some
/// programs use for colours, and bytes after the last facet are noted. Cost: O(n) expected, n =
/// facets. Memory: at most a small multiple of `bytes`, whatever the header claims.
/// # Errors
/// Anything that is not a mesh of at least one face, with the line of text or byte of binary data.
pub fn read_scene(bytes: &[u8]) -> Result<Scene, ParseError> {
    if bytes.is_empty() {
        return Err(ParseError::byte(0, "the file is empty"));
    }
    if is_text(bytes, bytes.len() as u64) {
        return text::read(bytes);
    }
    let (mesh, notes) = binary::read(bytes)?;
    Ok(Scene { notes, ..Scene::from_mesh("", mesh) })
}

/// Returns the number of facets in a binary file of a length in bytes, by its first [`SNIFFED`]
/// bytes or all; `None` if it is text. They are in it, as [`facet_at`] says.
///
/// # Errors
/// Those of [`read_scene`] about the number of facets.
pub fn binary_facets(head: &[u8], length: u64) -> Result<Option<u64>, ParseError> {
    if head.is_empty() {
        return Err(ParseError::byte(0, "the file is empty"));
    }
    match is_text(head, length) {
        true => Ok(None),
        false => binary::facets(head, length).map(|facets| Some(facets.count)),
    }
}

/// Writes the meshes that a scene shows as one: as text if the scene was read from several solids,
/// else in binary form, which ignores `precision`.
///
/// # Errors
/// Those of [`write()`] and [`write_ascii`].
pub fn write_scene(scene: &Scene, precision: Precision, out: &mut dyn Write) -> IoResult<()> {
    let mesh = scene.shown_mesh();
    if scene.has_solids { write_ascii(&mesh, precision, out) } else { write(&mesh, out) }
}

/// Reports whether a file of a length in bytes, which begins with `bytes`, is text. Binary files that begin with "solid" are recognised by a length
/// that matches their count, or by zero bytes near the beginning.
fn is_text(bytes: &[u8], length: u64) -> bool {
    let begins =
        bytes.trim_ascii_start().get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    begins
        && !binary::has_fitting_length(bytes, length)
        && !bytes[..bytes.len().min(SNIFFED)].contains(&0)
}

/// Returns the unit normal of a triangle, or zero if it has no area.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

fn invalid(reason: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Error {
    Error::new(ErrorKind::InvalidInput, reason)
}
