//! Adjacency of the faces of a block across edges.

/// Faces of a block over its vertices, with the side across each side.
#[derive(Clone, Debug)]
pub(in super::super) struct BlockFaces<'a> {
    pub(super) faces: &'a [[u16; 3]],
    /// For each side, numbered 3 · face + corner, the opposite one; [`NONE`] on the border.
    twins: Vec<u16>,
}

/// No side, wedge or entry.
pub(super) const NONE: u16 = u16::MAX;

impl<'a> BlockFaces<'a> {
    /// Pairs sides that run in opposite directions, in order.
    pub(in super::super) fn new(faces: &'a [[u16; 3]]) -> Self {
        let mut sides = Vec::with_capacity(3 * faces.len());
        for (f, face) in faces.iter().enumerate() {
            for k in 0..3 {
                let [from, to] = [face[k], face[(k + 1) % 3]].map(u64::from);
                let edge = from.min(to) << 16 | from.max(to);
                sides.push(edge << 17 | u64::from(from > to) << 16 | (3 * f + k) as u64);
            }
        }
        sides.sort_unstable();
        let mut twins = vec![NONE; sides.len()];
        for edge in sides.chunk_by(|a, b| a >> 17 == b >> 17) {
            let split = edge.partition_point(|side| side >> 16 & 1 == 0);
            let (there, back) = edge.split_at(split);
            for (&a, &b) in there.iter().zip(back) {
                let [a, b] = [a as u16, b as u16];
                (twins[usize::from(a)], twins[usize::from(b)]) = (b, a);
            }
        }
        Self { faces, twins }
    }

    /// Returns the side across a side, if there is a face.
    #[inline]
    pub(super) fn twin(&self, side: usize) -> Option<usize> {
        let twin = self.twins[side];
        (twin != NONE).then_some(usize::from(twin))
    }
}

/// Returns the next corner of the same face.
#[inline]
pub(super) fn next(corner: usize) -> usize {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

/// Returns the previous corner of the same face.
#[inline]
pub(super) fn previous(corner: usize) -> usize {
    if corner.is_multiple_of(3) { corner + 2 } else { corner - 1 }
}
