//! Fast path for the most common PLY files: binary, with floating-point x, y, z and triangles only.
//!
//! Both functions stop before the first row of another shape, truncated, not finite or out of
//! range. The general path continues from there and reports errors.

use meshlod_mesh::VertexId;

use super::binary_body::little;
use super::header::{Element, Shape};
use super::scalar::Scalar;

/// Bytes of a face with three 32-bit indices and an 8-bit length.
pub(super) const TRIANGLE_ROW: usize = 13;

/// Appends the positions of leading rows and returns their number.
///
/// `xyz` are the indices of the coordinate properties.
pub(super) fn positions<const BIG: bool>(
    bytes: &[u8],
    element: &Element,
    xyz: [usize; 3],
    positions: &mut Vec<[f64; 3]>,
) -> usize {
    if !element.is_fixed() {
        return 0;
    }
    let rows = whole_rows(bytes, element.least_row_size(), element.count);
    let offsets = xyz.map(|property| {
        element.properties[..property].iter().map(|before| before.shape.least_size()).sum()
    });
    match xyz.map(|property| element.properties[property].shape) {
        [Shape::One(Scalar::F32), Shape::One(Scalar::F32), Shape::One(Scalar::F32)] => {
            gather(rows, offsets, positions, |raw| f32::from_le_bytes(little::<4, BIG>(raw)).into())
        }
        [Shape::One(Scalar::F64), Shape::One(Scalar::F64), Shape::One(Scalar::F64)] => {
            gather(rows, offsets, positions, |raw| f64::from_le_bytes(little::<8, BIG>(raw)))
        }
        _ => 0,
    }
}

/// Iterates over the rows that are complete.
fn whole_rows(bytes: &[u8], size: usize, count: u64) -> std::slice::ChunksExact<'_, u8> {
    let there = (bytes.len() / size) as u64;
    bytes[..there.min(count) as usize * size].chunks_exact(size)
}

fn gather<const N: usize>(
    rows: std::slice::ChunksExact<'_, u8>,
    offsets: [usize; 3],
    positions: &mut Vec<[f64; 3]>,
    value: impl Fn([u8; N]) -> f64,
) -> usize {
    let before = positions.len();
    positions.reserve_exact(rows.len());
    for row in rows {
        let position = offsets.map(|at| value(*row[at..].first_chunk().expect("inside the row")));
        if !position.iter().all(|x| x.is_finite()) {
            break;
        }
        positions.push(position);
    }
    positions.len() - before
}

/// Appends leading faces while they are triangles with valid indices, and returns their number.
pub(super) fn triangles<const BIG: bool>(
    bytes: &[u8],
    element: &Element,
    vertices: usize,
    triangles: &mut Vec<[VertexId; 3]>,
) -> usize {
    let limit = match element.properties[..] {
        [ref list] => match list.shape {
            Shape::List { length: Scalar::U8 | Scalar::I8, item: Scalar::U32 } => u32::MAX,
            // Read as unsigned, a negative index exceeds every vertex.
            Shape::List { length: Scalar::U8 | Scalar::I8, item: Scalar::I32 } => 1 << 31,
            _ => return 0,
        },
        _ => return 0,
    };
    let limit = limit.min(u32::try_from(vertices).unwrap_or(u32::MAX));
    let rows = whole_rows(bytes, TRIANGLE_ROW, element.count);
    let before = triangles.len();
    triangles.reserve_exact(rows.len());
    for row in rows {
        let index = |at: usize| {
            let raw = row[at..].first_chunk().expect("inside the row");
            u32::from_le_bytes(little::<4, BIG>(*raw))
        };
        let face = [index(1), index(5), index(9)];
        if row[0] != 3 || face.iter().any(|&v| v >= limit) {
            break;
        }
        triangles.push(face.map(VertexId));
    }
    triangles.len() - before
}
