//! Connectivity of a mesh without its degenerate and duplicate faces.

use meshlod_mesh::{Connectivity, Mesh};

/// Builds the connectivity of a mesh, leaving out duplicate faces, and returns it with their
/// number.
pub(crate) fn connect(mesh: &Mesh) -> (Connectivity, usize) {
    let (connectivity, duplicates) =
        Connectivity::without_duplicates(&mesh.faces, mesh.positions.len());
    (connectivity, duplicates.len())
}
