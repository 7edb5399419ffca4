//! Binary STL: an 80-byte header, the number of facets, and 50 bytes per facet.

use std::io::{Result as IoResult, Write};

use glam::DVec3;
use meshlod_mesh::Mesh;

use super::weld::Welder;
use super::{invalid, normal};
use crate::error::ParseError;
use crate::notes::Note;

const HEADER: usize = 80;
const PREAMBLE: usize = HEADER + 4;
/// Bytes of a facet of a binary file: normal and three corners as 32-bit floats, and two bytes
/// without a fixed meaning.
pub const FACET: usize = 50;

/// Counts of writers that stream facets before they know how many there are.
const UNKNOWN: [u64; 2] = [0, u32::MAX as u64];

/// Reports whether the length of a file matches its count of facets exactly.
pub(super) fn has_fitting_length(head: &[u8], length: u64) -> bool {
    claimed(head).is_some_and(|count| facet_at(count) == length)
}

fn claimed(head: &[u8]) -> Option<u64> {
    let count = head.get(HEADER..)?.first_chunk()?;
    Some(u32::from_le_bytes(*count).into())
}

/// Facets of a file.
pub(super) struct Facets {
    pub count: u64,
    /// True if the header does not say how many there are.
    pub is_unknown: bool,
}

/// Counts the facets of a file of a length in bytes, by its beginning.
pub(super) fn facets(head: &[u8], length: u64) -> Result<Facets, ParseError> {
    let end = usize::try_from(length).unwrap_or(usize::MAX);
    let Some(claimed) = claimed(head) else {
        let reason = "not an STL file: it neither begins with \"solid\" as text does, nor is it \
                      as long as a binary header";
        return Err(ParseError::byte(end, reason));
    };
    let body = length - facet_at(0);
    let (there, is_whole) = (body / FACET as u64, body.is_multiple_of(FACET as u64));
    let is_unknown = UNKNOWN.contains(&claimed) && there > 0 && is_whole;
    let count = if is_unknown { there } else { claimed };
    if there < count {
        let reason = format!("the file ends inside facet {there} of {count}");
        return Err(ParseError::byte(end, reason));
    }
    if count == 0 {
        return Err(ParseError::byte(HEADER, "no faces: the number of facets is 0"));
    }
    Ok(Facets { count, is_unknown })
}

/// Returns the byte of a binary file that a facet begins at, counted from 0.
pub fn facet_at(facet: u64) -> u64 {
    PREAMBLE as u64 + facet * FACET as u64
}

/// Returns the corners of facet `facet` of `count`, by the [`FACET`] bytes of its row.
///
/// # Errors
/// A coordinate that is not finite.
pub fn corners(row: &[u8; FACET], facet: u64, count: u64) -> Result<[[f64; 3]; 3], ParseError> {
    let corners = [12, 24, 36].map(|at| [0, 4, 8].map(|axis| float(row, at + axis)));
    match corners.iter().find(|corner| !corner.iter().all(|x| x.is_finite())) {
        None => Ok(corners),
        Some(corner) => {
            let reason =
                format!("facet {facet} of {count} has a coordinate that is not finite: {corner:?}");
            Err(ParseError::byte(facet_at(facet) as usize, reason))
        }
    }
}

/// Reads the facets declared in the header, and notes data beyond corners and normals.
pub(super) fn read(bytes: &[u8]) -> Result<(Mesh, Vec<Note>), ParseError> {
    let Facets { count, is_unknown } = facets(bytes, bytes.len() as u64)?;
    let claimed = count as usize;
    let body = &bytes[PREAMBLE..];
    let mut welder = Welder::with_facets(claimed);
    let mut faces = Vec::with_capacity(claimed);
    let mut colored = 0;
    for (i, facet) in body.as_chunks::<FACET>().0.iter().take(claimed).enumerate() {
        faces.push(corners(facet, i as u64, count)?.map(|corner| welder.vertex(corner)));
        colored += usize::from(facet[48..] != [0; 2]);
    }
    let mut notes = vec![
        Note::left_out(
            colored,
            "attribute of a facet, such as its colour",
            "attributes of facets, such as their colours",
        )
        .remedied("export colours as .ply, .obj or .glb"),
        Note::changed(
            usize::from(is_unknown),
            "number of facets taken from the length of the file",
            "numbers of facets taken from the length of the file",
        ),
        Note::left_out(
            body.len() - claimed * FACET,
            "byte behind the last facet",
            "bytes behind the last facet",
        )
        .remedied("if they are facets, correct the count at byte 80"),
    ];
    notes.retain(|note| note.count > 0);
    Ok((Mesh::new(welder.positions, faces), notes))
}

fn float(facet: &[u8], at: usize) -> f64 {
    f32::from_le_bytes(*facet[at..].first_chunk().expect("inside the facet")).into()
}

/// Writes a mesh as a binary STL file: 32-bit coordinates and computed facet normals, without
/// attributes or names.
///
/// # Errors
/// Errors of `out`. Before anything is written: a mesh that breaks [`Mesh::validate`], and a
/// coordinate that is not finite as a 32-bit float.
pub fn write(mesh: &Mesh, out: &mut dyn Write) -> IoResult<()> {
    mesh.validate().map_err(invalid)?;
    let large = |position: &[f64; 3]| position.iter().any(|&x| !(x as f32).is_finite());
    if let Some(vertex) = mesh.positions.iter().position(large) {
        let position = mesh.positions[vertex];
        let reason = format!("vertex {vertex} at {position:?} does not fit in 32-bit floats");
        return Err(invalid(reason));
    }
    let count = u32::try_from(mesh.faces.len()).map_err(invalid)?;
    let mut preamble = [b' '; PREAMBLE];
    preamble[..7].copy_from_slice(b"meshlod");
    preamble[HEADER..].copy_from_slice(&count.to_le_bytes());
    out.write_all(&preamble)?;
    let append = |triangle: [DVec3; 3], block: &mut Vec<u8>| {
        let [a, b, c] = triangle;
        for vector in [normal(triangle), a, b, c] {
            for x in vector.as_vec3().to_array() {
                block.extend_from_slice(&x.to_le_bytes());
            }
        }
        block.extend_from_slice(&[0; 2]);
    };
    write_blocks(mesh.faces.iter().map(|&face| mesh.triangle(face)), append, out)
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
