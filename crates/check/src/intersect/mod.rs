//! All pairs of faces that meet beyond what they share, exactly.
//!
//! Three steps. Faces around a vertex are most of the pairs that are close, and are certified ring
//! by ring ([`rings`]); the rings that fail are tested pair by pair. Pairs that share nothing come
//! from a net ([`Net`]), pass a filter in `f64` ([`filter`]), and are decided by exact signs
//! ([`meet`]).

mod coplanar;
mod exact;
mod filter;
mod meet;
mod rings;
mod shares;
mod soup;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;

use meshlod_mesh::{FaceId, Mesh, VertexId};
use meshlod_spatial::{BoxBlocks, LANES, lanes};
use rustc_hash::FxHashMap;

use crate::{Touch, TouchKind};
use meet::meet;
use rings::{Certified, pairs_at};
use soup::{Points, Soup, whole};

pub(crate) use soup::Ground;

/// What finds the pairs of faces that may meet. The findings are the same with either.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Net {
    /// A hierarchy of boxes, against itself: fast.
    #[default]
    Tree,
}

/// The pairs of faces that meet beyond what they share.
#[derive(Debug)]
pub(crate) struct Meetings {
    pairs: Vec<[FaceId; 2]>,
    /// What positions are scaled with.
    scale: f64,
}

impl Meetings {
    /// All pairs of faces that meet beyond what they share.
    ///
    /// Corners at one place are shared, whatever their vertices. Between two objects sharing is a
    /// meeting too: one for each edge that they share, and one for each place at which they share
    /// no edge. Faces without area have no part, nor has one at the places of an earlier one of its
    /// object, beyond the meeting of these two when their vertices are others.
    pub(crate) fn of(ground: &Ground<'_>, _net: Net) -> Self {
        let soup = Soup::of(ground);
        let certified = Certified::of(ground, &soup);
        let mut search = Search { ground, soup: &soup, certified: &certified, found: Vec::new() };
        let left_out = search.left_out();
        let counts = |f: FaceId| !left_out[f.index()];
        search.around_places(counts);
        search.apart(counts);
        let mut pairs = search.found;
        for pair in &mut pairs {
            pair.sort_unstable();
        }
        pairs.sort_unstable();
        pairs.dedup();
        Self { pairs, scale: soup.points.scale() }
    }

    /// The lower face of each first; lowest first.
    pub(crate) fn pairs(&self) -> &[[FaceId; 2]] {
        &self.pairs
    }

    /// How the faces of a pair meet. `None` is left to coordinates that are too far apart in size
    /// for exact signs.
    pub(crate) fn touch(&self, mesh: &Mesh, pair: [FaceId; 2]) -> Option<Touch> {
        let points = Points::new(&mesh.positions, self.scale);
        let [a, b] = pair.map(|f| mesh.faces[f.index()].map(|v| points.at(v)));
        let touch = meet(&a, &b)?;
        let (place, depth) = (points.place(touch.place), points.length(touch.depth));
        Some(Touch { place, depth, ..touch })
    }
}

/// What a search has at hand, and what it has found.
struct Search<'a> {
    ground: &'a Ground<'a>,
    soup: &'a Soup<'a>,
    certified: &'a Certified,
    found: Vec<[FaceId; 2]>,
}

impl Search<'_> {
    /// The faces that have no part: without area, or at the places of an earlier one.
    fn left_out(&mut self) -> Vec<bool> {
        let mut seen = FxHashMap::default();
        let mut left_out = vec![false; self.soup.corners.len()];
        for (f, corners) in self.soup.corners.iter().enumerate() {
            let face = FaceId::new(f);
            // Around a certified place no two faces are at the same places, and all have area.
            if whole(corners) && corners.iter().any(|&v| self.certified.holds(v)) {
                continue;
            }
            if !self.soup.counts(face) {
                left_out[f] = true;
                continue;
            }
            let key = (sorted(corners), self.ground.objects.of_face[f]);
            let first = *seen.entry(key).or_insert(face);
            left_out[f] = first != face;
            if first != face
                && sorted(&self.ground.faces[f]) != sorted(&self.ground.faces[first.index()])
            {
                self.found.push([first, face]);
            }
        }
        left_out
    }

    /// Tests the faces that share places, and adds what objects share.
    fn around_places(&mut self, counts: impl Fn(FaceId) -> bool) {
        let one_object = self.ground.objects.names.len() < 2;
        let mut doubles: Vec<_> =
            self.ground.places.doubles().map(|v| (self.ground.places.first(v), v)).collect();
        doubles.sort_unstable();
        let mut doubles = doubles.as_slice();
        let mut star = Vec::new();
        for place in (0..self.ground.positions.len()).map(VertexId::new) {
            let here = doubles.iter().take_while(|(first, _)| *first == place).count();
            let (doubles_here, later) = doubles.split_at(here);
            doubles = later;
            if self.certified.holds(place) && one_object {
                continue;
            }
            let vertices = [place].into_iter().chain(doubles_here.iter().map(|&(_, v)| v));
            star.clear();
            for v in vertices.filter(|&v| self.ground.places.first(v) == place) {
                let faces = self.ground.connectivity.star(v).iter().copied();
                star.extend(faces.filter(|&f| whole(&self.soup.corners[f.index()]) && counts(f)));
            }
            star.sort_unstable();
            self.add_sharing(&star, place);
            if !self.certified.holds(place) {
                for [f, g] in pairs_at(self.soup, self.certified, &star, place) {
                    self.test(f, g);
                }
            }
        }
    }

    /// Tests all pairs of faces that share no place and may meet.
    fn apart(&mut self, counts: impl Fn(FaceId) -> bool) {
        let soup = self.soup;
        let faces: Vec<FaceId> =
            (0..soup.corners.len()).map(FaceId::new).filter(|&f| counts(f)).collect();
        let blocks = BoxBlocks::new(faces.len(), |i| {
            let [a, b, c] = soup.triangle(faces[i as usize]);
            [a.min(b).min(c), a.max(b).max(c)]
        });
        let items = blocks.items();
        let _ = blocks.pairs(&mut |row| {
            let one = faces[items[row.one as usize] as usize];
            let corners = soup.corners[one.index()];
            for lane in lanes(row.lanes) {
                let other = faces[items[row.block as usize * LANES + lane] as usize];
                let others = soup.corners[other.index()];
                if !corners.iter().any(|v| others.contains(v)) {
                    self.test(one, other);
                }
            }
            ControlFlow::<()>::Continue(())
        });
    }

    /// Adds a pair of faces if they have more in common than they share.
    fn test(&mut self, f: FaceId, g: FaceId) {
        let [corners_f, corners_g] = [f, g].map(|face| self.soup.corners[face.index()]);
        let shared = corners_f.iter().filter(|v| corners_g.contains(v)).count();
        let [a, b] = [f, g].map(|face| self.soup.triangle(face));
        if shared == 0 && filter::surely_apart(&a, &b) {
            return;
        }
        let Some(touch) = meet(&a, &b) else { return };
        // A shared corner is a point in common, a shared edge a segment, and no more.
        let more = match shared {
            0 => true,
            1 => touch.kind > TouchKind::Vertex,
            _ => touch.kind > TouchKind::Edge,
        };
        if more {
            self.found.push([f, g]);
        }
    }
}

fn sorted(face: &[VertexId; 3]) -> [VertexId; 3] {
    let mut face = *face;
    face.sort_unstable();
    face
}
