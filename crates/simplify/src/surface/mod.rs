//! Triangle surface that contractions change in place: vertices with their stars, faces, wedges.
//!
//! The star of a vertex, the faces around it, is a contiguous range of one shared array, so that
//! its faces load side by side. Position, star and flags of a vertex form one record because they
//! are needed together. The surface need not be manifold.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `neighbourhood`, `contracted`, `candidate_states` | a candidate |
//! | `rims`, `feature_edges` | where the surface ends or changes |
//! | `wedges`, `charts`, `nearest`, `interpolate` | attributes |
//! | `ties`, `tied`, `level` | ties, and the result |

pub(crate) mod candidate_states;
pub(crate) mod charts;
pub(crate) mod contracted;
pub(crate) mod feature_edges;
pub(crate) mod interpolate;
pub(crate) mod level;
pub(crate) mod nearest;
pub(crate) mod neighbourhood;
pub(crate) mod rims;
mod tied;
pub(crate) mod ties;
pub(crate) mod wedges;

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, Layer, Mesh, VertexId, WedgeId};

use crate::surface::candidate_states::{CandidateId, State, States};
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::rims::Rims;
use crate::surface::ties::Ties;
use crate::surface::wedges::Wedges;

/// Position of the new vertex of a contraction, and the old vertex that becomes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Position of the new vertex, in model units.
    pub position: DVec3,
    /// Index, among the contracted vertices, of the one that remains as the new vertex.
    pub kept: usize,
    /// Estimated distance between the surface and the input at the new vertex, in model units.
    pub error_estimate: f64,
}

/// Largest number of faces around a candidate at which it may still be contracted.
pub(crate) const MOST_FACES: usize = 256;

/// Size up to which a star is searched each time a face leaves it.
const MOST_SEARCHED: u32 = 32;

/// Face with the states of its candidates, which are needed together.
#[derive(Clone, Copy, Debug)]
struct FaceRecord {
    vertices: [VertexId; 3],
    alive: bool,
    states: States,
}

#[derive(Clone, Copy, Debug)]
struct VertexRecord {
    position: DVec3,
    star: u32,
    /// Number of faces in the star, including removed ones that are still listed.
    valence: u32,
    gone: u32,
    version: u32,
    flags: Flags,
    /// Estimated distance that the surface has moved here, in model units.
    moved: f32,
}

/// Flags of a vertex that the engine checks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Flags(u32);

impl Flags {
    /// The vertex is an end of a boundary edge.
    pub(crate) const BOUNDARY: Self = Self(1);
    /// The vertex must not move: it is locked or non-manifold.
    pub(crate) const PINNED: Self = Self(2);
    /// The vertex may be on a seam: it may belong to more than one chart.
    pub(crate) const SEAM: Self = Self(4);
    /// A candidate parked at the vertex waits for its neighbourhood to change.
    pub(crate) const AWAITED: Self = Self(8);
    /// The vertex is tied to others; see [`Ties`].
    pub(crate) const TIED: Self = Self(16);
    /// The vertex is protected: contractions that involve it cost more.
    pub(crate) const PROTECTED: Self = Self(32);
    /// A lock or a tie holds the vertex, so that its component must not be removed.
    pub(crate) const HELD: Self = Self(64);

    /// The vertex may be on a feature edge: a boundary, a seam or a contact.
    pub(crate) const FEATURE: Self = Self::BOUNDARY.or(Self::SEAM).or(Self::TIED);

    #[inline]
    pub(crate) fn any(self, of: Self) -> bool {
        self.0 & of.0 != 0
    }

