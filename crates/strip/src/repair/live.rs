//! Triangle strips of a changing list of triangles, repaired where the list changes.

use meshlod_mesh::VertexId;
use rustc_hash::FxHashMap;

use super::StripEffort;
use super::local_search::LocalSearch;
use crate::dual::ends;
use crate::dual_node::{DualEdge, DualNode, Links};
use crate::path_cover::PathCover;
use crate::strips::Strips;
use crate::touched::Touched;
use crate::verify::{has_three_corners, lowest_first};

/// Triangle strips of a list of triangles in numbered slots, which may be overwritten.
///
/// They draw exactly the triangles in the slots. A change breaks the strips at that place and
/// relinks them around it; the rest stays.
#[derive(Clone, Debug)]
pub struct LiveStrips {
    /// Triangle in each slot, [`FREE`] for an empty one.
    pub(super) faces: Vec<[VertexId; 3]>,
    /// Lists the slots that the last update has touched once there are [`StripIndices`] to follow.
    ///
    /// [`StripIndices`]: super::StripIndices
    pub(super) cover: PathCover,
    /// Number of updates so far.
    pub(super) updates: u64,
    /// Sides without a neighbour, by the vertices they run from and to.
    open: FxHashMap<[VertexId; 2], DualEdge>,
    local_search: LocalSearch,
    /// Slots where the next repair starts.
    changed: Touched,
    /// Scratch buffer of sides that have lost their neighbour.
    loose: Vec<DualEdge>,
}

/// Marks an empty slot.
const FREE: [VertexId; 3] = [VertexId(0); 3];

impl LiveStrips {
    /// Places triangles in numbered slots and takes over triangle strips that draw them.
    ///
    /// Triangles missing from the strips, or drawn but in no slot, do no harm.
    ///
    /// Cost: O(n log n); memory for the highest slot.
    /// # Panics
    /// On a slot of a billion or more.
    pub fn new(
        triangles: impl IntoIterator<Item = (u32, [VertexId; 3])>,
        strips: &Strips,
        effort: StripEffort,
    ) -> Self {
        let mut faces = Vec::new();
        for (place, triangle) in triangles {
            assert!((place as usize) < DualEdge::MAX_NODES, "slots are numbered in 30 bits");
            faces.resize(faces.len().max(place as usize + 1), FREE);
            faces[place as usize] = triangle;
        }
        let mut cover = PathCover::new(&faces);
        follow(&mut cover, &faces, strips);
        let sides = (0..faces.len()).flat_map(|place| (0..3).map(move |k| DualEdge::new(place, k)));
        let is_open = |edge: &DualEdge| {
            cover.across(*edge).is_none() && has_three_corners(&faces[edge.node()])
        };
        let open = sides.filter(is_open).map(|edge| (ends(&faces[edge.node()], edge.side()), edge));
        Self {
            open: open.collect(),
            faces,
            cover,
            updates: 0,
            local_search: LocalSearch::new(effort),
            changed: Touched::default(),
            loose: Vec::new(),
        }
    }

    /// Overwrites triangle slots (`None` empties one), repairs the strips there, and returns the
    /// number of triangles added, removed or changed.
    ///
    /// Cost: proportional to the changes and the walks along the strips through them.
    /// # Panics
    /// On a slot of a billion or more.
    pub fn update(
        &mut self,
        changes: impl IntoIterator<Item = (u32, Option<[VertexId; 3]>)>,
    ) -> usize {
        self.updates += 1;
        self.cover.touched.iter_mut().for_each(Touched::clear);
        for (place, triangle) in changes {
            self.write(place as usize, triangle.unwrap_or(FREE));
        }
        let count = self.changed.nodes().len();
        self.loosen();
        self.join();
        self.repair();
        count
    }

    /// Returns the current triangle strips, which draw exactly the triangles in the slots.
    ///
    /// Cost: linear in their length.
    pub fn strips(&self) -> Strips {
        self.cover.strips(&self.faces)
    }

    fn write(&mut self, place: usize, triangle: [VertexId; 3]) {
        assert!(place < DualEdge::MAX_NODES, "slots are numbered in 30 bits");
        while self.faces.len() <= place {
            self.faces.push(FREE);
            let across = [DualEdge::NONE; 3];
            self.cover.nodes.push(DualNode { across, links: Links::default(), frozen: false });
        }
        if self.faces[place] == triangle {
            return;
        }
        for side in 0..3 {
            let edge = DualEdge::new(place, side);
            let key = ends(&self.faces[place], side);
            // On an edge of three faces another side may have the same ends.
            if self.cover.across(edge).is_none() && self.open.get(&key) == Some(&edge) {
                self.open.remove(&key);
            }
        }
        self.faces[place] = triangle;
        self.mark(place);
    }

