//! The surface of a cut: splits and merges, each with the rule that it must obey.

use super::triangles::{MAX_SEARCHED, NEXT, Spoke, Triangles};
use crate::forest::MAX_RANKED;
use crate::forest::{MAX_LEVELS, NONE};
use crate::implicit::{Implicit, Wing};

/// The corner of a vertex that is not there yet.
const ABSENT: u32 = NONE - 1;
/// That of one that has been split.
const SPLIT: u32 = NONE - 2;

/// The active vertices and the triangles between them.
#[derive(Clone, Debug)]
pub(super) struct Front<'m> {
    pub(super) mt: &'m Implicit,
    /// By node.
    vertices: Vec<Vertex>,
    pub(super) triangles: Triangles,
    /// How many vertices are there.
    active: usize,
    /// Room for what is around a vertex.
    star: Vec<Spoke>,
    /// Room for the nodes around, each once and in order.
    ring: Vec<u32>,
}

/// What is wanted of the vertices around a split or a merge, beside the list of its corners.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    /// Its first corner; [`ABSENT`] or [`SPLIT`] where it is not there.
    corner: u32,
    /// The level of the update that splits it; 0 for a leaf. In the highest bit whether that update
    /// is on the schedule, which outlives the vertex.
    level: u16,
    /// The level of the update that made it; the highest for a root.
    above: u16,
}

const SCHEDULED: u16 = MAX_LEVELS;

/// How a vertex stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VertexState {
    /// Not there: above it some vertex has not been split.
    Absent,
    /// There.
    Active,
    /// Not there: it has been split.
    Split,
}

impl<'m> Front<'m> {
    /// The base mesh.
    pub(super) fn new(mt: &'m Implicit) -> Self {
        let absent = Vertex { corner: ABSENT, level: 0, above: 0 };
        let mut this = Self {
            mt,
            vertices: vec![absent; mt.node_count()],
            triangles: Triangles::default(),
            active: 0,
            star: Vec::new(),
            ring: Vec::new(),
        };
        for (root, _) in mt.roots() {
            this.enter(root, u16::MAX);
        }
        for &face in mt.base() {
            this.add(face);
        }
        this
    }

    /// How many vertices there are.
    pub(super) fn vertex_count(&self) -> usize {
        self.active
    }

    #[inline]
    pub(super) fn state(&self, node: u32) -> VertexState {
        match self.vertices[node as usize].corner {
            ABSENT => VertexState::Absent,
            SPLIT => VertexState::Split,
            _ => VertexState::Active,
        }
    }

    #[inline]
    pub(super) fn is_scheduled(&self, node: u32) -> bool {
        self.vertices[node as usize].level & SCHEDULED != 0
    }

    #[inline]
    pub(super) fn set_scheduled(&mut self, node: u32, is_scheduled: bool) {
        let level = &mut self.vertices[node as usize].level;
        *level = *level & !SCHEDULED | if is_scheduled { SCHEDULED } else { 0 };
    }

    /// Whether all around an update's node, which must be there, is coarse enough to split it; adds to
    /// `first` the updates that must come first.
    pub(super) fn may_split(&mut self, update: u32, first: &mut Vec<u32>) -> bool {
        let (node, level) = (self.mt.parent(update), self.mt.level(update));
        let Self { mt, vertices, star, .. } = self;
        star.clear();
        self.triangles.gather(vertices[node as usize].corner, star);
        let waiting = first.len();
        let mut look = |n: u32| {
            if vertices[n as usize].level & !SCHEDULED > level {
                first.push(mt.update_of(n).expect("a leaf's level is 0"));
            }
        };
        star.iter().for_each(|spoke| look(spoke.a));
        if mt.is_open(update) {
            // Somebody is around whom no face follows.
            star.iter().for_each(|spoke| look(spoke.b));
        }
        first.len() == waiting
    }

    /// Splits an update's node, which must be there, if all around it is coarse enough; else adds to
    /// `first` the updates that must come first.
    pub(super) fn split(&mut self, update: u32, first: &mut Vec<u32>) -> bool {
        let may_split = self.may_split(update, first);
        if may_split {
            self.make(update);
        }
        may_split
    }

