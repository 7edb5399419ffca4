//! Finds all pairs of faces that intersect elsewhere than in shared vertices and edges, by exact
//! predicates.
//!
//! Most close pairs are faces around a common vertex. These are certified ring by ring ([`rings`]),
//! and the rings that fail are tested pair by pair ([`shared_vertex`]). Pairs that share no vertex
//! come from a broad phase ([`BroadPhase`]). Every tested pair passes a filter in `f64`
//! ([`filter`]), and what remains is decided by exact signs ([`triangle_pair`]).

mod broad_phase;
mod coplanar;
mod exact;
mod filter;
mod rings;
mod segment_end;
mod shared_by_objects;
mod shared_vertex;
mod soup;
#[cfg(test)]
mod tests;
mod triangle_pair;

use std::ops::ControlFlow;

use meshlod_mesh::{FaceId, Mesh, VertexId};
use rustc_hash::FxHashMap;

use crate::{Intersection, IntersectionKind};
use filter::{Pair, surely_only_share};
use rings::CertifiedRings;
use soup::{TriangleSoup, has_distinct_corners};
use triangle_pair::intersect;

pub(crate) use exact::{orientation, project, projection_axis};
pub(crate) use segment_end::{Feature, SegmentEnd};
pub(crate) use soup::{ScaledPositions, SearchInput};

/// Method of finding the pairs of faces that may intersect. The findings do not depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum BroadPhase {
    /// Bounding volume hierarchy of the faces tested against itself; the faster method.
    #[default]
    Tree,
    /// Octree over the faces: pairs in a common leaf are tested; see [`crate::ObjectOctree`].
    Octree,
}

/// The pairs of faces that intersect elsewhere than in vertices and edges they share.
#[derive(Debug)]
pub(crate) struct IntersectingPairs {
    pairs: Vec<[FaceId; 2]>,
    complete: bool,
    /// Factor by which positions are scaled for exact signs.
    scale: f64,
}

/// Limits on the work of a search. Real meshes need a hundredth of it: a few close pairs a face.
#[derive(Clone, Copy, Debug)]
struct Limits {
    /// Tests of two faces, or of a face and a block, that remain.
    tests: usize,
    /// Pairs that may be kept.
    kept: usize,
}

impl Limits {
    fn of(faces: usize) -> Self {
        Self { tests: 1000 * faces + (1 << 24), kept: 32 * faces + (1 << 20) }
    }
}

impl IntersectingPairs {
    /// Finds all pairs of faces that intersect elsewhere than in vertices and edges they share.
    ///
    /// Corners at one position are shared even if their vertices differ. Between two objects,
    /// sharing counts as a contact: one pair for each shared edge, and one for each shared position
    /// without a shared edge. Faces of zero area are excluded, and so is a face at the same three
    /// positions as an earlier one of its object, apart from the pair of these two if their
    /// vertices differ.
    ///
    /// If all faces are close to all others, the search gives up and the result is incomplete:
    /// after 1,000 tests a face plus 17 million, or 32 pairs a face plus a million.
    pub(crate) fn of(input: &SearchInput<'_>, broad_phase: BroadPhase) -> Self {
        Self::within(input, broad_phase, Limits::of(input.faces.len()))
    }

    fn within(input: &SearchInput<'_>, broad_phase: BroadPhase, limits: Limits) -> Self {
        let soup = TriangleSoup::of(input);
        let certified = CertifiedRings::of(input, &soup);
        let mut search =
            Search { input, soup: &soup, certified: &certified, limits, found: Vec::new() };
        let excluded = search.excluded();
        let counts = |f: FaceId| !excluded[f.index()];
        let rings = search.test_rings(counts);
        let complete =
            rings.is_continue() && search.test_disjoint(broad_phase, counts).is_continue();
        search.merge_found();
        Self { pairs: search.found, complete, scale: soup.positions.scale() }
    }

    /// Returns true if the search was not given up because too many faces are close to each other.
    pub(crate) fn complete(&self) -> bool {
        self.complete
    }

    /// Returns the intersecting pairs of faces in ascending order, the lower id of each pair first.
    pub(crate) fn pairs(&self) -> &[[FaceId; 2]] {
        &self.pairs
    }

    /// Computes how the faces of a pair intersect. `None` only occurs if coordinates differ so much
    /// in magnitude that signs cannot be computed exactly.
    pub(crate) fn intersection(&self, mesh: &Mesh, pair: [FaceId; 2]) -> Option<Intersection> {
        let positions = ScaledPositions::new(&mesh.positions, self.scale);
        let [a, b] = pair.map(|f| positions.triangle(mesh.faces[f.index()]));
        let found = intersect(&a, &b)?;
        let point = positions.unscaled(found.point);
        Some(Intersection { point, depth: positions.unscaled_length(found.depth), ..found })
    }

    /// Computes the end points of the intersection of two triangles in different planes; see
    /// [`triangle_pair::segment_ends`].
    pub(crate) fn segment_ends(
        &self,
        mesh: &Mesh,
        corners: [[VertexId; 3]; 2],
    ) -> Option<[SegmentEnd; 2]> {
        let positions = ScaledPositions::new(&mesh.positions, self.scale);
        let [a, b] = corners.map(|corners| corners.map(|v| positions.at(v)));
        let unscaled = |end: SegmentEnd| SegmentEnd {
            position: positions.unscaled(end.position.into()).into(),
            ..end
        };
        Some(triangle_pair::segment_ends(&a, &b)?.map(unscaled))
    }
}

