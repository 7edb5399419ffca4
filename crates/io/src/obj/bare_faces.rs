//! Faces of an OBJ file that have no normals, although others have.

use meshlod_mesh::{LayerKind, Mesh};

use super::wedges::CornerIds;
use crate::notes::{Note, grouped};
use crate::scene::normals::compute_missing;

/// Computes the normals that corners lack from the faces around them; notes the number of faces with
/// such corners. A mesh without normals stays without.
///
/// `corners` is empty or has an entry per face. Cost: linear.
pub(super) fn compute_normals(mesh: &mut Mesh, corners: &[[CornerIds; 3]]) -> Option<Note> {
    let layers = &mesh.attributes.as_ref()?.layers;
    layers.iter().find(|layer| layer.kind == LayerKind::Normal)?;
    let is_bare = |face: usize| corners[face].iter().any(|ids| ids.normal.is_none());
    let all = corners.len();
    let count = (0..all).filter(|&face| is_bare(face)).count();
    if count == 0 {
        return None;
    }
    compute_missing(mesh, is_bare);
    let what =
        format!("of {} faces that lack normals, computed from the faces around", grouped(all));
    Some(Note::changed(count, &what, &what))
}
