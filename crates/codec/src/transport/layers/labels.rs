//! Materials and objects of faces.

use super::adjacency::BlockFaces;
use super::coder::Coder;
use crate::bits::width;

/// Contexts of the bits: whether a face has the label of the face across its first side, and of
/// those across the others; otherwise that of the face before.
pub(super) const LABEL_BITS: usize = 3;

/// Codes the label of each face of a block, one of `count`. Returns `None` if there is no such
/// label.
pub(super) fn code_labels(
    faces: &BlockFaces,
    count: usize,
    context: usize,
    coder: &mut impl Coder,
    source: Option<&[u32]>,
) -> Option<Vec<u32>> {
    let mut labels: Vec<u32> = Vec::with_capacity(faces.faces.len());
    for face in 0..faces.faces.len() {
        let wanted = source.map(|source| source[face]);
        let mut tried: [Option<u32>; 3] = [None; 3];
        let mut label = None;
        for k in 0..3 {
            let across = faces.twin(3 * face + k).map(|twin| twin / 3);
            let other = match across {
                Some(other) if other < face => labels[other],
                _ if k == 2 && tried == [None; 3] && face > 0 => labels[face - 1],
                _ => continue,
            };
            if tried.contains(&Some(other)) {
                continue;
            }
            let context = context + tried.iter().flatten().count();
            tried[k] = Some(other);
            if coder.bit(context, wanted.map(|wanted| wanted == other)) {
                label = Some(other);
                break;
            }
        }
        let label = label.unwrap_or_else(|| coder.number(width(count), wanted));
        if label as usize >= count {
            return None;
        }
        labels.push(label);
    }
    Some(labels)
}