/// State of a search: its input and the pairs found so far.
struct Search<'a> {
    input: &'a SearchInput<'a>,
    soup: &'a TriangleSoup<'a>,
    certified: &'a CertifiedRings,
    /// Limits that remain.
    limits: Limits,
    found: Vec<[FaceId; 2]>,
}

/// Control flow of a search, which breaks once its limits are exhausted.
type Flow = ControlFlow<()>;

impl Search<'_> {
    /// Flags the excluded faces: those of zero area and those at the positions of an earlier one.
    fn excluded(&mut self) -> Vec<bool> {
        let mut seen = FxHashMap::default();
        let mut excluded = vec![false; self.soup.corners.len()];
        for (f, corners) in self.soup.corners.iter().enumerate() {
            let face = FaceId::new(f);
            // In a certified ring no two faces coincide, and all have area.
            if has_distinct_corners(corners) && corners.iter().any(|&v| self.certified.contains(v))
            {
                continue;
            }
            if !self.soup.counts(face) {
                excluded[f] = true;
                continue;
            }
            let key = (sorted(corners), self.input.objects.of_face[f]);
            let first = *seen.entry(key).or_insert(face);
            excluded[f] = first != face;
            if first != face
                && sorted(&self.input.faces[f]) != sorted(&self.input.faces[first.index()])
            {
                self.found.push([first, face]);
            }
        }
        excluded
    }

    /// Tests the faces that share vertices, and adds the pairs of objects that share any.
    fn test_rings(&mut self, counts: impl Fn(FaceId) -> bool) -> Flow {
        let unique = self.input.unique;
        let joined = self.objects_join();
        let mut duplicates: Vec<_> =
            unique.duplicates().map(|v| (unique.representative(v), v)).collect();
        duplicates.sort_unstable();
        let mut duplicates = duplicates.as_slice();
        let mut star = Vec::new();
        for vertex in (0..self.input.positions.len()).map(VertexId::new) {
            let count = duplicates.iter().take_while(|(first, _)| *first == vertex).count();
            let (here, later) = duplicates.split_at(count);
            duplicates = later;
            let certified = self.certified.contains(vertex);
            let may_be_shared = joined || count > 0;
            if unique.representative(vertex) != vertex || (certified && !may_be_shared) {
                continue;
            }
            star.clear();
            for v in [vertex].into_iter().chain(here.iter().map(|&(_, v)| v)) {
                let faces = self.input.connectivity.star(v).iter().copied();
                star.extend(
                    faces.filter(|&f| {
                        has_distinct_corners(&self.soup.corners[f.index()]) && counts(f)
                    }),
                );
            }
            star.sort_unstable();
            if may_be_shared {
                self.add_sharing(&star, vertex)?;
            }
            if !certified {
                self.test_ring(&star, vertex)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Returns true if some component belongs to two objects, so that any vertex may be shared.
    fn objects_join(&self) -> bool {
        let objects = self.input.objects;
        let mut of_component = vec![None; objects.components];
        let mut faces = objects.component_of_face.iter().zip(&objects.of_face);
        faces.any(|(&component, &object)| {
            *of_component[component as usize].get_or_insert(object) != object
        })
    }

    /// Returns true if two faces that share no vertex intersect.
    #[inline]
    fn disjoint_intersect(&self, [f, g]: [[VertexId; 3]; 2]) -> bool {
        let triangles = [self.soup.positions.triangle(f), self.soup.positions.triangle(g)];
        let pair = Pair { triangles: &triangles, unshared: [[true; 3]; 2] };
        !surely_only_share(&pair) && intersect(&triangles[0], &triangles[1]).is_some()
    }

    /// Adds a pair of faces that share corners if they have more in common.
    fn test_sharing(&mut self, f: FaceId, g: FaceId) -> Flow {
        let triangles = [self.soup.triangle(f), self.soup.triangle(g)];
        let [f_at, g_at] = [f, g].map(|face| self.soup.corners[face.index()]);
        let unshared = [f_at.map(|v| !g_at.contains(&v)), g_at.map(|v| !f_at.contains(&v))];
        let pair = Pair { triangles: &triangles, unshared };
        // A shared corner alone gives a point, a shared edge a segment.
        let more = match unshared[0].iter().filter(|unshared| **unshared).count() {
            2 => IntersectionKind::Segment,
            _ => IntersectionKind::Crossing,
        };
        if !surely_only_share(&pair)
            && intersect(&triangles[0], &triangles[1]).is_some_and(|found| found.kind >= more)
        {
            self.keep([f, g])?;
        }
        ControlFlow::Continue(())
    }

    /// Counts one more test against the limit.
    #[inline]
    fn count_test(&mut self) -> Flow {
        if self.limits.tests == 0 {
            return ControlFlow::Break(());
        }
        self.limits.tests -= 1;
        ControlFlow::Continue(())
    }

    /// Adds a pair, unless that exceeds the limit.
    fn keep(&mut self, pair: [FaceId; 2]) -> Flow {
        if self.found.len() >= self.limits.kept {
            // Octree leaves and shared vertices find pairs several times.
            self.merge_found();
            if self.found.len() > self.limits.kept / 2 {
                return ControlFlow::Break(());
            }
        }
        self.found.push(pair);
        ControlFlow::Continue(())
    }

    /// Sorts the pairs and removes duplicates.
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
