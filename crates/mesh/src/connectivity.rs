//! Mesh connectivity: the faces around each vertex, neighbours across edges, and non-manifold
//! places.
//!
//! Built in one pass over compact arrays, from faces alone: connectivity never reads positions.
//! Any faces are accepted. A face that repeats a vertex has no sides and is left out.

mod any_star;
mod closed_fan;

use any_star::Scratch;
use closed_fan::ClosedFan;

use crate::{FaceId, VertexId};

/// Half-edge: one side of a face. Side `k` runs from corner `k` of the face to corner `k + 1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Side(u32);

impl Side {
    /// Creates the half-edge from corner `k` (0, 1 or 2) of `face` to the next corner.
    #[inline]
    pub fn new(face: FaceId, k: usize) -> Self {
        debug_assert!(k < 3);
        Self(face.0 * 3 + k as u32)
    }

    /// Returns the face that the half-edge belongs to.
    #[inline]
    pub fn face(self) -> FaceId {
        FaceId(self.0 / 3)
    }

    /// Returns the corner of its face, 0 to 2, that the half-edge starts from.
    #[inline]
    pub fn corner(self) -> usize {
        (self.0 % 3) as usize
    }

    /// Returns the two vertices that the half-edge runs from and to.
    #[inline]
    pub fn ends(self, faces: &[[VertexId; 3]]) -> [VertexId; 2] {
        let face = faces[self.face().index()];
        [face[self.corner()], face[(self.corner() + 1) % 3]]
    }
}

/// Neighbour of a face across one of its edges, if there is exactly one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Twin {
    /// Exactly one other face shares the edge: the neighbour, given by its half-edge.
    ///
    /// The two half-edges run in opposite directions if the faces are consistently oriented.
    Side(Side),
    /// No other face shares the edge: it is a boundary edge.
    Boundary,
    /// Two or more other faces share the edge: it is non-manifold.
    NonManifold,
    /// Undefined, because the face itself uses a vertex twice and has no neighbours.
    Degenerate,
}

/// Flags of a vertex: whether it is on the boundary, and whether the surface is non-manifold there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks(u8);

impl Marks {
    const BOUNDARY: u8 = 1;
    const NON_MANIFOLD_EDGE: u8 = 2;
    const PINCHED: u8 = 4;

    /// Returns true if the vertex is on the boundary, as an end of a boundary edge.
    #[inline]
    pub fn boundary(self) -> bool {
        self.0 & Self::BOUNDARY != 0
    }

    /// Returns true if the surface is not manifold at the vertex: it ends a non-manifold edge or is
    /// pinched.
    #[inline]
    pub fn non_manifold(self) -> bool {
        self.0 & (Self::NON_MANIFOLD_EDGE | Self::PINCHED) != 0
    }

    /// Returns true if the faces around the vertex form more than one fan, such as two cones
    /// touching at their tips.
    #[inline]
    pub fn pinched(self) -> bool {
        self.0 & Self::PINCHED != 0
    }
}

const BOUNDARY: u32 = u32::MAX;
const NON_MANIFOLD: u32 = u32::MAX - 1;
const DEGENERATE: u32 = u32::MAX - 2;

/// Connectivity of a triangle mesh: the faces around each vertex, the neighbours across edges, and
/// which vertices are on the boundary or non-manifold.
///
/// Memory: 4 bytes per side, 4 per corner, 5 per vertex.
#[derive(Clone, Debug)]
pub struct Connectivity {
    star_start: Vec<u32>,
    star: Vec<FaceId>,
    twins: Vec<u32>,
    marks: Vec<Marks>,
    edges: EdgeCounts,
    degenerate_faces: usize,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct EdgeCounts {
    all: usize,
    boundary: usize,
    non_manifold: usize,
    inconsistent: usize,
}

impl Connectivity {
    /// Computes the connectivity of a mesh with the given faces and number of vertices.
    ///
    /// Cost: linear in faces and vertices; a vertex of valence k costs at most O(k log k).
    /// # Panics
    /// If a vertex is out of range, or there are more than 1.4 billion faces.
    pub fn new(faces: &[[VertexId; 3]], vertex_count: usize) -> Self {
        let mut connectivity = Self::stars_only(faces, vertex_count);
        let mut scratch = Scratch::default();
        let mut fan = ClosedFan::new(vertex_count);
        for vertex in (0..vertex_count).map(|v| VertexId(v as u32)) {
            // Nearly all vertices of nearly all meshes have one closed fan, which is quick to
            // recognise.
            if fan.gather(faces, connectivity.star(vertex), vertex) {
                fan.record(vertex, &mut connectivity.twins, &mut connectivity.edges);
            } else {
                connectivity.connect(faces, vertex, &mut scratch);
            }
        }
        connectivity
    }

