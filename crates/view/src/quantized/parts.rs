//! Parts: four bytes a vertex, and an offset for each part.

use std::borrow::Cow;
use std::ops::Range;

use meshlod::codec::{Malformed, StoredMesh, StoredParts};

use super::SchemeData;
use super::pipelines::SchemeShader;

/// Parts of one instance: as many as a byte tells apart.
const RUN: usize = 256;

/// Returns bytes and offsets of parts.
///
/// # Errors
/// A face with corners in two parts.
pub(super) fn data<'a>(
    parts: &StoredParts<'a>,
    stored: &StoredMesh<'a>,
) -> Result<SchemeData<'a>, Malformed> {
    check(parts, stored)?;
    let middle = [0, 1, 2].map(|axis| {
        let offsets = parts.parts.iter().map(|part| part.offset[axis]);
        let (low, high) = (offsets.clone().min().unwrap_or(0), offsets.max().unwrap_or(0));
        // The local cells of the last part follow.
        (low + high + 256) / 2
    });
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
        parts: Some((offsets, cell)),
    })
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
