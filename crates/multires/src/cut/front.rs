//! The surface of a cut, with guarded splits and merges.

use super::split_wedges::SplitWedges;
use super::triangles::{MAX_SEARCHED, NEXT, Spoke, Triangles};
use crate::forest::MAX_RANKED;
use crate::forest::{MAX_LEVELS, NONE};
use crate::implicit::{Implicit, Wing};
use crate::level::Level;

/// Corner list of a vertex that does not exist yet.
const ABSENT: u32 = NONE - 1;
/// Corner list of a vertex that has been split.
const SPLIT: u32 = NONE - 2;

/// The active vertices and the triangles between them.
#[derive(Clone, Debug)]
pub(super) struct Front<'m> {
    pub(super) mt: &'m Implicit,
    /// State of each node.
    vertices: Vec<Vertex>,
    pub(super) triangles: Triangles,
    /// Number of active vertices.
    active: usize,
    /// Scratch memory for the star of a vertex.
    star: Vec<Spoke>,
    /// Scratch memory for the faces that a split creates.
    created: Vec<[u32; 3]>,
    /// Scratch memory for the neighbours of a vertex.
    ring: Vec<u32>,
    /// Updates applied and undone since they were last taken, if they are recorded.
    pub(super) steps: Option<Vec<SplitOrMerge>>,
}

/// An update that was applied, or undone.
#[derive(Clone, Copy, Debug)]
pub(super) enum SplitOrMerge {
    Split(u32),
    Merge(u32),
}

/// State of a node: its list of corners, and the levels that splits and merges compare.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    /// Head of its list of corners, or [`ABSENT`] or [`SPLIT`] if it is not active.
    corner: u32,
    /// Level of the update that splits it, 0 for a leaf. The highest bit is set while that update
    /// is on the schedule, which may outlive the vertex.
    level: u16,
    /// Level of the update that created it, the maximum for a root.
    above: u16,
}

const SCHEDULED: u16 = MAX_LEVELS;

/// State of a vertex relative to the cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VertexState {
    /// Not reached: an ancestor has not been split.
    Absent,
    /// Part of the mesh.
    Active,
    /// Replaced by its children.
    Split,
}

impl<'m> Front<'m> {
    /// Starts at the base mesh.
    pub(super) fn new(mt: &'m Implicit) -> Self {
        let absent = Vertex { corner: ABSENT, level: 0, above: 0 };
        let mut this = Self {
            mt,
            vertices: vec![absent; mt.node_count()],
            triangles: Triangles::new(mt.wedges().is_some()),
            created: Vec::new(),
            active: 0,
            star: Vec::new(),
            ring: Vec::new(),
            steps: None,
        };
        for (root, _) in mt.roots() {
            this.activate(root, u16::MAX);
        }
        let corners = mt.wedges().map_or(&[][..], |wedges| &wedges.base);
        for (i, &face) in mt.base().iter().enumerate() {
            this.add(face, corners.get(i).copied());
        }
        this
    }

    /// Returns the number of vertices.
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

    /// Returns true if all neighbours of an update's node, which must be active, have low enough
    /// levels to split it; otherwise appends the updates that have to come first to `first`.
    pub(super) fn may_split(&mut self, update: u32, first: &mut Vec<u32>) -> bool {
        let (node, level) = (self.mt.parent(update), self.mt.level(update));
        let Self { mt, vertices, star, .. } = self;
        star.clear();
        self.triangles.gather(vertices[node as usize].corner, star);
        let known = first.len();
        let mut check = |n: u32| {
            if vertices[n as usize].level & !SCHEDULED > level {
                first.push(mt.update_of(n).expect("a leaf's level is 0"));
            }
        };
        star.iter().for_each(|spoke| check(spoke.a));
        if mt.is_open(update) {
            // There is a neighbour that no face follows.
            star.iter().for_each(|spoke| check(spoke.b));
        }
        first.len() == known
    }

    /// Splits an update's node, which must be active, if its neighbours allow it; otherwise appends
    /// the updates that have to come first to `first`.
    pub(super) fn split(&mut self, update: u32, first: &mut Vec<u32>) -> bool {
        let may_split = self.may_split(update, first);
        if may_split {
            self.apply(update);
        }
        may_split
    }

