//! Parts of a simplified surface that keep it from having fewer faces.

use meshlod::check::{CheckOptions, Finding, Kind, Kinds, findings};
use meshlod::mesh::{Mesh, face_components};

/// Parts of a simplified scene that no contraction may take away.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stuck {
    /// Borders beyond the first one of each connected component.
    pub holes: usize,
    /// Meshes with faces, each of which keeps at least one.
    pub meshes: usize,
}

impl Stuck {
    /// Counts the parts of these meshes.
    pub fn of<'m>(meshes: impl IntoIterator<Item = &'m Mesh>) -> Self {
        let with_faces = meshes.into_iter().filter(|mesh| !mesh.faces.is_empty());
        with_faces.fold(Self::default(), |sum, mesh| Self {
            holes: sum.holes + holes(mesh),
            meshes: sum.meshes + 1,
        })
    }
}

/// Counts the borders of a mesh beyond the first one of each component.
fn holes(mesh: &Mesh) -> usize {
    let (of_face, count) = face_components(&mesh.faces, mesh.positions.len());
    let mut of_vertex = vec![0; mesh.positions.len()];
    for (face, &component) in mesh.faces.iter().zip(&of_face) {
        face.iter().for_each(|vertex| of_vertex[vertex.index()] = component as usize);
    }
    let mut borders = vec![0usize; count];
    let kinds = Kinds::NONE.with(Kind::BoundaryLoop);
    for found in findings(mesh, &CheckOptions { kinds, ..CheckOptions::default() }) {
        if let Finding::BoundaryLoop { vertices, closed: true } = found {
            borders[of_vertex[vertices[0].index()]] += 1;
        }
    }
    borders.iter().map(|borders| borders.saturating_sub(1)).sum()
}

#[cfg(test)]
mod tests {
    use meshlod::mesh::VertexId;

    use super::*;

    #[test]
    fn a_tube_has_a_hole_and_a_sheet_none() {
        // Triangles at both ends, and six faces between them.
        let side = |k: u32| [[k, (k + 1) % 3, k + 3], [(k + 1) % 3, (k + 1) % 3 + 3, k + 3]];
        let faces: Vec<_> = (0..3).flat_map(side).map(|face| face.map(VertexId)).collect();
        let place = |k: u32| [f64::from(k % 3), f64::from(k % 3 == 1), f64::from(k / 3)];
        let tube = Mesh::new((0..6).map(place).collect(), faces.clone());
        let sheet = Mesh::new(tube.positions.clone(), faces[..2].to_vec());
        let found = Stuck::of([&tube, &sheet, &Mesh::default()]);
        assert_eq!(found, Stuck { holes: 1, meshes: 2 });
    }
}