    #[inline]
    pub(crate) const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// Triangle surface that contractions change in place. Vertex and face ids are those of the input
/// mesh.
pub struct Surface {
    vertices: Vec<VertexRecord>,
    faces: Vec<FaceRecord>,
    stars: Vec<FaceId>,
    live_faces: usize,
    pub(crate) wedges: Option<Wedges>,
    pub(crate) ties: Ties,
    pub(crate) rims: Rims,
    /// Factor on the cost of a contraction that involves a protected vertex.
    pub(crate) protection: f64,
}

impl Surface {
    /// Builds the surface of the faces that `connectivity` includes; all other faces count as
    /// removed.
    pub(crate) fn new(mesh: &Mesh, connectivity: &Connectivity) -> Self {
        let face = |&vertices: &[VertexId; 3]| FaceRecord {
            vertices,
            alive: false,
            states: States::default(),
        };
        let mut faces: Vec<FaceRecord> = mesh.faces.iter().map(face).collect();
        let mut stars = Vec::with_capacity(mesh.faces.len() * 3 + mesh.faces.len() / 2 + 64);
        let vertices = (0..mesh.positions.len())
            .map(|v| {
                let star = connectivity.star(VertexId::new(v));
                let start = stars.len() as u32;
                stars.extend_from_slice(star);
                star.iter().for_each(|f| faces[f.index()].alive = true);
                let marks = connectivity.marks(VertexId::new(v));
                let mut flags = Flags::default();
                if marks.boundary() {
                    flags = flags.or(Flags::BOUNDARY);
                }
                if marks.non_manifold() {
                    flags = flags.or(Flags::PINNED);
                }
                VertexRecord {
                    position: mesh.positions[v].into(),
                    star: start,
                    valence: star.len() as u32,
                    gone: 0,
                    version: 0,
                    flags,
                    moved: 0.0,
                }
            })
            .collect();
        let live_faces = faces.iter().filter(|face| face.alive).count();
        let (wedges, ties, rims) = (Wedges::new(mesh), Ties::default(), Rims::default());
        let mut surface =
            Self { vertices, faces, stars, live_faces, wedges, ties, rims, protection: 1.0 };
        surface.flag_seams();
        surface
    }

    fn flag_seams(&mut self) {
        let Some(wedges) = &self.wedges else { return };
        let on_seam = |&v: &VertexId| {
            let mut at = self.star(v).map(|f| wedges.chart_at(f, self.corner(f, v)));
            let first = at.next();
            at.any(|wedge| Some(wedge) != first)
        };
        let seams: Vec<_> = (0..self.vertices.len()).map(VertexId::new).filter(on_seam).collect();
        for v in seams {
            self.flag(v, Flags::SEAM);
        }
    }

    /// Returns the number of faces that have not been removed.
    #[inline]
    pub fn live_faces(&self) -> usize {
        self.live_faces
    }

    /// Returns true if the face has not been removed from the surface.
    #[inline]
    pub fn is_alive(&self, face: FaceId) -> bool {
        self.faces[face.index()].alive
    }

    /// Returns the vertices of a face, or those it had when it was removed.
    #[inline]
    pub fn face(&self, face: FaceId) -> [VertexId; 3] {
        self.faces[face.index()].vertices
    }

    /// Returns the wedges at the corners of a face, or those it had when it was removed; `None` if
    /// the input has neither attributes nor several materials or objects.
    ///
    /// Wedges are those of the input, split further where the material or the object changes: the
    /// ones up to the input's count keep their numbers. Each is used at one vertex only. When a
    /// contraction merges wedges, one of the numbers remains.
    #[inline]
    pub fn wedges(&self, face: FaceId) -> Option<[WedgeId; 3]> {
        self.wedges.as_ref().map(|wedges| wedges.of(face))
    }

    /// Returns the current attribute values of all wedges, layer by layer.
    pub fn layers(&self) -> &[Layer] {
        self.wedges.as_ref().map_or(&[], |wedges| wedges.layers())
    }

    /// Returns true if two wedges of one vertex are in one chart: they have the same attributes, up
    /// to normals and tangents, and the same material and object.
    #[inline]
    pub fn is_same_chart(&self, a: WedgeId, b: WedgeId) -> bool {
        self.wedges.as_ref().is_none_or(|wedges| wedges.same_chart(a, b))
    }

    /// Returns the state of a candidate for contraction.
    #[inline]
    pub(crate) fn state(&self, id: CandidateId) -> State {
        self.faces[id.face().index()].states.get(id.slot())
    }

    #[inline]
    pub(crate) fn set_state(&mut self, id: CandidateId, state: State) {
        self.faces[id.face().index()].states.set(id.slot(), state);
    }