    /// Makes an update that [`may_split`](Self::may_split) was just asked for.
    pub(super) fn make(&mut self, update: u32) {
        let (node, level) = (self.mt.parent(update), self.mt.level(update));
        let [first, second] = self.mt.children(update);
        self.vertices[node as usize].corner = SPLIT;
        self.active -= 1;
        self.enter(first, level);
        self.enter(second, level);
        let (run, created) = self.part(update);
        for i in 0..self.star.len() {
            let child = if i < run { second } else { first };
            let Vertex { corner, .. } = &mut self.vertices[child as usize];
            self.triangles.give(self.star[i].corner, child, corner);
        }
        created.into_iter().flatten().for_each(|face| self.add(face));
        if created == [None; 2]
            && let Some(non_fan) = self.mt.non_fan_split(update)
        {
            for &face in &non_fan.created_faces {
                // Of a file that nobody has proved it may be anything.
                if face.iter().all(|&node| self.is_active(node)) {
                    self.add(face);
                }
            }
        }
    }

    /// Moves the triangles of the second child to the front of the star; how many those are, and the
    /// triangles that wings bring.
    fn part(&mut self, update: u32) -> (usize, [Option<[u32; 3]>; 2]) {
        let Self { mt, star, .. } = self;
        let mut run = 0;
        let wings = mt.wings(update);
        if wings == [Wing::None; 2]
            && let Some(non_fan) = mt.non_fan_split(update)
        {
            for i in 0..star.len() {
                if non_fan.second.contains(&[star[i].a, star[i].b]) {
                    star.swap(run, i);
                    run += 1;
                }
            }
            return (run, [None; 2]);
        }
        let [start, end] = find(star, wings);
        let (mut at, stop, backwards) = match (start, end) {
            (Some(start), end) => (start, end, false),
            (None, end) => (end.unwrap_or(NONE), None, true),
        };
        while Some(at) != stop {
            let from = |s: &Spoke| (if backwards { s.b } else { s.a }) == at;
            let Some(found) = star[run..].iter().position(from) else { break };
            star.swap(run, run + found);
            at = if backwards { star[run].a } else { star[run].b };
            run += 1;
        }
        let [first, second] = mt.children(update);
        let created = [start.map(|w| [first, w, second]), end.map(|w| [second, w, first])];
        (run, created)
    }

    /// Undoes a split if nothing depends on it: all around is as it was recorded; false else.
    ///
    /// An update that is glued goes back whole.
    pub(super) fn merge(&mut self, update: u32) -> bool {
        let fused_with_child = self.mt.is_fused_with_child(update);
        let [first, second] = self.mt.children(update);
        let inner = if fused_with_child { self.mt.children(update + 1) } else { [first; 2] };
        let parts = [second, inner[0], inner[1]];
        if parts.iter().any(|&child| self.state(child) != VertexState::Active) {
            return false;
        }
        let level = self.mt.level(update);
        let is_needed = |n: u32| !parts.contains(&n) && !self.is_made_above(n, level);
        // Most that are held are held by one of the first few.
        let is_held = |&child: &u32| {
            let mut around = self.triangles.around(self.vertices[child as usize].corner);
            around.any(|spoke| is_needed(spoke.a) || is_needed(spoke.b))
        };
        if parts[..if fused_with_child { 3 } else { 2 }].iter().any(is_held) {
            return false;
        }
        if fused_with_child {
            self.join(update + 1);
        }
        self.join(update);
        true
    }

    /// Makes one of an update's children again.
    fn join(&mut self, update: u32) {
        let node = self.mt.parent(update);
        let [first, second] = self.mt.children(update);
        let above = self.mt.creator(node).map_or(u16::MAX, |up| self.mt.level(up));
        self.star.clear();
        for child in [first, second] {
            self.triangles.gather(self.vertices[child as usize].corner, &mut self.star);
            self.vertices[child as usize].corner = ABSENT;
        }
        self.active -= 2;
        self.enter(node, above);
        for i in 0..self.star.len() {
            let Spoke { corner, a, b } = self.star[i];
            let mut others = [a, b].into_iter().filter(|&n| n != first && n != second);
            match (others.next(), others.next()) {
                (Some(_), Some(_)) => {
                    let Vertex { corner: list, .. } = &mut self.vertices[node as usize];
                    self.triangles.give(corner, node, list);
                }
                // It is met from both ends and goes with the first.
                (Some(wing), None) if self.is_first(i) => {
                    self.remove(corner / 3, wing, [first, second, node]);
                }
                _ => {}
            }
        }
    }