    fn stars_only(faces: &[[VertexId; 3]], vertex_count: usize) -> Self {
        assert!(faces.len() < (DEGENERATE / 3) as usize, "sides are numbered in 32 bits");
        let (star_start, star) = stars(faces, vertex_count);
        Self {
            degenerate_faces: faces.len() - star.len() / 3,
            star_start,
            star,
            twins: vec![DEGENERATE; faces.len() * 3],
            marks: vec![Marks::default(); vertex_count],
            edges: EdgeCounts::default(),
        }
    }

    /// Returns the number of vertices, including those that no face uses.
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.marks.len()
    }

    /// Returns the faces around a vertex in ascending order, without degenerate ones.
    #[inline]
    pub fn star(&self, vertex: VertexId) -> &[FaceId] {
        let v = vertex.index();
        &self.star[self.star_start[v] as usize..self.star_start[v + 1] as usize]
    }

    /// Returns the neighbour of a face across a half-edge: another face's half-edge, or the reason
    /// that there is not exactly one.
    #[inline]
    pub fn twin(&self, side: Side) -> Twin {
        match self.twins[side.0 as usize] {
            BOUNDARY => Twin::Boundary,
            NON_MANIFOLD => Twin::NonManifold,
            DEGENERATE => Twin::Degenerate,
            side => Twin::Side(Side(side)),
        }
    }

    /// Returns flags that tell whether a vertex is on the boundary or the surface is non-manifold
    /// there.
    #[inline]
    pub fn marks(&self, vertex: VertexId) -> Marks {
        self.marks[vertex.index()]
    }

    /// Returns the number of edges of the mesh, each counted once.
    pub fn edge_count(&self) -> usize {
        self.edges.all
    }

    /// Returns the number of boundary edges, which only one face uses.
    pub fn boundary_edges(&self) -> usize {
        self.edges.boundary
    }

    /// Returns the number of non-manifold edges, which three or more faces share.
    pub fn non_manifold_edges(&self) -> usize {
        self.edges.non_manifold
    }

    /// Returns the number of edges whose two faces are oriented inconsistently, one of them
    /// flipped.
    pub fn inconsistent_edges(&self) -> usize {
        self.edges.inconsistent
    }

    /// Returns the number of pinched vertices, whose faces form more than one fan.
    pub fn pinched_vertices(&self) -> usize {
        self.marks.iter().filter(|marks| marks.pinched()).count()
    }

    /// Returns the number of degenerate faces, which use a vertex more than once.
    pub fn degenerate_faces(&self) -> usize {
        self.degenerate_faces
    }

    /// Returns true if the mesh has faces and every edge is shared by exactly two of them.
    pub fn is_closed(&self) -> bool {
        self.edges.all > 0 && self.edges.boundary == 0 && self.edges.non_manifold == 0
    }

    /// Iterates over the edges, each given once by one of its half-edges; only a non-manifold edge
    /// is given by all of them.
    pub fn edges(&self) -> impl Iterator<Item = Side> + '_ {
        self.twins.iter().enumerate().filter_map(|(side, &twin)| match twin {
            DEGENERATE => None,
            BOUNDARY | NON_MANIFOLD => Some(Side(side as u32)),
            twin => (side as u32 <= twin).then_some(Side(side as u32)),
        })
    }
}

/// Returns the faces around each vertex as one array, and the start of each vertex in it (and the
/// end).
fn stars(faces: &[[VertexId; 3]], vertex_count: usize) -> (Vec<u32>, Vec<FaceId>) {
    let whole =
        |face: &[VertexId; 3]| face[0] != face[1] && face[1] != face[2] && face[2] != face[0];
    let mut start = vec![0u32; vertex_count + 1];
    for v in faces.iter().filter(|face| whole(face)).flatten() {
        start[v.index()] += 1;
    }
    let mut sum = 0;
    for slot in &mut start {
        sum += *slot;
        *slot = sum;
    }
    // Filled from the back: the end of each vertex is counted down to its start.
    let mut star = vec![FaceId(0); sum as usize];
    for (f, face) in faces.iter().enumerate().rev().filter(|(_, face)| whole(face)) {
        for v in face {
            start[v.index()] -= 1;
            star[start[v.index()] as usize] = FaceId(f as u32);
        }
    }
    (start, star)
}

#[cfg(test)]
mod tests;