    /// Applies an update right after [`may_split`](Self::may_split) accepted it.
    pub(super) fn apply(&mut self, update: u32) {
        self.record(SplitOrMerge::Split(update));
        let (node, level) = (self.mt.parent(update), self.mt.level(update));
        let [first, second] = self.mt.children(update);
        self.vertices[node as usize].corner = SPLIT;
        self.active -= 1;
        self.activate(first, level);
        self.activate(second, level);
        let (run, fan) = self.partition_star(update);
        let mut created = std::mem::take(&mut self.created);
        created.clear();
        created.extend(fan.into_iter().flatten());
        if fan == [None; 2]
            && let Some(non_fan) = self.mt.non_fan_split(update)
        {
            created.extend(&non_fan.created_faces);
        }
        let wedges = self.mt.wedges().map(|all| SplitWedges::new(all, self.mt, update));
        for i in 0..self.star.len() {
            let child = if i < run { second } else { first };
            if let Some(wedges) = &wedges {
                let corner = self.star[i].corner;
                let wedge = wedges.around(child, &self.star, i, self.triangles.wedge(corner));
                self.triangles.set_wedge(corner, wedge);
            }
            let Vertex { corner, .. } = &mut self.vertices[child as usize];
            self.triangles.attach(self.star[i].corner, child, corner);
        }
        for (k, &face) in created.iter().enumerate() {
            // In an uncertified file a face may have any nodes.
            if face.iter().all(|&node| self.is_active(node)) {
                let corners = wedges.as_ref();
                let corners = corners.map(|w| w.created(face, k, &self.star, &self.triangles));
                self.add(face, corners);
            }
        }
        self.created = created;
    }

    /// Moves the triangles of the second child to the front of the star. Returns their number and
    /// the triangles created at the wings.
    fn partition_star(&mut self, update: u32) -> (usize, [Option<[u32; 3]>; 2]) {
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
        let [start, end] = resolve_wings(star, wings);
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

    /// Undoes a split and returns true, if no other update depends on it: its neighbourhood is the
    /// recorded one.
    ///
    /// Fused updates are undone together.
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
        // A vertex that cannot be merged mostly shows it at one of its first triangles.
        let is_held = |&child: &u32| {
            let mut around = self.triangles.around(self.vertices[child as usize].corner);
            around.any(|spoke| is_needed(spoke.a) || is_needed(spoke.b))
        };
        if parts[..if fused_with_child { 3 } else { 2 }].iter().any(is_held) {
            return false;
        }
        if fused_with_child {
            self.undo(update + 1);
        }
        self.undo(update);
        true
    }

    /// Replaces both children of an update by its node.
    fn undo(&mut self, update: u32) {
        self.record(SplitOrMerge::Merge(update));
        let node = self.mt.parent(update);
        let [first, second] = self.mt.children(update);
        let above = self.mt.creator(node).map_or(u16::MAX, |up| self.mt.level(up));
        let wedges = self.mt.wedges().map(|all| SplitWedges::new(all, self.mt, update));
        self.star.clear();
        for child in [first, second] {
            let start = self.star.len();
            self.triangles.gather(self.vertices[child as usize].corner, &mut self.star);
            self.vertices[child as usize].corner = ABSENT;
            if let Some(wedges) = &wedges {
                for spoke in &self.star[start..] {
                    let merged = wedges.merged(child, self.triangles.wedge(spoke.corner));
                    self.triangles.set_wedge(spoke.corner, merged);
                }
            }
        }
        self.active -= 2;
        self.activate(node, above);
        for i in 0..self.star.len() {
            let Spoke { corner, a, b } = self.star[i];
            let mut others = [a, b].into_iter().filter(|&n| n != first && n != second);
            match (others.next(), others.next()) {
                (Some(_), Some(_)) => {
                    let Vertex { corner: list, .. } = &mut self.vertices[node as usize];
                    self.triangles.attach(corner, node, list);
                }
                // It is met from both ends; the first removes it.
                (Some(wing), None) if self.is_first(i) => {
                    self.remove(corner / 3, wing, [first, second, node]);
                }
                _ => {}
            }
        }
    }

    #[inline]
    fn record(&mut self, step: SplitOrMerge) {
        if let Some(steps) = &mut self.steps {
            steps.push(step);
        }
    }