    /// Takes away a triangle that is at no vertex any more but one. `joined` are those whose lists are
    /// not what they should be just now.
    fn remove(&mut self, t: u32, wing: u32, joined: [u32; 3]) {
        let Self { triangles, vertices, .. } = self;
        let list = &mut vertices[wing as usize].corner;
        if triangles.unlink(t, list, MAX_SEARCHED) {
            triangles.remove(t);
            return;
        }
        // At a hub, to search the whole list for each would take time by the square of its length. But
        // one from its start may go where the triangle was, for the other two lists that it is in are
        // short.
        let Some(other) = triangles.take(list, joined) else {
            triangles.unlink(t, list, usize::MAX);
            triangles.remove(t);
            return;
        };
        let at = triangles.nodes(t).iter().position(|&node| node == wing);
        let (mut to, mut from) = (at.expect("a wing is a corner"), other as usize % 3);
        for _ in 0..2 {
            (to, from) = (NEXT[to], NEXT[from]);
            let node = triangles.nodes(other / 3)[from];
            let [corner, by] = [other / 3 * 3 + from as u32, 3 * t + to as u32];
            triangles.replace(corner, by, node, &mut vertices[node as usize].corner);
        }
        triangles.remove(other / 3);
    }

    /// Whether a triangle of the star has not been met before.
    fn is_first(&self, place: usize) -> bool {
        let t = self.star[place].corner / 3;
        self.star[..place].iter().all(|spoke| spoke.corner / 3 != t)
    }

    /// What was around the vertex that was split last, or that may be split now.
    pub(super) fn last_star(&self) -> &[Spoke] {
        &self.star
    }

    /// Whether a vertex is there.
    pub(super) fn is_active(&self, node: u32) -> bool {
        self.state(node) == VertexState::Active
    }

    /// Whether a vertex, which must be there, is a root or was made by an update of a higher level.
    #[inline]
    pub(super) fn is_made_above(&self, node: u32, level: u16) -> bool {
        self.vertices[node as usize].above > level
    }

    /// Appends the triangles around a vertex, which must be there, to `star`.
    pub(super) fn gather(&self, node: u32, star: &mut Vec<Spoke>) {
        self.triangles.gather(self.vertices[node as usize].corner, star);
    }

    /// The nodes around a vertex, each once or twice.
    pub(super) fn around(&mut self, node: u32) -> &[u32] {
        let Self { star, ring, triangles, vertices, .. } = self;
        star.clear();
        triangles.gather(vertices[node as usize].corner, star);
        ring.clear();
        ring.extend(star.iter().flat_map(|spoke| [spoke.a, spoke.b]));
        ring
    }

    fn enter(&mut self, node: u32, above: u16) {
        let level = self.mt.update_of(node).map_or(0, |update| self.mt.level(update));
        let vertex = &mut self.vertices[node as usize];
        *vertex = Vertex { corner: NONE, level: vertex.level & SCHEDULED | level, above };
        self.active += 1;
    }

    fn add(&mut self, face: [u32; 3]) {
        let t = self.triangles.add();
        for (k, &node) in face.iter().enumerate() {
            let Vertex { corner, .. } = &mut self.vertices[node as usize];
            self.triangles.give(3 * t + k as u32, node, corner);
        }
    }
}

/// The nodes around a star that wings are; none where so many are around that there are no ranks.
#[inline]
pub(super) fn find(star: &[Spoke], wings: [Wing; 2]) -> [Option<u32>; 2] {
    let ranks = wings.map(|wing| if let Wing::Rank(rank) = wing { rank.into() } else { NONE });
    let mut found = [None; 2];
    if star.len() > MAX_RANKED {
        return found;
    }
    // Counting all is quicker than sorting these few, or than stopping early.
    for spoke in star {
        let below: u32 = star.iter().map(|other| u32::from(other.a < spoke.a)).sum();
        for (found, rank) in found.iter_mut().zip(ranks) {
            if below == rank {
                *found = Some(spoke.a);
            }
        }
    }
    for (found, _) in found.iter_mut().zip(wings).filter(|(_, wing)| *wing == Wing::Last) {
        let is_followed = |n: u32| star.iter().any(|spoke| spoke.a == n);
        *found = star.iter().map(|spoke| spoke.b).find(|&n| !is_followed(n));
    }
    found
}
