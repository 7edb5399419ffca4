//! Parts of a simplified surface that keep it from having fewer faces.

use meshlod::Scene;
use meshlod::check::{CheckOptions, Finding, Kind, Kinds, findings};
use meshlod::mesh::{Mesh, face_components};

/// Faces that a mesh has at most, on average, if their number is what keeps a scene from having
/// fewer: a closed mesh ends with four, a tube with six, and a sheet with one.
const FACES_KEPT: usize = 8;

/// Parts of a simplified scene that no contraction may take away.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stuck {
    /// Borders beyond the first one of each connected component.
    pub holes: usize,
    /// Meshes with faces, each of which keeps at least one.
    pub meshes: usize,
    /// Faces of these meshes, each once.
    pub faces: usize,
}

impl Stuck {
    /// Counts the parts of the meshes that a scene shows, or of others in their places.
    pub fn of<'m>(scene: &Scene, meshes: impl IntoIterator<Item = &'m Mesh>) -> Self {
        let mut is_shown = vec![false; scene.meshes.len()];
        scene.instances().iter().for_each(|shown| is_shown[shown.mesh] = true);
        let shown = meshes.into_iter().zip(is_shown).filter(|(_, is_shown)| *is_shown);
        let with_faces = shown.map(|(mesh, _)| mesh).filter(|mesh| !mesh.faces.is_empty());
        with_faces.fold(Self::default(), |sum, mesh| Self {
            holes: sum.holes + holes(mesh),
            meshes: sum.meshes + 1,
            faces: sum.faces + mesh.faces.len(),
        })
    }

    /// Returns true if the number of meshes is what keeps them from having fewer faces.
    pub fn by_meshes(&self) -> bool {
        self.meshes > 1 && self.faces <= FACES_KEPT * self.meshes
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
    use meshlod::io::{Node, SceneMesh};
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
        let scene = scene(&[true; 3]);
        let found = Stuck::of(&scene, [&tube, &sheet, &Mesh::default()]);
        assert_eq!(found, Stuck { holes: 1, meshes: 2, faces: 8 });
        assert!(found.by_meshes() && !Stuck { faces: 17, ..found }.by_meshes());
    }

    #[test]
    fn meshes_that_are_not_shown_hold_nothing_up() {
        let meshes = [meshlod::samples::sphere(20), meshlod::samples::sphere(20)];
        let found = Stuck::of(&scene(&[false, true]), &meshes);
        assert_eq!((found.meshes, found.faces), (1, meshes[1].faces.len()));
        assert!(!found.by_meshes());
    }

    /// A scene of empty meshes, of which it shows some.
    fn scene(is_shown: &[bool]) -> Scene {
        let node = |i: usize| Node { mesh: Some(i), ..Node::default() };
        Scene {
            meshes: vec![SceneMesh::default(); is_shown.len()],
            nodes: (0..is_shown.len()).map(node).collect(),
            roots: (0..is_shown.len()).filter(|&i| is_shown[i]).collect(),
            ..Scene::default()
        }
    }
}
