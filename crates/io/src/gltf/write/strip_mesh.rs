//! Meshes as triangle strips.

use meshlod_mesh::{Mesh, VertexId, WedgeId};

/// Entry of a triangle strip: a vertex and its wedge, which is ignored in a mesh without
/// attributes.
pub type StripCorner = (VertexId, WedgeId);

/// Mesh of a scene as triangle strips, at one or more levels that share its vertices.
#[derive(Clone, Debug, Default)]
pub struct StripMesh {
    /// Positions and attributes, without faces.
    pub mesh: Mesh,
    /// One triangle strip for each material label of each level, the finest level first; empty
    /// where nothing is drawn.
    pub levels: Vec<Vec<Vec<StripCorner>>>,
}
