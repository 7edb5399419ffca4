//! The triangles of a cut, and those around each vertex.
//!
//! A corner links to the next corner at the same vertex, so a change moves nothing. What changed since
//! a mark is known: that is what a renderer is told.

use crate::forest::NONE;

/// A triangle that is not there.
const HOLE: [u32; 3] = [NONE; 3];

/// Triangles by corners: corner `3 t + k` is the `k`-th of triangle `t`.
#[derive(Clone, Debug, Default)]
pub(super) struct Triangles {
    all: Vec<Triangle>,
    holes: Vec<u32>,
    mark: u32,
    /// What was changed since the mark, as it was then.
    changed: Vec<(u32, [u32; 3])>,
}

/// On one line of cache: whoever meets one wants all of it.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Triangle {
    nodes: [u32; 3],
    /// The next corner at each of the nodes.
    next: [u32; 3],
    /// The mark at which it was last changed.
    changed_at: u32,
}

/// A triangle at a vertex: the corner there, and the two nodes that follow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spoke {
    pub(super) corner: u32,
    pub(super) a: u32,
    pub(super) b: u32,
}

impl Spoke {
    /// The triangle.
    #[inline]
    pub(super) fn triangle(&self) -> u32 {
        self.corner / 3
    }
}

impl Triangles {
    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.all.len() - self.holes.len()
    }

    /// A triangle by its nodes.
    pub(super) fn nodes(&self, t: u32) -> [u32; 3] {
        self.all[t as usize].nodes
    }

    /// Those there are, by their places and nodes.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, [u32; 3])> + '_ {
        let all = self.all.iter().enumerate().map(|(t, triangle)| (t as u32, triangle.nodes));
        all.filter(|&(_, nodes)| nodes != HOLE)
    }

    /// All places, also those without a triangle.
    pub(super) fn places(&self) -> usize {
        self.all.len()
    }

    /// Forgets what changed until now.
    pub(super) fn mark(&mut self) {
        self.mark = self.mark.wrapping_add(1);
        self.changed.clear();
    }

    /// What changed since the mark: the place, what was there, and what is there now.
    pub(super) fn changes(
        &self,
    ) -> impl Iterator<Item = (u32, Option<[u32; 3]>, Option<[u32; 3]>)> {
        let real = |nodes: [u32; 3]| (nodes != HOLE).then_some(nodes);
        let all = self.changed.iter().map(|&(t, was)| (t, was, self.all[t as usize].nodes));
        all.filter(|(_, was, is)| was != is).map(move |(t, was, is)| (t, real(was), real(is)))
    }

    /// Appends what is around a vertex to `star`; `first` is its first corner.
    #[inline]
    pub(super) fn gather(&self, first: u32, star: &mut Vec<Spoke>) {
        let mut corner = first;
        while corner != NONE {
            let (t, k) = (corner as usize / 3, corner as usize % 3);
            let triangle = &self.all[t];
            star.push(Spoke { corner, a: triangle.nodes[NEXT[k]], b: triangle.nodes[LAST[k]] });
            corner = triangle.next[k];
        }
    }

    /// Gives a corner to a vertex, whose first corner it becomes.
    #[inline]
    pub(super) fn give(&mut self, corner: u32, node: u32, first: &mut u32) {
        let triangle = self.touch(corner / 3);
        triangle.nodes[corner as usize % 3] = node;
        triangle.next[corner as usize % 3] = std::mem::replace(first, corner);
    }

    /// A place for a triangle whose corners are all to be given.
    pub(super) fn add(&mut self) -> u32 {
        if let Some(t) = self.holes.pop() {
            return t;
        }
        let changed_at = self.mark.wrapping_sub(1);
        self.all.push(Triangle { nodes: HOLE, next: HOLE, changed_at });
        self.all.len() as u32 - 1
    }

    /// Takes a triangle away; its corners must be in nobody's list any more.
    pub(super) fn remove(&mut self, t: u32) {
        self.touch(t).nodes = HOLE;
        self.holes.push(t);
    }

    /// Takes a triangle's corner out of the list of another vertex that it is at.
    pub(super) fn unlink(&mut self, t: u32, first: &mut u32) {
        let after = |corner: u32| self.all[corner as usize / 3].next[corner as usize % 3];
        if *first / 3 == t {
            *first = after(*first);
            return;
        }
        let mut at = *first;
        while after(at) / 3 != t {
            at = after(at);
        }
        let next = after(after(at));
        self.all[at as usize / 3].next[at as usize % 3] = next;
    }

    /// A triangle that is about to change.
    #[inline]
    fn touch(&mut self, t: u32) -> &mut Triangle {
        let triangle = &mut self.all[t as usize];
        if triangle.changed_at != self.mark {
            triangle.changed_at = self.mark;
            self.changed.push((t, triangle.nodes));
        }
        triangle
    }
}

const NEXT: [usize; 3] = [1, 2, 0];
const LAST: [usize; 3] = [2, 0, 1];
