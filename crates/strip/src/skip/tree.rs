//! The merge tree: the vertex that each one merges into, and when.

use std::borrow::Cow;

use meshlod_mesh::{Mesh, VertexId};

use super::pointers::Pointers;
use super::wedges::{MeshWedges, StripWedge};
use crate::verify::{has_three_corners, lowest_first};

/// A mesh and the sequence of its half-edge contractions; each level is the mesh after some of
/// them.
///
/// Points never move, so every vertex of a level is a vertex of the mesh and one vertex buffer
/// serves all levels. Degenerate faces and duplicates are left out.
///
/// With attributes, the vertices of the tree are [`StripWedge`]s: what a GPU calls a vertex. A
/// contraction merges the wedges of the removed vertex into those that continue their charts.
/// # References
/// [KY05], the merge tree. Differs: wedges.
#[derive(Clone, Debug)]
pub struct MergeTree {
    pub(super) faces: Vec<[VertexId; 3]>,
    /// Vertex that each vertex merges into.
    pub(super) parents: Vec<VertexId>,
    /// Contraction at which each vertex vanishes, or [`STAYS`].
    pub(super) turns: Vec<u32>,
    /// Number of faces left after 0, 1, 2, … contractions.
    pub(super) faces_left: Vec<u32>,
    /// Rising numbers of contractions after which tied vertices are apart, because only some of
    /// those that move them together have been made.
    pub(super) torn: Vec<u32>,
    /// The vertices as wedges; `None` if they are those of the mesh.
    pub(super) wedges: Option<Vec<StripWedge>>,
}

/// Rank of a vertex that never vanishes.
pub(super) const STAYS: u32 = u32::MAX;

impl MergeTree {
    /// Creates the merge tree of a valid mesh without any contractions.
    ///
    /// Cost: O(n log n).
    pub fn new(mesh: &Mesh) -> Self {
        match MeshWedges::new(mesh) {
            Some(wedges) => Self::of_wedges(mesh, wedges),
            None => Self::of_vertices(mesh),
        }
    }

    /// Creates the merge tree of the vertices of a mesh, without its attributes.
    pub(super) fn of_vertices(mesh: &Mesh) -> Self {
        Self::of_faces(whole_faces(mesh, &mesh.faces), mesh.positions.len())
    }

    /// Creates the merge tree of the wedges of a mesh.
    pub(super) fn of_wedges(mesh: &Mesh, wedges: MeshWedges) -> Self {
        let MeshWedges { wedges, corners } = wedges;
        let tree = Self::of_faces(whole_faces(mesh, &corners), wedges.len());
        Self { wedges: Some(wedges), ..tree }
    }

    fn of_faces(faces: Vec<[VertexId; 3]>, vertices: usize) -> Self {
        Self {
            parents: (0..vertices).map(VertexId::new).collect(),
            turns: vec![STAYS; vertices],
            faces_left: vec![faces.len() as u32],
            faces,
            torn: Vec::new(),
            wedges: None,
        }
    }

    /// Returns the number of contractions that the merge tree holds.
    pub fn contractions(&self) -> usize {
        self.faces_left.len() - 1
    }

    /// Returns the number of vertices that the levels use: those of the mesh, or wedges.
    pub fn vertices(&self) -> usize {
        self.parents.len()
    }

    /// Returns the vertices of the tree as wedges, in the order of their ids: first those of the
    /// mesh, then others.
    ///
    /// Cost: linear in the mesh it was made of, if that has neither attributes nor several
    /// materials at a vertex; else constant.
    pub fn wedges(&self, mesh: &Mesh) -> Cow<'_, [StripWedge]> {
        match &self.wedges {
            Some(wedges) => wedges.into(),
            None => MeshWedges::collect(mesh).wedges.into(),
        }
    }

    /// Returns the vertex of the mesh at which a vertex of the tree lies.
    #[inline]
    pub fn mesh_vertex(&self, vertex: VertexId) -> VertexId {
        self.wedges.as_ref().map_or(vertex, |wedges| wedges[vertex.index()].vertex)
    }

    /// Returns the number of faces left after a given number of contractions, clamped to the
    /// maximum.
    pub fn faces_left(&self, contractions: usize) -> usize {
        self.faces_left[contractions.min(self.contractions())] as usize
    }

    /// Returns the least number of contractions that leaves at most `faces` faces and tied vertices
    /// together, or the number of all contractions if none suffices.
    pub fn contractions_to(&self, faces: usize) -> usize {
        let found = self.faces_left.partition_point(|&left| left as usize > faces);
        let mut found = found.min(self.contractions());
        while self.torn.binary_search(&(found as u32)).is_ok() {
            found += 1;
        }
        found
    }

    /// Returns the faces of the full-resolution mesh, by vertices of the tree.
    pub fn faces(&self) -> &[[VertexId; 3]] {
        &self.faces
    }

    /// Returns the faces of the level after a given number of contractions, by vertices of the
    /// tree.
    ///
    /// Cost: linear.
    pub fn level(&self, contractions: usize) -> Vec<[VertexId; 3]> {
        let mut pointers = Pointers::new(self.vertices());
        let shown =
            self.faces.iter().map(|face| face.map(|v| self.shown(v, contractions, &mut pointers)));
        shown.filter(|face| self.is_drawn(face)).collect()
    }

    /// Returns true if the vertices are wedges; a vertex of the mesh may have several.
    pub fn has_wedges(&self) -> bool {
        self.wedges.is_some()
    }

    /// Returns whether the corners of a face are at three vertices of the mesh. Two wedges of one
    /// vertex draw nothing between them.
    #[inline]
    pub(crate) fn is_drawn(&self, corners: &[VertexId; 3]) -> bool {
        has_three_corners(&corners.map(|v| self.mesh_vertex(v)))
    }

    /// Lists the vertices that vanish, in order.
    pub(super) fn order(&self) -> Vec<VertexId> {
        let vanish = |v: &VertexId| self.turns[v.index()] != STAYS;
        let mut order: Vec<_> = (0..self.vertices()).map(VertexId::new).filter(vanish).collect();
        order.sort_by_key(|v| self.turns[v.index()]);
        order
    }

    /// Returns the vertex that a vertex merges into, itself if it stays.
    pub(super) fn parent(&self, vertex: VertexId) -> VertexId {
        self.parents[vertex.index()]
    }

    /// Returns whether a vertex has vanished after this many contractions.
    #[inline]
    pub(super) fn is_gone(&self, vertex: VertexId, contractions: usize) -> bool {
        (self.turns[vertex.index()] as usize) < contractions
    }

    /// Returns the vertex that represents `vertex` after this many contractions.
    #[inline]
    pub(super) fn shown(
        &self,
        vertex: VertexId,
        contractions: usize,
        pointers: &mut Pointers,
    ) -> VertexId {
        pointers.shown(vertex, &self.parents, |v| self.is_gone(v, contractions))
    }
}

/// Returns the corners of the mesh's faces without those of degenerate faces and of duplicates of
/// earlier ones; keeps the order.
fn whole_faces(mesh: &Mesh, corners: &[[VertexId; 3]]) -> Vec<[VertexId; 3]> {
    let faces = mesh.faces.iter().zip(0u32..).filter(|(face, _)| has_three_corners(face));
    let mut sorted: Vec<_> = faces.map(|(&face, i)| (lowest_first(face), i)).collect();
    sorted.sort_unstable();
    sorted.dedup_by_key(|(face, _)| *face);
    sorted.sort_unstable_by_key(|&(_, i)| i);
    sorted.into_iter().map(|(_, i)| corners[i as usize]).collect()
}

#[cfg(test)]
mod tests;
