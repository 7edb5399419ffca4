//! All pairs of faces that meet beyond what they share, exactly.
//!
//! Three steps. Faces around a vertex are most of the pairs that are close, and are certified ring
//! by ring ([`rings`]); the rings that fail are tested pair by pair. Pairs that share nothing come
//! from a net ([`Net`]), pass a filter in `f64` ([`filter`]), and are decided by exact signs
//! ([`meet`]).

mod coplanar;
mod ends;
mod exact;
mod filter;
mod hub;
mod meet;
mod net;
mod rings;
mod shares;
mod soup;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;

use meshlod_mesh::{FaceId, Mesh, VertexId};
use rustc_hash::FxHashMap;

use crate::{Touch, TouchKind};
use filter::{Pair, surely_only_share};
use meet::meet;
use rings::Certified;
use soup::{Soup, whole};

pub(crate) use ends::{End, On};
pub(crate) use exact::{open_axis, turn, without};
pub(crate) use soup::{Ground, Points};

/// What finds the pairs of faces that may meet. The findings are the same with either.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Net {
    /// A hierarchy of boxes, against itself: fast.
    #[default]
    Tree,
    /// An octree of cubes, and the pairs that pass through a cube: as [`crate::Cubes`] shows it.
    Cubes,
}

/// The pairs of faces that meet beyond what they share.
#[derive(Debug)]
pub(crate) struct Meetings {
    pairs: Vec<[FaceId; 2]>,
    complete: bool,
    /// What positions are scaled with.
    scale: f64,
}

/// What a search may cost. Real meshes need a hundredth of it: a few pairs to the face are close.
#[derive(Clone, Copy, Debug)]
struct Limits {
    /// Pairs of faces, and of a face and a block, that may be looked at.
    looks: usize,
    /// Pairs that may be kept.
    kept: usize,
}

impl Limits {
    fn of(faces: usize) -> Self {
        Self { looks: 1000 * faces + (1 << 24), kept: 32 * faces + (1 << 20) }
    }
}

impl Meetings {
    /// All pairs of faces that meet beyond what they share.
    ///
    /// Corners at one place are shared, whatever their vertices. Between two objects sharing is a
    /// meeting too: one for each edge that they share, and one for each place at which they share
    /// no edge. Faces without area have no part, nor has one at the places of an earlier one of its
    /// object, beyond the meeting of these two when their vertices are others.
    ///
    /// Gives up where all faces are close to all others, and then is not complete: after looking at
    /// 1,000 pairs for each face and 17 million, or keeping 32 for each face and a million.
    pub(crate) fn of(ground: &Ground<'_>, net: Net) -> Self {
        Self::within(ground, net, Limits::of(ground.faces.len()))
    }

    fn within(ground: &Ground<'_>, net: Net, limits: Limits) -> Self {
        let soup = Soup::of(ground);
        let certified = Certified::of(ground, &soup);
        let mut search =
            Search { ground, soup: &soup, certified: &certified, limits, found: Vec::new() };
        let left_out = search.left_out();
        let counts = |f: FaceId| !left_out[f.index()];
        let around = search.around_places(counts);
        let complete = around.is_continue() && search.apart(net, counts).is_continue();
        search.merge_found();
        Self { pairs: search.found, complete, scale: soup.points.scale() }
    }

    /// Whether all were found.
    pub(crate) fn complete(&self) -> bool {
        self.complete
    }

    /// The lower face of each first; lowest first.
    pub(crate) fn pairs(&self) -> &[[FaceId; 2]] {
        &self.pairs
    }

    /// How the faces of a pair meet. `None` is left to coordinates that are too far apart in size
    /// for exact signs.
    pub(crate) fn touch(&self, mesh: &Mesh, pair: [FaceId; 2]) -> Option<Touch> {
        let points = Points::new(&mesh.positions, self.scale);
        let [a, b] = pair.map(|f| points.triangle(mesh.faces[f.index()]));
        let touch = meet(&a, &b)?;
        let (place, depth) = (points.place(touch.place), points.length(touch.depth));
        Some(Touch { place, depth, ..touch })
    }

    /// Where what two triangles in different planes have in common ends; see [`meet::ends`].
    pub(crate) fn ends(&self, mesh: &Mesh, corners: [[VertexId; 3]; 2]) -> Option<[End; 2]> {
        let points = Points::new(&mesh.positions, self.scale);
        let [a, b] = corners.map(|corners| corners.map(|v| points.at(v)));
        let place = |end: End| End { place: points.place(end.place.into()).into(), ..end };
        Some(meet::ends(&a, &b)?.map(place))
    }
}

