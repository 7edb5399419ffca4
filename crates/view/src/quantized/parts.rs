//! Parts: four bytes a vertex, and an offset for each part.

use std::borrow::Cow;
use std::ops::Range;

use meshlod::codec::{Malformed, StoredMesh, StoredParts};

use super::data::SchemeData;
use super::pipelines::SchemeShader;

/// Parts of one instance: as many as a byte can number.
pub(super) const RUN: usize = 256;

/// Returns bytes and offsets of parts.
///
/// # Errors
/// A face with corners in two parts.
pub(super) fn data<'a>(
    parts: &StoredParts<'a>,
    stored: &StoredMesh<'a>,
) -> Result<SchemeData<'a>, Malformed> {
    check(parts, stored)?;
    let middle = middle(parts);
    let offset = |of: [i32; 3]| {
        let [x, y, z] = [0, 1, 2].map(|axis| of[axis] - middle[axis]);
        [x, y, z, 0]
    };
    let offsets: Vec<[i32; 4]> = parts.parts.iter().map(|part| offset(part.offset)).collect();
    let mut bytes = Vec::with_capacity(4 * parts.positions.len());
    for (number, part) in parts.parts.iter().enumerate() {
        let nodes = part.nodes.start as usize..part.nodes.end as usize;
        bytes.extend(parts.positions[nodes].iter().flat_map(|&[x, y, z]| [x, y, z, number as u8]));
    }
    let cell = parts.cell.map(f64::from);
    let runs = stored.patches.chunks(RUN).map(joined).collect();
    Ok(SchemeData {
        origin: [0, 1, 2].map(|axis| (f64::from(middle[axis]) + parts.within) * cell[axis]),
        scale: cell,
        shader: SchemeShader::Parts,
        fetched: Some(Cow::Owned(bytes)),
        storages: [Cow::Owned(bytemuck::cast_slice(&offsets).to_vec()), Cow::default()],
        runs,
        offsets: Some(offsets),
    })
}

/// Returns the grid cell in the middle of all nodes.
fn middle(parts: &StoredParts<'_>) -> [i32; 3] {
    let (mut low, mut high) = ([i32::MAX; 3], [i32::MIN; 3]);
    for part in parts.parts.iter().filter(|part| !part.nodes.is_empty()) {
        let nodes = part.nodes.start as usize..part.nodes.end as usize;
        for (position, axis) in
            parts.positions[nodes].iter().flat_map(|position| position.iter().zip(0..3))
        {
            let cell = part.offset[axis] + i32::from(*position);
            (low[axis], high[axis]) = (low[axis].min(cell), high[axis].max(cell));
        }
    }
    // Cells are within 2^24, so that sums do not overflow; without nodes there are none.
    [0, 1, 2].map(|axis| if low[axis] > high[axis] { 0 } else { (low[axis] + high[axis]) / 2 })
}

/// Returns the faces of consecutive patches.
fn joined(patches: &[Range<u32>]) -> Range<u32> {
    match patches {
        [] => 0..0,
        [first, .., last] => first.start..last.end,
        [only] => only.clone(),
    }
}

fn check(parts: &StoredParts<'_>, stored: &StoredMesh<'_>) -> Result<(), Malformed> {
    for (number, (part, patch)) in parts.parts.iter().zip(&stored.patches).enumerate() {
        let faces = &stored.faces[patch.start as usize..patch.end as usize];
        if !faces.as_flattened().iter().all(|node| part.nodes.contains(node)) {
            let reason = format!("part {number} has a face with a corner in another part");
            return Err(Malformed { at: 0, reason });
        }
    }
    Ok(())
}
