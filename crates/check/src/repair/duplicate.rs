//! Faces that are there twice.

use meshlod_mesh::{Connectivity, FaceId, Mesh, VertexId};
use rustc_hash::FxHashSet;

use super::edit::retain_faces;
use crate::check::faces::duplicates;

/// Leaves out faces with the same vertices, the same way round, as an earlier one; says how many.
///
/// A face that is there both ways round is the two sides of a sheet, or the wall between two rooms:
/// taking one away would open the other. What splits edges takes these apart.
pub fn drop_duplicates(mesh: &mut Mesh) -> usize {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    // By the first face with the vertices: has it been the other way round already?
    let mut reversed: FxHashSet<FaceId> = FxHashSet::default();
    let dropped: FxHashSet<FaceId> = duplicates(&mesh.faces, &connectivity)
        .into_iter()
        .filter(|&(face, of)| {
            same_way(mesh.faces[face.index()], mesh.faces[of.index()]) || !reversed.insert(of)
        })
        .map(|(face, _)| face)
        .collect();
    retain_faces(mesh, |face| !dropped.contains(&FaceId(face as u32)))
}

/// Whether two faces with the same vertices go round the same way.
fn same_way(a: [VertexId; 3], b: [VertexId; 3]) -> bool {
    (0..3).any(|k| [b[k], b[(k + 1) % 3], b[(k + 2) % 3]] == a)
}
