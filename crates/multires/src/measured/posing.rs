//! Poses in which errors are measured: what an animation makes of the mesh.

use std::fmt::Debug;

use meshlod_mesh::Layer;

/// Poses of a mesh, in which [`Forest::measure_errors`](crate::Forest::measure_errors) measures too.
///
/// What bends the mesh, such as joints and their weights, is in its attributes: the wedges of all
/// levels are posed by their own.
pub trait Posing: Debug + Send + Sync {
    /// Returns the number of poses.
    fn count(&self) -> usize;

    /// Returns where wedges are in a pose, in model units, one place for each that is given.
    fn places(&self, pose: usize, wedges: &PosedWedges<'_>) -> Vec<[f64; 3]>;
}

/// Wedges to be posed, with all on which their places depend.
#[derive(Clone, Copy, Debug)]
pub struct PosedWedges<'w> {
    /// Positions as the mesh has them, in model units: the first belongs to wedge 0, and so on.
    pub positions: &'w [[f64; 3]],
    /// Object label of each of these wedges; 0 if the mesh has no objects.
    pub objects: &'w [u32],
    /// Attributes, with values for these wedges and maybe for more.
    pub layers: &'w [Layer],
}
