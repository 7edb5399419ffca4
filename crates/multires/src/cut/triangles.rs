//! The triangles of a cut, with lists of corners around each vertex.
//!
//! Each corner links to the next corner at the same vertex, so that a change moves no memory. Slots
//! that changed since a mark are recorded for renderers.

use crate::forest::NONE;
use crate::slot_mesh::Patch;

/// An empty slot.
const HOLE: [u32; 3] = [NONE; 3];

/// Longest search in a list of corners; only hubs have longer lists.
pub(super) const MAX_SEARCHED: usize = 128;

/// Triangles by slot. Corner `3 t + k` is the `k`-th of triangle `t`.
#[derive(Clone, Debug, Default)]
pub(super) struct Triangles {
    all: Vec<Triangle>,
    holes: Vec<u32>,
    /// Wedges at the corners of each slot's triangle, if the model has any.
    wedges: Option<Vec<[u32; 3]>>,
    mark: u32,
    /// Slots changed since the mark, with their content at that time.
    changed: Vec<(u32, [u32; 3])>,
}

/// Aligned to a cache line, since all its fields are used together.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Triangle {
    nodes: [u32; 3],
    /// Next corner at each of the nodes.
    next: [u32; 3],
    /// Mark at which it was last changed.
    changed_at: u32,
}

/// A triangle seen from a vertex: its corner there and the next two nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spoke {
    pub(super) corner: u32,
    pub(super) a: u32,
    pub(super) b: u32,
}

impl Spoke {
    /// Returns the triangle's slot.
    #[inline]
    pub(super) fn triangle(&self) -> u32 {
        self.corner / 3
    }
}

impl Triangles {
    /// Creates an empty list, with room for wedges if there are to be any.
    pub(super) fn new(has_wedges: bool) -> Self {
        Self { wedges: has_wedges.then(Vec::new), ..Self::default() }
    }

    /// Makes room for some more triangles at once, and not for twice as many as there are.
    pub(super) fn reserve(&mut self, more: usize) {
        self.all.reserve_exact(more);
        self.wedges.iter_mut().for_each(|wedges| wedges.reserve_exact(more));
    }

    /// Returns the number of triangles.
    pub(super) fn len(&self) -> usize {
        self.all.len() - self.holes.len()
    }

    /// Returns the nodes of a triangle.
    pub(super) fn nodes(&self, t: u32) -> [u32; 3] {
        self.all[t as usize].nodes
    }

    /// Returns the wedges at the corners of a triangle; `None` if the model has none.
    pub(super) fn wedges(&self, t: u32) -> Option<[u32; 3]> {
        self.wedges.as_ref().map(|wedges| wedges[t as usize])
    }

    /// Returns the wedge at a corner of a model that has wedges.
    #[inline]
    pub(super) fn wedge(&self, corner: u32) -> u32 {
        self.wedges.as_ref().map_or(NONE, |wedges| wedges[corner as usize / 3][corner as usize % 3])
    }

    /// Sets the wedge at a corner of a triangle that is being changed.
    #[inline]
    pub(super) fn set_wedge(&mut self, corner: u32, wedge: u32) {
        if let Some(wedges) = &mut self.wedges {
            wedges[corner as usize / 3][corner as usize % 3] = wedge;
        }
    }

    /// Returns the nodes of a triangle; `None` for an empty slot or one that does not exist.
    pub(super) fn real(&self, t: u32) -> Option<[u32; 3]> {
        self.all.get(t as usize).map(|triangle| triangle.nodes).filter(|nodes| *nodes != HOLE)
    }

    /// Returns the wedges at the corners of a triangle; `None` for an empty slot, and in a model
    /// that has none.
    pub(super) fn real_wedges(&self, t: u32) -> Option<[u32; 3]> {
        self.real(t).and_then(|_| self.wedges(t))
    }

    /// Iterates over the triangles by slot and nodes.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, [u32; 3])> + '_ {
        let all = self.all.iter().enumerate().map(|(t, triangle)| (t as u32, triangle.nodes));
        all.filter(|&(_, nodes)| nodes != HOLE)
    }

    /// Returns the number of slots, including empty ones.
    pub(super) fn slots(&self) -> usize {
        self.all.len()
    }

    /// Starts a new record of changes.
    pub(super) fn mark(&mut self) {
        self.mark = self.mark.wrapping_add(1);
        self.changed.clear();
    }

    /// Iterates over the slots changed since the mark.
    pub(super) fn changes(&self) -> impl Iterator<Item = Patch> + '_ {
        let real = |nodes: [u32; 3]| (nodes != HOLE).then_some(nodes);
        let patch = move |&(slot, old): &(u32, [u32; 3])| {
            let new = self.all[slot as usize].nodes;
            (old != new).then(|| Patch { slot, old: real(old), new: real(new) })
        };
        self.changed.iter().filter_map(patch)
    }

    /// Iterates over the slots written since the mark, also where they are as before.
    pub(super) fn touched(&self) -> impl Iterator<Item = u32> + '_ {
        self.changed.iter().map(|&(t, _)| t)
    }

    /// Appends the star of a vertex to `star`, given its first corner.
    #[inline]
    pub(super) fn gather(&self, first: u32, star: &mut Vec<Spoke>) {
        star.extend(self.around(first));
    }

    /// Iterates over the star of a vertex, given its first corner.
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

    /// Inserts a corner at the head of a vertex's list.
    #[inline]
    pub(super) fn attach(&mut self, corner: u32, node: u32, first: &mut u32) {
        let triangle = self.record(corner / 3);
        triangle.nodes[corner as usize % 3] = node;
        triangle.next[corner as usize % 3] = std::mem::replace(first, corner);
    }

    /// Returns a slot for a triangle whose corners are still to be inserted.
    pub(super) fn add(&mut self) -> u32 {
        if let Some(t) = self.holes.pop() {
            return t;
        }
        let changed_at = self.mark.wrapping_sub(1);
        self.all.push(Triangle { nodes: HOLE, next: HOLE, changed_at });
        self.wedges.iter_mut().for_each(|wedges| wedges.push(HOLE));
        self.all.len() as u32 - 1
    }

    /// Frees the slot of a triangle that is in no list any more.
    pub(super) fn remove(&mut self, t: u32) {
        self.record(t).nodes = HOLE;
        self.holes.push(t);
    }

    /// Removes a triangle's corner from a vertex's list, or returns false if it is not among the
    /// first `among`.
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

    /// Removes a corner near the start of a vertex's list whose triangle has none of the nodes
    /// `without`.
    pub(super) fn unlink_without(&mut self, first: &mut u32, without: [u32; 3]) -> Option<u32> {
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

    /// Puts corner `by` in the place of another in the list of its vertex.
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
        let triangle = self.record(by / 3);
        triangle.nodes[by as usize % 3] = node;
        triangle.next[by as usize % 3] = next;
        self.set_wedge(by, self.wedge(corner));
    }

    /// Returns the next corner at the same vertex.
    #[inline]
    fn after(&self, corner: u32) -> u32 {
        self.all[corner as usize / 3].next[corner as usize % 3]
    }

    #[inline]
    fn after_mut(&mut self, corner: u32) -> &mut u32 {
        &mut self.all[corner as usize / 3].next[corner as usize % 3]
    }

    /// Records a triangle before it changes.
    #[inline]
    fn record(&mut self, t: u32) -> &mut Triangle {
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
