//! What is known where a face is put on the border, before it is told.

use super::border::{Border, EdgeState};

/// What a vertex is guessed from: the edge that its first face was put on, and what is around.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Gate {
    pub(super) a: u16,
    pub(super) b: u16,
    pub(super) apex: u16,
    pub(super) previous_apex: u16,
    pub(super) previous: u16,
    pub(super) next: u16,
    /// None where there is no edge, for a corner of a face that stands alone; then the other is the corner's number.
    pub(super) faces_a: u8,
    pub(super) faces_b: u8,
}

impl Gate {
    pub(super) fn corner(number: u8) -> Self {
        Self { faces_b: number, ..Self::default() }
    }

    #[inline(always)]
    pub(super) fn at(border: &Border, at: u16) -> Self {
        let node = border.node(at);
        let second = border.node(node.next);
        Self {
            a: node.vertex,
            b: second.vertex,
            apex: node.apex,
            previous_apex: node.previous_apex,
            previous: border.node(node.previous).vertex,
            next: border.node(second.next).vertex,
            faces_a: border.faces_at(node.vertex),
            faces_b: border.faces_at(second.vertex),
        }
    }
}

/// What a step is guessed from.
#[inline(always)]
pub(super) fn context(border: &Border, at: u16) -> usize {
    let node = border.node(at);
    let second = border.node(node.next);
    let count = |vertex: u16| usize::from(border.faces_at(vertex));
    let is_closed = |node: u16| usize::from(border.node(node).state == EdgeState::Closed);
    let a = count(node.vertex).clamp(1, 7) - 1;
    let b = count(second.vertex).clamp(1, 6) - 1;
    ((a * 6 + b) * 2 + is_closed(node.previous)) * 2 + is_closed(node.next)
}
pub(super) const CONTEXTS: usize = 7 * 6 * 4;

/// By how many nodes the vertex of [`Step::Other`](super::border::Step::Other) is next the edge's first one, or previous; and
/// how many of 256 are so far. Of ten meshes' 13,000 nine of ten are two before.
pub(super) const NEARBY: [(i32, u16); 7] =
    [(-2, 222), (-3, 18), (-4, 5), (3, 4), (4, 2), (-5, 2), (5, 1)];
/// What is left, for all others: their nodes are told.
pub(super) const NEARBY_BITS: u32 = 8;
pub(super) const NODE_BITS: u32 = 12;

/// The node so many next another, or before.
pub(super) fn node_at_offset(border: &Border, at: u16, by: i32) -> u16 {
    let next = |at, _| border.node(at).next;
    let previous = |at, _| border.node(at).previous;
    if by < 0 { (by..0).fold(at, previous) } else { (0..by).fold(at, next) }
}
