//! Strips of faces that change, kept good where they change.

use meshlod_mesh::VertexId;
use rustc_hash::FxHashMap;

use super::Effort;
use super::mender::Mender;
use crate::cover::{Cell, Cover, Links, Port};
use crate::dual::ends;
use crate::strips::Strips;
use crate::verify::{has_three_corners, lowest_first};

/// Strips of the triangles in a list of places, some of which are written over from time to time.
///
/// They draw exactly what is in the list. A change takes the strips apart where it is, and joins and leads
/// them anew around there; all else stays.
#[derive(Clone, Debug)]
pub struct LiveStrips {
    /// By place; [`FREE`] where nothing is.
    faces: Vec<[VertexId; 3]>,
    cover: Cover,
    /// By what they run from and to: sides with nothing across.
    open: FxHashMap<[VertexId; 2], Port>,
    mender: Mender,
    /// Where the next repair starts, each place once.
    changed: Vec<u32>,
    is_changed: Vec<bool>,
    /// Room for sides that have nothing across for the moment.
    loose: Vec<Port>,
}

/// No triangle.
const FREE: [VertexId; 3] = [VertexId(0); 3];

impl LiveStrips {
    /// The triangles in some places, with strips for them. What the strips lack, or draw that is in no place, does no
    /// harm.
    ///
    /// Cost: O(n log n); memory for the greatest place.
    /// # Panics
    /// Places of a billion and more.
    pub fn new(
        triangles: impl IntoIterator<Item = (u32, [VertexId; 3])>,
        strips: &Strips,
        effort: Effort,
    ) -> Self {
        let mut faces = Vec::new();
        for (place, triangle) in triangles {
            assert!((place as usize) < Port::MOST_CELLS, "places are numbered in 30 bits");
            faces.resize(faces.len().max(place as usize + 1), FREE);
            faces[place as usize] = triangle;
        }
        let mut cover = Cover::new(&faces);
        follow(&mut cover, &faces, strips);
        let sides = (0..faces.len()).flat_map(|place| (0..3).map(move |k| Port::new(place, k)));
        let is_open =
            |port: &Port| cover.across(*port).is_none() && has_three_corners(&faces[port.cell()]);
        let open = sides.filter(is_open).map(|port| (ends(&faces[port.cell()], port.side()), port));
        Self {
            open: open.collect(),
            is_changed: vec![false; faces.len()],
            faces,
            cover,
            mender: Mender::new(effort),
            changed: Vec::new(),
            loose: Vec::new(),
        }
    }

    /// Writes over some places, `None` for nothing, and repairs the strips there. How many triangles came, went or
    /// have another corner.
    ///
    /// Cost: of the changes, and of the strips that go through them as far as they are walked.
    /// # Panics
    /// Places of a billion and more.
    pub fn update(
        &mut self,
        changes: impl IntoIterator<Item = (u32, Option<[VertexId; 3]>)>,
    ) -> usize {
        for (place, triangle) in changes {
            self.write(place as usize, triangle.unwrap_or(FREE));
        }
        let count = self.changed.len();
        self.loosen();
        self.join();
        self.repair();
        count
    }

    /// The strips as they are now.
    ///
    /// Cost: linear in all of them.
    pub fn strips(&self) -> Strips {
        self.cover.strips(&self.faces)
    }

    fn write(&mut self, place: usize, triangle: [VertexId; 3]) {
        assert!(place < Port::MOST_CELLS, "places are numbered in 30 bits");
        while self.faces.len() <= place {
            self.faces.push(FREE);
            let across = [Port::NONE; 3];
            self.cover.cells.push(Cell { across, links: Links::default(), held: false });
            self.is_changed.push(false);
        }
        if self.faces[place] == triangle {
            return;
        }
        for side in 0..3 {
            let port = Port::new(place, side);
            let key = ends(&self.faces[place], side);
            // Where three faces meet another side may be known by the same ends.
            if self.cover.across(port).is_none() && self.open.get(&key) == Some(&port) {
                self.open.remove(&key);
            }
        }
        self.faces[place] = triangle;
        self.mark(place);
    }

