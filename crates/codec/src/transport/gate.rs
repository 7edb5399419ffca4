//! Gates: edges at which a face is added, with the data that encoder and decoder share there.

use super::border::{Border, EdgeState};

/// Gate: border edge from `a` to `b` at which a vertex is decoded, as in Edgebreaker and [TG98],
/// with the vertices around it from which the new one is predicted.
///
/// `apex` is the third vertex of the known face on the edge, `previous_apex` the one before it in
/// the fan around `a`, `previous` and `next` the neighbours of the edge on the border.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Gate {
    pub(super) a: u16,
    pub(super) b: u16,
    pub(super) apex: u16,
    pub(super) previous_apex: u16,
    pub(super) previous: u16,
    pub(super) next: u16,
    /// Number of known faces at `a`; 0 for a corner of a separate face, which has no edge. Then
    /// `faces_b` is the corner's number.
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

/// Returns the context in which the step at an edge is coded.
#[inline(always)]
pub(super) fn context(border: &Border, at: u16) -> usize {
    let node = border.node(at);
    let second = border.node(node.next);
    let count = |vertex: u16| usize::from(border.faces_at(vertex));
    let is_closed = |node: u16| usize::from(border.node(node).state == EdgeState::Closed);
    let a = count(node.vertex).clamp(1, 7) - 1;
    let b = count(second.vertex).clamp(1, 6) - 1;
    context_of(a, b, is_closed(node.previous), is_closed(node.next))
}

/// Returns the context of an edge, given the numbers of faces at its ends less one, and whether the
/// edges before and after it are closed.
#[inline(always)]
pub(super) fn context_of(a: usize, b: usize, before: usize, after: usize) -> usize {
    ((a * 6 + b) * 2 + before) * 2 + after
}
pub(super) const CONTEXTS: usize = 7 * 6 * 4;

/// Frequent targets of [`Step::Other`](super::border::Step::Other): offset along the loop from the
/// edge's first node, and frequency of 256. On ten meshes with 13,000 such steps, nine of ten lead
/// two nodes back.
pub(super) const NEARBY: [(i32, u16); 7] =
    [(-2, 222), (-3, 18), (-4, 5), (3, 4), (4, 2), (-5, 2), (5, 1)];
/// Bits of the table. What the frequencies leave is the escape to a node's index.
pub(super) const NEARBY_BITS: u32 = 8;
pub(super) const NODE_BITS: u32 = 12;

/// Returns the node at an offset along the loop.
pub(super) fn node_at_offset(border: &Border, at: u16, by: i32) -> u16 {
    let next = |at, _| border.node(at).next;
    let previous = |at, _| border.node(at).previous;
    if by < 0 { (by..0).fold(at, previous) } else { (0..by).fold(at, next) }
}
