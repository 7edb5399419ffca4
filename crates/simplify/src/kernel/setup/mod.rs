//! Setup: from the faces of the input to vertices with rings.

pub(crate) mod build_rings;
pub(crate) mod face_blocks;
pub(crate) mod split_non_manifold;
pub(crate) mod vertex_order;
