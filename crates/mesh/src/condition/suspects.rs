//! Vertices that may need conditioning, and the part of the mesh around them.

use crate::{Connectivity, FaceId, Labels, Locks, Mesh, Side, Twin, VertexId};

/// Marks the vertices at which edges do not leave as often as they arrive: the ends of boundary
/// edges, of edges with an odd number of faces, and of those whose faces do not agree.
///
/// Each vertex sums up a hash of the next and the previous corner of its faces, which cancel out
/// along a closed fan. Cost: one pass over the faces, a tenth of that of a [`Connectivity`].
pub(super) fn unbalanced(mesh: &Mesh) -> Vec<bool> {
    let hash = |v: VertexId| {
        let mixed = (u64::from(v.0) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        mixed ^ mixed >> 29
    };
    let mut sums = vec![0_u64; mesh.positions.len()];
    for &[a, b, c] in mesh.faces.iter().filter(|face| is_whole(**face)) {
        // `map` over an array is not inlined.
        let (x, y, z) = (hash(a), hash(b), hash(c));
        let mut add = |v: VertexId, next: u64, previous: u64| {
            let sum = &mut sums[v.index()];
            *sum = sum.wrapping_add(next).wrapping_sub(previous);
        };
        add(a, y, z);
        add(b, z, x);
        add(c, x, y);
    }
    sums.into_iter().map(|sum| sum != 0).collect()
}

/// Returns true if as many faces run along every edge in one direction as in the other, by 64-bit sums
/// of hashes. Where no face repeats another, such a mesh is [closed](crate::closed_faces) everywhere.
///
/// Faces that repeat a vertex are left out. Cost: one pass over the faces.
///
/// # Panics
/// If an index is out of range.
pub fn is_balanced(mesh: &Mesh) -> bool {
    !unbalanced(mesh).contains(&true)
}

/// Returns true if a face has three different vertices.
pub(super) fn is_whole([a, b, c]: [VertexId; 3]) -> bool {
    a != b && b != c && c != a
}

/// Marks the vertices on the boundary, those that are not manifold, and those of a front with its
/// back.
pub(super) fn irregular(mesh: &Mesh) -> Vec<bool> {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let of_vertex = |v: usize| {
        let marks = connectivity.marks(VertexId::new(v));
        marks.boundary() || marks.non_manifold()
    };
    let mut suspects: Vec<bool> = (0..mesh.positions.len()).map(of_vertex).collect();
    for side in connectivity.edges() {
        let Twin::Side(twin) = connectivity.twin(side) else { continue };
        if !continues(mesh, side, twin) {
            let faces = [side, twin].map(|side| mesh.faces[side.face().index()]);
            faces.as_flattened().iter().for_each(|v| suspects[v.index()] = true);
        }
    }
    suspects
}

/// Returns true if two sides of one edge run in opposite directions and their faces are not the
/// front and the back of one triangle.
pub(super) fn continues(mesh: &Mesh, a: Side, b: Side) -> bool {
    let [from, to] = [a, b].map(|side| side.ends(&mesh.faces));
    let apex = |side: Side| mesh.faces[side.face().index()][(side.corner() + 2) % 3];
    from[0] == to[1] && from[1] == to[0] && apex(a) != apex(b)
}

/// The faces at the suspects of a mesh as a mesh of its own, without attributes.
///
/// All faces at a suspect are there. At other vertices some are missing, so these stay as they are.
pub(super) struct Around {
    pub(super) mesh: Mesh,
    /// Face of the whole mesh that each face is.
    pub(super) faces: Vec<u32>,
    /// Vertex of the whole mesh that each vertex is, in ascending order.
    pub(super) vertices: Vec<VertexId>,
    pub(super) is_suspect: Vec<bool>,
}

impl Around {
    pub(super) fn new(whole: &Mesh, suspects: &[bool]) -> Self {
        let near = |&f: &u32| {
            let face = whole.faces[f as usize];
            is_whole(face) && face.iter().any(|v| suspects[v.index()])
        };
        let faces: Vec<u32> = (0..whole.faces.len() as u32).filter(near).collect();
        let at = |&f: &u32| whole.faces[f as usize];
        let mut mesh = Mesh::new(Vec::new(), faces.iter().map(at).collect());
        let mut vertices = mesh.faces.as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        for v in mesh.faces.as_flattened_mut() {
            *v = VertexId::new(vertices.binary_search(v).expect("a vertex of these faces"));
        }
        mesh.positions = vertices.iter().map(|v| whole.positions[v.index()]).collect();
        let select = |labels: &Labels| Labels {
            names: Vec::new(),
            of_face: faces.iter().map(|&f| labels.of(f as usize)).collect(),
        };
        mesh.materials = whole.materials.as_ref().map(select);
        let is_suspect = vertices.iter().map(|v| suspects[v.index()]).collect();
        Self { mesh, faces, vertices, is_suspect }
    }

    /// Leaves out some of the faces, given in ascending order.
    pub(super) fn remove(&mut self, faces: &[FaceId]) {
        let keep = |f: usize| faces.binary_search(&FaceId::new(f)).is_err();
        let kept: Vec<usize> = (0..self.faces.len()).filter(|&f| keep(f)).collect();
        self.mesh.faces = kept.iter().map(|&f| self.mesh.faces[f]).collect();
        self.faces = kept.iter().map(|&f| self.faces[f]).collect();
        if let Some(labels) = &mut self.mesh.materials {
            labels.of_face = kept.iter().map(|&f| labels.of(f)).collect();
        }
    }

    /// Returns the boundary edges of the whole mesh.
    pub(super) fn border(&self, connectivity: &Connectivity) -> Vec<Side> {
        // Where faces are missing, no end is a suspect.
        let is_border = |&side: &Side| {
            connectivity.twin(side) == Twin::Boundary
                && side.ends(&self.mesh.faces).iter().all(|v| self.is_suspect[v.index()])
        };
        connectivity.edges().filter(is_border).collect()
    }

    /// Returns the locks of the vertices; ties with others only as ties of their own.
    pub(super) fn locks(&self, whole: &Locks) -> Locks {
        let lock = |&v: &VertexId| whole.of(v);
        let own = |v: &VertexId| Some(VertexId::new(self.vertices.binary_search(v).ok()?));
        let ties = whole.ties.iter().map(|tie| tie.iter().filter_map(own).collect());
        Locks { of_vertex: self.vertices.iter().map(lock).collect(), ties: ties.collect() }
    }
}