/// What a search has at hand, and what it has found.
struct Search<'a> {
    ground: &'a Ground<'a>,
    soup: &'a Soup<'a>,
    certified: &'a Certified,
    /// What is left of them.
    limits: Limits,
    found: Vec<[FaceId; 2]>,
}

/// A search goes on until it has cost too much.
type Step = ControlFlow<()>;

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
    fn around_places(&mut self, counts: impl Fn(FaceId) -> bool) -> Step {
        let places = self.ground.places;
        let joined = self.objects_join();
        let mut doubles: Vec<_> = places.doubles().map(|v| (places.first(v), v)).collect();
        doubles.sort_unstable();
        let mut doubles = doubles.as_slice();
        let mut star = Vec::new();
        for place in (0..self.ground.positions.len()).map(VertexId::new) {
            let here = doubles.iter().take_while(|(first, _)| *first == place).count();
            let (doubles_here, later) = doubles.split_at(here);
            doubles = later;
            let certified = self.certified.holds(place);
            let may_be_shared = joined || here > 0;
            if places.first(place) != place || (certified && !may_be_shared) {
                continue;
            }
            star.clear();
            for v in [place].into_iter().chain(doubles_here.iter().map(|&(_, v)| v)) {
                let faces = self.ground.connectivity.star(v).iter().copied();
                star.extend(faces.filter(|&f| whole(&self.soup.corners[f.index()]) && counts(f)));
            }
            star.sort_unstable();
            if may_be_shared {
                self.add_sharing(&star, place)?;
            }
            if !certified {
                self.test_ring(&star, place)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Whether a component is in two objects, so that any vertex may be.
    fn objects_join(&self) -> bool {
        let objects = self.ground.objects;
        let mut of_component = vec![None; objects.components];
        let mut faces = objects.component_of_face.iter().zip(&objects.of_face);
        faces.any(|(&component, &object)| {
            *of_component[component as usize].get_or_insert(object) != object
        })
    }

    /// Whether faces that share no place meet.
    #[inline]
    fn meet_apart(&self, [f, g]: [[VertexId; 3]; 2]) -> bool {
        let triangles = [self.soup.points.triangle(f), self.soup.points.triangle(g)];
        let pair = Pair { triangles: &triangles, alone: [[true; 3]; 2] };
        !surely_only_share(&pair) && meet(&triangles[0], &triangles[1]).is_some()
    }

    /// Adds a pair of faces that share places if they have more in common.
    fn test_sharing(&mut self, f: FaceId, g: FaceId) -> Step {
        let triangles = [self.soup.triangle(f), self.soup.triangle(g)];
        let [f_at, g_at] = [f, g].map(|face| self.soup.corners[face.index()]);
        let alone = [f_at.map(|v| !g_at.contains(&v)), g_at.map(|v| !f_at.contains(&v))];
        let pair = Pair { triangles: &triangles, alone };
        // A shared corner is a point in common, a shared edge a segment, and no more.
        let more = match alone[0].iter().filter(|alone| **alone).count() {
            2 => TouchKind::Edge,
            _ => TouchKind::Crossing,
        };
        if !surely_only_share(&pair)
            && meet(&triangles[0], &triangles[1]).is_some_and(|touch| touch.kind >= more)
        {
            self.keep([f, g])?;
        }
        ControlFlow::Continue(())
    }

    /// Counts one more pair that is looked at.
    #[inline]
    fn look(&mut self) -> Step {
        if self.limits.looks == 0 {
            return ControlFlow::Break(());
        }
        self.limits.looks -= 1;
        ControlFlow::Continue(())
    }

    /// Adds a pair.
    fn keep(&mut self, pair: [FaceId; 2]) -> Step {
        if self.found.len() >= self.limits.kept {
            // Cubes and shared places find pairs several times.
            self.merge_found();
            if self.found.len() > self.limits.kept / 2 {
                return ControlFlow::Break(());
            }
        }
        self.found.push(pair);
        ControlFlow::Continue(())
    }

    /// Brings the pairs in their order, each once.
    fn merge_found(&mut self) {
        for pair in &mut self.found {
            pair.sort_unstable();
        }
        self.found.sort_unstable();
        self.found.dedup();
    }
}

fn sorted(face: &[VertexId; 3]) -> [VertexId; 3] {
    let mut face = *face;
    face.sort_unstable();
    face
}