    /// Returns the position of a vertex, or its last position if it was removed.
    #[inline]
    pub fn position(&self, vertex: VertexId) -> DVec3 {
        self.vertices[vertex.index()].position
    }

    /// Iterates over the faces around a vertex in no particular order.
    #[inline]
    pub fn star(&self, vertex: VertexId) -> impl Iterator<Item = FaceId> + '_ {
        let VertexRecord { star, valence, .. } = self.vertices[vertex.index()];
        let star = &self.stars[star as usize..(star + valence) as usize];
        star.iter().copied().filter(|face| self.faces[face.index()].alive)
    }

    /// Returns the number of faces that use a vertex.
    #[inline]
    pub fn valence(&self, vertex: VertexId) -> usize {
        let VertexRecord { valence, gone, .. } = self.vertices[vertex.index()];
        (valence - gone) as usize
    }

    /// Returns true if too many faces meet at these vertices for a contraction. The hub of a huge
    /// fan can wait until its rim has been contracted; contracting it first would cost the square
    /// of its valence.
    #[inline]
    pub(crate) fn is_crowded(&self, vertices: &[VertexId]) -> bool {
        vertices.iter().map(|&v| self.valence(v)).sum::<usize>() > MOST_FACES
    }

    /// Returns the number of vertices of the input mesh; all vertex ids are below it.
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.vertices.len()
    }

    /// Returns the number of faces of the input mesh; all face ids are below it.
    #[inline]
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Returns the normal vector of a face, whose length is twice the area.
    #[inline]
    pub fn area_normal(&self, face: FaceId) -> DVec3 {
        let [a, b, c] = self.face(face).map(|v| self.position(v));
        (b - a).cross(c - a)
    }

    /// Returns the index of the corner of `face` that is at `vertex`.
    #[inline]
    pub(crate) fn corner(&self, face: FaceId, vertex: VertexId) -> usize {
        corner_of(self.face(face), vertex)
    }

    #[inline]
    pub(crate) fn flags(&self, vertex: VertexId) -> Flags {
        self.vertices[vertex.index()].flags
    }

    #[inline]
    pub(crate) fn flag(&mut self, vertex: VertexId, flag: Flags) {
        let flags = &mut self.vertices[vertex.index()].flags;
        *flags = flags.or(flag);
    }

    #[inline]
    pub(crate) fn unflag(&mut self, vertex: VertexId, flag: Flags) {
        self.vertices[vertex.index()].flags.0 &= !flag.0;
    }

    /// Returns the greatest estimated distance that the surface has moved at these vertices, in
    /// model units.
    #[inline]
    pub(crate) fn moved(&self, vertices: &[VertexId]) -> f64 {
        vertices.iter().map(|v| self.vertices[v.index()].moved).fold(0.0, f32::max).into()
    }

    /// Marks every cost computed from a vertex as out of date.
    #[inline]
    pub(crate) fn touch(&mut self, vertex: VertexId) {
        let version = &mut self.vertices[vertex.index()].version;
        *version = version.wrapping_add(1);
    }

    /// Returns a number that changes whenever one of these vertices does and that never occurs
    /// again.
    #[inline]
    pub(crate) fn stamp(&self, vertices: &[VertexId]) -> u32 {
        vertices.iter().fold(0, |sum, v| sum.wrapping_add(self.vertices[v.index()].version))
    }

    /// Merges the contracted vertices into one at `placed`; nothing may have changed since
    /// `neighbourhood` was gathered.
    pub(crate) fn contract(&mut self, neighbourhood: &Neighbourhood, placed: &Placed) {
        let kept = neighbourhood.contracted[placed.kept];
        if let Some(mut wedges) = self.wedges.take() {
            wedges.contract(self, neighbourhood, placed);
            self.wedges = Some(wedges);
        }
        for spoke in neighbourhood.spokes.iter().filter(|spoke| spoke.owner() != placed.kept) {
            self.faces[spoke.face.index()].vertices[spoke.corner()] = kept;
        }
        for removed in &neighbourhood.removed_faces {
            self.faces[removed.face.index()].alive = false;
            if let Some(apex) = removed.apex() {
                self.remove_from_star(neighbourhood.ring[apex].id);
            }
        }
        self.live_faces -= neighbourhood.removed_faces.len();
        for &gone in neighbourhood.contracted.iter().filter(|&&v| v != kept) {
            if self.flags(gone).any(Flags::TIED) {
                self.ties.leave(gone);
            }
        }
        self.rims.join(kept, &neighbourhood.contracted);
        self.join(neighbourhood, kept, placed);
    }

    /// Removes a connected component, given all of its faces including those already removed.
    pub(crate) fn take_out(&mut self, component: &[FaceId]) {
        for &id in component {
            let face = &mut self.faces[id.index()];
            self.live_faces -= usize::from(std::mem::take(&mut face.alive));
            for slot in 0..4 {
                let state = match face.states.get(slot) {
                    State::Queued | State::Ghost => State::Ghost,
                    State::Parked | State::Closed => State::Closed,
                };
                face.states.set(slot, state);
            }
            for v in face.vertices {
                let vertex = &mut self.vertices[v.index()];
                (vertex.valence, vertex.gone) = (0, 0);
            }
        }
    }

    /// Gives `kept` the surviving faces, the flags of all contracted vertices and a version above
    /// theirs.
    fn join(&mut self, neighbourhood: &Neighbourhood, kept: VertexId, placed: &Placed) {
        let mut joined = VertexRecord {
            position: placed.position,
            moved: placed.error_estimate as f32,
            valence: neighbourhood.spokes.len() as u32,
            gone: 0,
            version: 1,
            ..self.vertices[kept.index()]
        };
        let mut room = 0;
        for v in neighbourhood.contracted.iter() {
            let vertex = &mut self.vertices[v.index()];
            joined.flags = joined.flags.or(vertex.flags);
            joined.version = joined.version.wrapping_add(vertex.version);
            if vertex.valence > room {
                (room, joined.star) = (vertex.valence, vertex.star);
            }
            (vertex.valence, vertex.gone) = (0, 0);
        }
        if joined.valence > room {
            if self.stars.len() + neighbourhood.spokes.len() > self.stars.capacity() {
                self.pack_stars(neighbourhood.spokes.len());
            }
            joined.star = self.stars.len() as u32;
            self.stars.extend(neighbourhood.spokes.iter().map(|spoke| spoke.face));
        } else {
            for (slot, spoke) in
                self.stars[joined.star as usize..].iter_mut().zip(&neighbourhood.spokes)
            {
                *slot = spoke.face;
            }
        }
        self.vertices[kept.index()] = joined;
    }

    /// Removes a dead face from the star of a vertex: immediately from a small star, and in batches
    /// from a large one, which would take too long to search each time.
    fn remove_from_star(&mut self, vertex: VertexId) {
        let VertexRecord { star, valence, gone, .. } = &mut self.vertices[vertex.index()];
        *gone += 1;
        if *valence > MOST_SEARCHED && *gone * 2 < *valence {
            return;
        }
        let mut kept = *star as usize;
        for place in *star as usize..(*star + *valence) as usize {
            let face = self.stars[place];
            if self.faces[face.index()].alive {
                self.stars[kept] = face;
                kept += 1;
            }
        }
        (*valence, *gone) = (kept as u32 - *star, 0);
    }

    /// Compacts the stars, with room for at least `more` entries.
    fn pack_stars(&mut self, more: usize) {
        let live = self.live_faces * 3;
        let mut packed = Vec::with_capacity(live + live / 4 + more + 64);
        for vertex in &mut self.vertices {
            let star = vertex.star as usize..(vertex.star + vertex.valence) as usize;
            vertex.star = packed.len() as u32;
            packed.extend_from_slice(&self.stars[star]);
        }
        self.stars = packed;
    }
}

/// Returns the index of the face corner that is at a vertex.
#[inline]
pub(crate) fn corner_of(face: [VertexId; 3], vertex: VertexId) -> usize {
    usize::from(face[0] != vertex) + usize::from(face[0] != vertex && face[1] != vertex)
}
