//! The option for levels of exactly the original volume.

use clap::Args;
use meshlod::Mesh;
use meshlod::mesh::closed_faces;
use meshlod::simplify::ExactVolumeError;

use crate::session::Session;

/// Option for levels of exactly the original volume.
#[derive(Args)]
#[command(next_help_heading = "Constraints")]
pub struct ExactVolumeArgs {
    /// Move vertices along their normals, by at most 0.5% of the diagonal and mostly by their last
    /// digits, until the closed parts of every mesh have their original volume in the precision that
    /// is written
    #[arg(long)]
    pub exact_volume: bool,
}

/// Warns of a mesh whose levels cannot get its volume because no part of it is closed.
pub fn warn_if_open(mesh: &Mesh, session: &Session) {
    if !closed_faces(&mesh.faces, mesh.positions.len()).contains(&true) {
        session.warn(format_args!("--exact-volume: {}", ExactVolumeError::OpenMesh));
    }
}
