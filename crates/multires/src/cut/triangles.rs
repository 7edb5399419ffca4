//! The triangles of a cut, and those around each vertex.
//!
//! A corner links to the next corner at the same vertex, so a change moves nothing. What changed since
//! a mark is known: that is what a renderer is told.

use crate::forest::NONE;

/// A triangle that is not there.
const HOLE: [u32; 3] = [NONE; 3];

/// So far lists are searched for a triangle: only hubs have longer ones.
pub(super) const MAX_SEARCHED: usize = 128;

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
    pub(super) fn slots(&self) -> usize {
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
        star.extend(self.around(first));
    }

    /// What is around a vertex, by its first corner.
    #[inline]
    pub(super) fn around(&self, first: u32) -> impl Iterator<Item = Spoke> + '_ {
        let mut corner = first;
        std::iter::from_fn(move || {
            let triangle = self.all.get(corner as usize / 3)?;
            let k = corner as usize % 3;
            let spoke = Spoke { corner, a: triangle.nodes[NEXT[k]], b: triangle.nodes[LAST[k]] };
            corner = triangle.next[k];
            Some(spoke)
        })
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

    /// Takes a triangle's corner out of the list of another vertex that it is at; false where it is not
    /// among so many.
    pub(super) fn unlink(&mut self, t: u32, first: &mut u32, among: usize) -> bool {
        if *first / 3 == t {
            *first = self.after(*first);
            return true;
        }
        let mut at = *first;
        for _ in 0..among {
            let next = self.after(at);
            if next / 3 == t {
                *self.after_mut(at) = self.after(next);
                return true;
            }
            at = next;
        }
        false
    }

    /// Takes out of the list of a vertex a corner near its start, of a triangle without any of some
    /// nodes.
    pub(super) fn take(&mut self, first: &mut u32, without: [u32; 3]) -> Option<u32> {
        let (mut before, mut at) = (NONE, *first);
        for _ in 0..MAX_SEARCHED {
            if self.nodes(at / 3).iter().all(|node| !without.contains(node)) {
                let next = self.after(at);
                *(if before == NONE { first } else { self.after_mut(before) }) = next;
                return Some(at);
            }
            (before, at) = (at, self.after(at));
        }
        None
    }

    /// Puts another corner in the stead of one in the list of its vertex.
    pub(super) fn replace(&mut self, corner: u32, by: u32, node: u32, first: &mut u32) {
        let next = self.after(corner);
        if *first == corner {
            *first = by;
        } else {
            let mut at = *first;
            while self.after(at) != corner {
                at = self.after(at);
            }
            *self.after_mut(at) = by;
        }
        let triangle = self.touch(by / 3);
        triangle.nodes[by as usize % 3] = node;
        triangle.next[by as usize % 3] = next;
    }

    /// The next corner at the same vertex.
    #[inline]
    fn after(&self, corner: u32) -> u32 {
        self.all[corner as usize / 3].next[corner as usize % 3]
    }

    #[inline]
    fn after_mut(&mut self, corner: u32) -> &mut u32 {
        &mut self.all[corner as usize / 3].next[corner as usize % 3]
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

pub(super) const NEXT: [usize; 3] = [1, 2, 0];
const LAST: [usize; 3] = [2, 0, 1];
