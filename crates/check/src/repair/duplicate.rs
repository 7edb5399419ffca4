//! Removes duplicate faces.

use meshlod_mesh::{Connectivity, FaceId, Mesh, VertexId};
use rustc_hash::FxHashSet;

use super::edit::retain_faces;
use crate::check::faces::duplicates;

/// Removes faces with the same vertices and orientation as an earlier one; returns their number.
///
/// Two faces of opposite orientation are the sides of a sheet, or a wall between two rooms:
/// removing one would open the other. Splitting non-manifold edges separates them.
pub fn drop_duplicates(mesh: &mut Mesh) -> usize {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    // First faces of which a copy of opposite orientation has been seen.
    let mut reversed: FxHashSet<FaceId> = FxHashSet::default();
    let dropped: FxHashSet<FaceId> = duplicates(&mesh.faces, &connectivity)
        .into_iter()
        .filter(|&(face, of)| {
            same_orientation(mesh.faces[face.index()], mesh.faces[of.index()])
                || !reversed.insert(of)
        })
        .map(|(face, _)| face)
        .collect();
    retain_faces(mesh, |face| !dropped.contains(&FaceId(face as u32)))
}

/// Returns true if two faces with the same vertices have the same orientation.
fn same_orientation(a: [VertexId; 3], b: [VertexId; 3]) -> bool {
    (0..3).any(|k| [b[k], b[(k + 1) % 3], b[(k + 2) % 3]] == a)
}