    /// Removes a triangle that is left in the list of one vertex only. `joined` are vertices whose
    /// lists are invalid at this point.
    fn remove(&mut self, t: u32, wing: u32, invalid: [u32; 3]) {
        let Self { triangles, vertices, .. } = self;
        let list = &mut vertices[wing as usize].corner;
        if triangles.unlink(t, list, MAX_SEARCHED) {
            triangles.remove(t);
            return;
        }
        // At a hub, searching the whole list for each removal would take quadratic time. Instead a
        // triangle from the start of the list takes the removed one's slot, as its other two lists
        // are short.
        let Some(other) = triangles.unlink_without(list, invalid) else {
            triangles.unlink(t, list, usize::MAX);
            triangles.remove(t);
            return;
        };
        let at = triangles.nodes(t).iter().position(|&node| node == wing);
        let (mut to, mut from) = (at.expect("a wing is a corner"), other as usize % 3);
        triangles.set_wedge(3 * t + to as u32, triangles.wedge(other));
        for _ in 0..2 {
            (to, from) = (NEXT[to], NEXT[from]);
            let node = triangles.nodes(other / 3)[from];
            let [corner, by] = [other / 3 * 3 + from as u32, 3 * t + to as u32];
            triangles.replace(corner, by, node, &mut vertices[node as usize].corner);
        }
        triangles.remove(other / 3);
    }

    /// Returns true if no earlier entry of the star has the same triangle.
    fn is_first(&self, place: usize) -> bool {
        let t = self.star[place].corner / 3;
        self.star[..place].iter().all(|spoke| spoke.corner / 3 != t)
    }

    /// Returns the star gathered by the last split or by the last test for one.
    pub(super) fn last_star(&self) -> &[Spoke] {
        &self.star
    }

    /// Returns true if a vertex is part of the mesh.
    pub(super) fn is_active(&self, node: u32) -> bool {
        self.state(node) == VertexState::Active
    }

    /// Returns true if an active vertex is a root or was created by an update of a higher level.
    #[inline]
    pub(super) fn is_made_above(&self, node: u32, level: u16) -> bool {
        self.vertices[node as usize].above > level
    }

    /// Appends the star of an active vertex to `star`.
    pub(super) fn gather(&self, node: u32, star: &mut Vec<Spoke>) {
        self.triangles.gather(self.vertices[node as usize].corner, star);
    }

    /// Returns the neighbours of a vertex, each once or twice.
    pub(super) fn around(&mut self, node: u32) -> &[u32] {
        let Self { star, ring, triangles, vertices, .. } = self;
        star.clear();
        triangles.gather(vertices[node as usize].corner, star);
        ring.clear();
        ring.extend(star.iter().flat_map(|spoke| [spoke.a, spoke.b]));
        ring
    }

    /// Returns the triangles in the given slots as a level.
    pub(super) fn level_of(&self, slots: &[u32]) -> Level {
        let Self { mt, triangles, .. } = self;
        let faces = slots.iter().map(|&slot| triangles.nodes(slot)).collect();
        let corners = slots.iter().filter_map(|&slot| triangles.wedges(slot)).collect();
        mt.level_from_faces(faces, corners)
    }

    fn activate(&mut self, node: u32, above: u16) {
        let level = self.mt.update_of(node).map_or(0, |update| self.mt.level(update));
        let vertex = &mut self.vertices[node as usize];
        *vertex = Vertex { corner: NONE, level: vertex.level & SCHEDULED | level, above };
        self.active += 1;
    }

    fn add(&mut self, face: [u32; 3], corners: Option<[u32; 3]>) {
        let t = self.triangles.add();
        for (k, wedge) in (0..).zip(corners.into_iter().flatten()) {
            self.triangles.set_wedge(3 * t + k, wedge);
        }
        for (k, &node) in face.iter().enumerate() {
            let Vertex { corner, .. } = &mut self.vertices[node as usize];
            self.triangles.attach(3 * t + k as u32, node, corner);
        }
    }
}

/// Resolves the wings of a star to nodes; `None` if the star is too large for ranks.
#[inline]
pub(super) fn resolve_wings(star: &[Spoke], wings: [Wing; 2]) -> [Option<u32>; 2] {
    let ranks = wings.map(|wing| if let Wing::Rank(rank) = wing { rank.into() } else { NONE });
    let mut found = [None; 2];
    if star.len() > MAX_RANKED {
        return found;
    }
    // Counting them all is faster than sorting these few or stopping early.
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
