//! Comparison of meshes as they would be written.

use meshlod_mesh::Mesh;

/// Reports whether two meshes would be written identically.
pub(crate) fn same_geometry(a: &Mesh, b: &Mesh) -> bool {
    let label = |mesh: &Mesh, face| mesh.materials.as_ref().map(|labels| labels.of(face));
    a.positions == b.positions
        && a.faces == b.faces
        && a.attributes == b.attributes
        && (0..a.faces.len()).all(|face| label(a, face) == label(b, face))
}