    /// Parts the sides of what changed from those that do not run along them any more.
    fn loosen(&mut self) {
        for i in 0..self.changed.len() {
            for side in 0..3 {
                let port = Port::new(self.changed[i] as usize, side);
                let other = self.cover.across(port);
                if other.is_none() {
                    self.loose.push(port);
                } else if !self.is_across(port, other) {
                    self.cover.sever(port);
                    self.loose.extend([port, other]);
                    self.mark(other.cell());
                }
            }
        }
    }

    /// Lets the loose sides lie across from those that run along them.
    fn join(&mut self) {
        let mut loose = std::mem::take(&mut self.loose);
        for port in loose.drain(..) {
            let face = &self.faces[port.cell()];
            if !has_three_corners(face) || !self.cover.across(port).is_none() {
                continue;
            }
            let [from, to] = ends(face, port.side());
            match self.open.remove(&[to, from]) {
                Some(other) => {
                    self.cover.join(port, other);
                    self.mark(other.cell());
                }
                None => {
                    self.open.entry([from, to]).or_insert(port);
                }
            }
        }
        self.loose = loose;
    }

    fn repair(&mut self) {
        let Self { faces, changed, is_changed, cover, .. } = self;
        changed.iter().for_each(|&place| is_changed[place as usize] = false);
        changed.retain(|&place| has_three_corners(&faces[place as usize]));
        self.mender.mend(cover, changed);
        changed.clear();
    }

    fn mark(&mut self, place: usize) {
        if !std::mem::replace(&mut self.is_changed[place], true) {
            self.changed.push(place as u32);
        }
    }

    fn is_across(&self, port: Port, other: Port) -> bool {
        let [from, to] = ends(&self.faces[port.cell()], port.side());
        let whole = [port, other].iter().all(|p| has_three_corners(&self.faces[p.cell()]));
        whole && ends(&self.faces[other.cell()], other.side()) == [to, from]
    }
}

/// Links what strips draw one after the other.
fn follow(cover: &mut Cover, faces: &[[VertexId; 3]], strips: &Strips) {
    let mut places: Vec<_> = faces.iter().copied().map(lowest_first).zip(0..).collect();
    places.sort_unstable();
    let place = |triangle: [VertexId; 3]| {
        let key = lowest_first(triangle);
        let at = places.partition_point(|(face, _)| *face < key);
        places.get(at).filter(|(face, _)| *face == key).map(|&(_, place): &(_, usize)| place)
    };
    for strip in strips.iter() {
        cover.follow(crate::strips::drawn(strip).filter_map(place));
    }
}

#[cfg(test)]
impl LiveStrips {
    /// Panics unless the strips draw what is in the list.
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
    use crate::stripify::{Options, stripify};

    #[test]
    fn whatever_is_written_is_drawn() {
        let mut strips = LiveStrips::new([], &Strips::default(), Effort::Quick);
        let mut random = crate::random::Random::new(1, 0);
        for _ in 0..200 {
            // Few vertices: edges of many faces, faces there twice, faces without three corners.
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
        let strips = stripify(&faces, &Options::default());
        let places = (0..).zip(faces.iter().copied());
        let live = LiveStrips::new(places.map(|(i, f)| (2 * i, f)), &strips, Effort::Quick);
        live.check();
        let sent = |strips: &Strips| (strips.len(), strips.vertices().len());
        assert_eq!(sent(&live.strips()), sent(&strips));
    }

    #[test]
    fn what_is_taken_away_and_put_back_costs_little() {
        let faces = samples::sphere(2000).faces;
        let strips = stripify(&faces, &Options::default());
        let places = || (0..).zip(faces.iter().copied());
        let mut live = LiveStrips::new(places(), &strips, Effort::Thorough);
        assert_eq!(live.update((100..200).map(|place| (place, None))), 100);
        live.check();
        live.update(places().map(|(place, face)| (place, Some(face))));
        live.check();
        let [before, after] = [&strips, &live.strips()].map(|strips| strips.vertices().len());
        assert!(after < before + before / 20, "{before}, {after}");
    }
}
