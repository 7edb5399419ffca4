//! Nodes: the corners that faces refer to, which are vertices, or wedges if there are attributes.

use meshlod_mesh::{FaceId, Mesh, VertexId};

use crate::kd::BLOCK;
use crate::parts::Parts;

/// Nodes of a mesh, each in a row.
pub(super) struct Nodes {
    pub(super) faces: Vec<[u32; 3]>,
    /// Face of the mesh that each face is.
    pub(super) face_of: Vec<u32>,
    /// Vertex of each node.
    pub(super) vertex_of: Vec<VertexId>,
    /// Vertex or wedge of each node.
    pub(super) corner_of: Vec<u32>,
    pub(super) row_of: Vec<u32>,
    pub(super) rows: usize,
}

impl Nodes {
    /// Creates nodes in one row per block of vertices. If a vertex has several wedges, each block
    /// has two rows: the first wedges of its vertices, and all others.
    pub(super) fn of_blocks(mesh: &Mesh, ordered: &[VertexId]) -> Self {
        let mut this = Self::of_groups(mesh, [(0..mesh.faces.len()).map(FaceId::new)]);
        let mut block_of = vec![0; mesh.positions.len()];
        ordered.iter().enumerate().for_each(|(at, v)| block_of[v.index()] = at / BLOCK);
        let mut seen = vec![false; mesh.positions.len()];
        let mut is_extra = |v: &VertexId| std::mem::replace(&mut seen[v.index()], true);
        let is_extra: Vec<bool> = this.vertex_of.iter().map(&mut is_extra).collect();
        let per_block = if is_extra.contains(&true) { 2 } else { 1 };
        let row = |(v, &is_extra): (&VertexId, &bool)| {
            (per_block * block_of[v.index()] + usize::from(is_extra)) as u32
        };
        this.row_of = this.vertex_of.iter().zip(&is_extra).map(row).collect();
        this.rows = per_block * ordered.len().div_ceil(BLOCK);
        this
    }

    /// Creates nodes in one row per part. A vertex in several parts has a node in each.
    pub(super) fn of_parts(mesh: &Mesh, parts: &Parts) -> Self {
        Self::of_groups(mesh, parts.parts().iter().map(|part| part.ids.iter().copied()))
    }

    /// Creates nodes in one row per group of faces.
    fn of_groups<I: Iterator<Item = FaceId>>(
        mesh: &Mesh,
        groups: impl IntoIterator<Item = I>,
    ) -> Self {
        let attributes = mesh.attributes.as_ref().filter(|of| !of.layers.is_empty());
        let corners = attributes.map(|attributes| &attributes.corners);
        let count = attributes.map_or(mesh.positions.len(), |of| of.wedge_count);
        let mut number_of = vec![None; count];
        let mut this = Self {
            faces: Vec::with_capacity(mesh.faces.len()),
            face_of: Vec::with_capacity(mesh.faces.len()),
            vertex_of: Vec::new(),
            corner_of: Vec::new(),
            row_of: Vec::new(),
            rows: 0,
        };
        for group in groups {
            let first = this.vertex_of.len();
            for face in group {
                let vertices = mesh.faces[face.index()];
                let corners =
                    corners.map_or(vertices.map(|v| v.0), |of| of[face.index()].map(|w| w.0));
                let node = |k: usize| {
                    *number_of[corners[k] as usize].get_or_insert_with(|| {
                        this.vertex_of.push(vertices[k]);
                        this.corner_of.push(corners[k]);
                        this.vertex_of.len() as u32 - 1
                    })
                };
                this.faces.push([0, 1, 2].map(node));
                this.face_of.push(face.0);
            }
            this.corner_of[first..].iter().for_each(|&corner| number_of[corner as usize] = None);
            this.row_of.resize(this.vertex_of.len(), this.rows as u32);
            this.rows += 1;
        }
        this
    }
}
