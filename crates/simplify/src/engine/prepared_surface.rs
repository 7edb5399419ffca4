//! The surface that an algorithm of the policy engine starts on.

use meshlod_mesh::Connectivity;

use crate::engine::vanishing::Vanishing;
use crate::surface::Surface;

/// A surface prepared for a simplification algorithm to start on.
pub(crate) struct PreparedSurface {
    pub(crate) surface: Surface,
    pub(crate) connectivity: Connectivity,
    pub(crate) vanishing: Vanishing,
}
