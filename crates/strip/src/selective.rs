//! Triangle strips of a view-dependent cut.

mod verify;
mod vertices;

use meshlod_mesh::VertexId;
use meshlod_multires::{Cut, Implicit, SlotMesh};

use crate::repair::{LiveStrips, StripEffort, StripIndices};
use crate::stripify::{StripOptions, stripify};
use crate::strips::Strips;

/// Triangle strips that follow a cut of a multiresolution model.
///
/// They draw exactly the cut's triangles. Their vertices are wedges of the model if it has any, so
/// no strip runs across a seam or from one material to another; else they are nodes. One vertex
/// buffer serves all cuts: the position of each node ([`Implicit::position`]), or of the node of
/// each wedge, with the values of its [layers](Implicit::layers).
///
/// A split that leaves one child where its node was, as in models built from half-edge
/// contractions, changes only the triangles of the other.
#[derive(Clone, Debug)]
pub struct CutStrips {
    /// Vertex by which each node, or wedge, of the model is drawn.
    vertices: Vec<VertexId>,
    has_wedges: bool,
    live: LiveStrips,
}

impl CutStrips {
    /// Builds triangle strips for the current cut of the model `mt`.
    ///
    /// The options' clusters are ignored, since triangles come and go.
    ///
    /// Cost: one [`stripify`], plus linear in the model.
    pub fn new(mt: &Implicit, cut: &Cut<'_>, options: &StripOptions, effort: StripEffort) -> Self {
        Self::with_vertices(vertices::vertices(mt), mt.wedge_count() > 0, cut, (options, effort))
    }

    fn with_vertices(
        vertices: Vec<VertexId>,
        has_wedges: bool,
        cut: &Cut<'_>,
        (options, effort): (&StripOptions, StripEffort),
    ) -> Self {
        let triangles = cut.triangles().map(|(slot, nodes)| {
            (slot, corners(has_wedges, cut, slot, nodes).map(|i| vertices[i as usize]))
        });
        let triangles: Vec<_> = triangles.collect();
        let faces: Vec<_> = triangles.iter().map(|&(_, face)| face).collect();
        let strips = stripify(&faces, &StripOptions { clusters: None, ..*options });
        Self { vertices, has_wedges, live: LiveStrips::new(triangles, &strips, effort) }
    }

    /// Follows the last update of the cut, and returns the number of triangles added, removed or
    /// changed.
    ///
    /// No update of the cut may be skipped.
    ///
    /// Cost: proportional to the change.
    pub fn update(&mut self, cut: &Cut<'_>) -> usize {
        let Self { vertices, has_wedges, live } = self;
        // A slot with the same nodes has the same wedges: in one update, splits come before merges,
        // so no other face can have taken the slot and have these nodes.
        live.update(cut.patches().map(|patch| {
            let corners = patch.new.map(|nodes| corners(*has_wedges, cut, patch.slot, nodes));
            (patch.slot, corners.map(|corners| corners.map(|i| vertices[i as usize])))
        }))
    }

    /// Returns the current triangle strips, which draw exactly the cut's triangles.
    ///
    /// Cost: linear in their length.
    pub fn strips(&self) -> Strips {
        self.live.strips()
    }

    /// Returns the current triangle strips of each material, in the order of
    /// [`Implicit::material_names`]; a single set if the model `mt` has no materials.
    ///
    /// Cost: linear in their length.
    pub fn strips_by_material(&self, mt: &Implicit) -> Vec<Strips> {
        let mut sets = vec![Strips::default(); material_count(mt)];
        for strip in self.strips().iter() {
            sets[material(mt, strip[0])].push(strip.iter().copied());
        }
        sets
    }

    /// Writes the current triangle strips into index buffers, one a material of the model `mt`.
    ///
    /// Cost: linear in their length.
    pub fn indices(&mut self, mt: &Implicit) -> StripIndices {
        StripIndices::new(&mut self.live, material_count(mt), |v| material(mt, v))
    }

    /// Brings index buffers up to date after [`update`](Self::update).
    ///
    /// Cost: the length of the strips that have changed, amortized.
    pub fn update_indices(&self, mt: &Implicit, indices: &mut StripIndices) {
        indices.update(&self.live, |v| material(mt, v));
    }

    /// Returns the vertex of the strips that draws a node of the model, or a wedge if it has any.
    ///
    /// It is the finest node, or wedge, below that has the same position, values and material.
    pub fn vertex(&self, of: u32) -> VertexId {
        self.vertices[of as usize]
    }
}

/// Returns the number of sets of strips, one a material.
fn material_count(mt: &Implicit) -> usize {
    mt.material_names().map_or(1, <[String]>::len)
}

fn material(mt: &Implicit, vertex: VertexId) -> usize {
    mt.material_of(vertex.0).unwrap_or(0) as usize
}

/// Returns what the vertices of a triangle are drawn by: its wedges, or its nodes.
fn corners(has_wedges: bool, cut: &Cut<'_>, slot: u32, nodes: [u32; 3]) -> [u32; 3] {
    if has_wedges { cut.wedges(slot).unwrap_or(nodes) } else { nodes }
}

#[cfg(test)]
mod tests;
