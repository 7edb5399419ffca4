//! Parts of a mesh that its levels leave out.

use meshlod_io::Note;
use meshlod_mesh::Mesh;

/// Counts the vertices that faces use.
pub(super) fn used_vertices(mesh: &Mesh) -> usize {
    mesh.used_vertices().iter().filter(|&&used| used).count()
}

/// Notes the vertices that no face uses, and the faces that a file with `kept` faces leaves out of a
/// mesh.
pub(super) fn unused_parts(mesh: &Mesh, kept: usize) -> [Note; 2] {
    let alone = mesh.positions.len() - used_vertices(mesh);
    let odd = mesh.faces.len().saturating_sub(kept);
    [
        Note::left_out(alone, "unused vertex", "unused vertices"),
        Note::left_out(odd, "degenerate or duplicate face", "degenerate or duplicate faces"),
    ]
}
