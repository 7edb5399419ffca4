//! Guarded splits: a vertex becomes two where all its neighbours have lower levels.

use super::{Front, SCHEDULED, SPLIT, SplitOrMerge, Vertex};
use crate::cut::split_wedges::SplitWedges;
use crate::cut::triangles::Spoke;
use crate::forest::{MAX_RANKED, NONE};
use crate::implicit::Wing;

impl Front<'_> {
    /// Returns true if all neighbours of an update's node, which must be active, have low enough
    /// levels to split it; otherwise appends the updates that have to come first to `first`.
    pub(in crate::cut) fn may_split(&mut self, update: u32, first: &mut Vec<u32>) -> bool {
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
    pub(in crate::cut) fn split(&mut self, update: u32, first: &mut Vec<u32>) -> bool {
        let may_split = self.may_split(update, first);
        if may_split {
            self.apply(update);
        }
        may_split
    }

    /// Applies an update right after [`may_split`](Self::may_split) accepted it.
    pub(in crate::cut) fn apply(&mut self, update: u32) {
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
}

/// Resolves the wings of a star to nodes; `None` if the star is too large for ranks.
#[inline]
pub(in crate::cut) fn resolve_wings(star: &[Spoke], wings: [Wing; 2]) -> [Option<u32>; 2] {
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
