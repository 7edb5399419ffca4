//! Method by which tests make coarser tiles.

use meshlod_mesh::{Lock, Locks, Mesh};
use meshlod_simplify::{Options, SimplifyError, Target, contract_to};
use meshlod_tiles::coarser::Coarsen;

/// Simplifies by the kernel, up to an error.
pub struct Kernel;

impl Coarsen for Kernel {
    type Error = SimplifyError;

    fn coarsen(
        &self,
        mesh: &Mesh,
        locks: Vec<Lock>,
        error: f64,
    ) -> Result<(Mesh, f64), SimplifyError> {
        let locks = Locks { of_vertex: locks, ties: Vec::new() };
        let options = Options { locks, ..Options::default() };
        let (mesh, _) = contract_to(mesh, Target::Error(error), &options)?;
        Ok((mesh, error))
    }

    fn loss(&self, _: &Mesh, _: usize) -> Result<f64, SimplifyError> {
        Ok(0.0)
    }

    fn distances(&self, _: &Mesh, _: &Mesh) -> Vec<f64> {
        Vec::new()
    }
}