    /// Disconnects sides of changed triangles from those that no longer run along them.
    fn loosen(&mut self) {
        for i in 0..self.changed.nodes().len() {
            for side in 0..3 {
                let edge = DualEdge::new(self.changed.nodes()[i] as usize, side);
                let other = self.cover.across(edge);
                if other.is_none() {
                    self.loose.push(edge);
                } else if !self.is_across(edge, other) {
                    self.cover.disconnect(edge);
                    self.loose.extend([edge, other]);
                    self.mark(other.node());
                }
            }
        }
    }

    /// Connects loose sides with those that run along them.
    fn join(&mut self) {
        let mut loose = std::mem::take(&mut self.loose);
        for edge in loose.drain(..) {
            let face = &self.faces[edge.node()];
            if !has_three_corners(face) || !self.cover.across(edge).is_none() {
                continue;
            }
            let [from, to] = ends(face, edge.side());
            match self.open.remove(&[to, from]) {
                Some(other) => {
                    self.cover.connect(edge, other);
                    self.mark(other.node());
                }
                None => {
                    self.open.entry([from, to]).or_insert(edge);
                }
            }
        }
        self.loose = loose;
    }

    fn repair(&mut self) {
        let Self { faces, changed, cover, local_search, .. } = self;
        let is_there = |place: &u32| has_three_corners(&faces[*place as usize]);
        let starts: Vec<u32> = changed.nodes().iter().copied().filter(is_there).collect();
        local_search.improve(cover, &starts);
        changed.clear();
    }

    fn mark(&mut self, place: usize) {
        self.changed.mark(place);
        self.cover.touched.iter_mut().for_each(|touched| touched.mark(place));
    }

    fn is_across(&self, edge: DualEdge, other: DualEdge) -> bool {
        let [from, to] = ends(&self.faces[edge.node()], edge.side());
        let whole = [edge, other].iter().all(|p| has_three_corners(&self.faces[p.node()]));
        whole && ends(&self.faces[other.node()], other.side()) == [to, from]
    }
}

/// Links triangles that strips draw one after the other.
fn follow(cover: &mut PathCover, faces: &[[VertexId; 3]], strips: &Strips) {
    let mut places: Vec<_> = faces.iter().copied().map(lowest_first).zip(0..).collect();
    places.sort_unstable();
    let place = |triangle: [VertexId; 3]| {
        let key = lowest_first(triangle);
        let at = places.partition_point(|(face, _)| *face < key);
        places.get(at).filter(|(face, _)| *face == key).map(|&(_, place): &(_, usize)| place)
    };
    for strip in strips.iter() {
        cover.link_sequence(meshlod_mesh::strip_triangles(strip).filter_map(place));
    }
}

#[cfg(test)]
impl LiveStrips {
    /// Panics unless the strips draw exactly the triangles in the slots.
    pub(crate) fn check(&self) {
        use crate::verify::{Difference, difference};
        self.cover.check();
        assert_eq!(difference(&self.strips(), &self.faces), Difference::default());
    }
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;
    use crate::stripify::{StripOptions, stripify};

    #[test]
    fn whatever_is_written_is_drawn() {
        let mut strips = LiveStrips::new([], &Strips::default(), StripEffort::Quick);
        let mut random = crate::random::Random::new(1, 0);
        for _ in 0..200 {
            // Few vertices, so that there are edges of many faces, duplicate faces, and degenerate
            // ones.
            let changes: Vec<_> = (0..20)
                .map(|_| {
                    let corners = [0; 3].map(|_| VertexId::new(random.below(9)));
                    (random.below(60) as u32, (random.below(3) > 0).then_some(corners))
                })
                .collect();
            strips.update(changes);
            strips.check();
        }
        assert!(strips.strips().vertices().len() > 20);
    }

    #[test]
    fn strips_are_taken_over() {
        let faces = samples::torus(300).faces;
        let strips = stripify(&faces, &StripOptions::default());
        let places = (0..).zip(faces.iter().copied());
        let live = LiveStrips::new(places.map(|(i, f)| (2 * i, f)), &strips, StripEffort::Quick);
        live.check();
        let sent = |strips: &Strips| (strips.len(), strips.vertices().len());
        assert_eq!(sent(&live.strips()), sent(&strips));
    }

    #[test]
    fn what_is_taken_away_and_put_back_costs_little() {
        let faces = samples::sphere(2000).faces;
        let strips = stripify(&faces, &StripOptions::default());
        let places = || (0..).zip(faces.iter().copied());
        let mut live = LiveStrips::new(places(), &strips, StripEffort::Thorough);
        assert_eq!(live.update((100..200).map(|place| (place, None))), 100);
        live.check();
        live.update(places().map(|(place, face)| (place, Some(face))));
        live.check();
        let [before, after] = [&strips, &live.strips()].map(|strips| strips.vertices().len());
        assert!(after < before + before / 20, "{before}, {after}");
    }
}
