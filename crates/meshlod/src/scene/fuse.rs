//! Fusing of the intersecting components within each mesh of a scene.

use meshlod_check::{Fused, fuse};
use meshlod_io::Scene;
use meshlod_mesh::FaceId;
use meshlod_simplify::Target;

use crate::scene::place::shown_faces;

/// Merges intersecting closed components within each mesh of a scene; see [`fuse`]. Different
/// meshes are not merged.
///
/// Faces count as transparent if the base colour of their material is; textures are not looked at.
pub fn fuse_scene(scene: &mut Scene) -> Fused {
    let mut all = Fused::default();
    for own in &mut scene.meshes {
        let is_clear = |label: u32| {
            let material = own.materials.get(label as usize).copied().flatten();
            let material = material.and_then(|index| scene.materials.get(index));
            material.is_some_and(|material| material.base_color[3] < 1.0)
        };
        let labels = own.mesh.materials.as_ref();
        let is_solid =
            |face: FaceId| !labels.is_some_and(|labels| is_clear(labels.of(face.index())));
        let (mesh, fused) = fuse(&own.mesh, is_solid);
        own.mesh = mesh;
        all.add(&fused);
    }
    all
}

/// Numbers of what fusing has changed in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FuseReport {
    /// Number of faces shown before, over all instances of meshes.
    pub input_faces: usize,
    /// Number of faces shown afterwards, over all instances of meshes.
    pub output_faces: usize,
    /// Number of faces that were cut where they met others.
    pub cut_faces: usize,
    /// Number of vertices created where faces met.
    pub new_vertices: usize,
    /// Number of faces removed because they were inside.
    pub buried_faces: usize,
    /// Number of pairs of edges that were joined.
    pub joined_edges: usize,
    /// Number of components that could not be fused, as they are open or inside out.
    pub components_not_fused: usize,
    /// True if anything intersected that could be fused. Not part of what serde writes.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub is_change: bool,
}

impl FuseReport {
    /// Fuses a scene by [`fuse_scene`], and counts the changes.
    pub fn of(scene: &mut Scene) -> Self {
        let input_faces = shown_faces(scene);
        let fused = fuse_scene(scene);
        let Fused { imprint, buried, joined, left } = fused;
        Self {
            input_faces,
            output_faces: shown_faces(scene),
            cut_faces: imprint.faces,
            new_vertices: imprint.vertices,
            buried_faces: buried,
            joined_edges: joined,
            components_not_fused: left,
            is_change: fused != Fused { left, ..Fused::default() },
        }
    }

    /// Converts a target ratio to a number of faces, based on the faces before fusing.
    pub fn target(self, target: Target) -> Target {
        match target {
            Target::Ratio(ratio) => Target::Faces((self.input_faces as f64 * ratio) as usize),
            target => target,
        }
    }
}

#[cfg(test)]
mod tests {
    use meshlod_io::{Material, SceneMesh};
    use meshlod_mesh::{Labels, Mesh, VertexId};
    use meshlod_samples as samples;

    use super::*;

    /// Two balls that cross, the second of another material.
    fn balls(alpha: f32) -> Scene {
        let mut mesh = samples::sphere(500);
        let (vertices, faces) = (mesh.positions.len(), mesh.faces.len());
        let moved: Vec<_> = mesh.positions.iter().map(|[x, y, z]| [x + 1.0, y + 0.1, *z]).collect();
        mesh.positions.extend(moved);
        let second: Vec<_> =
            mesh.faces.iter().map(|f| f.map(|v| VertexId::new(vertices + v.index()))).collect();
        mesh.faces.extend(second);
        let of_face = (0..2 * faces).map(|face| u32::from(face >= faces)).collect();
        mesh.materials = Some(Labels { names: ["a", "b"].map(str::to_owned).into(), of_face });
        let material =
            |alpha| Material { base_color: [1.0, 1.0, 1.0, alpha], ..Material::default() };
        Scene {
            materials: vec![material(1.0), material(alpha)],
            meshes: vec![SceneMesh {
                mesh,
                materials: vec![Some(0), Some(1)],
                ..SceneMesh::default()
            }],
            ..Scene::default()
        }
    }

    fn of_second(mesh: &Mesh) -> usize {
        mesh.materials.as_ref().unwrap().of_face.iter().filter(|&&label| label == 1).count()
    }

    #[test]
    fn what_is_seen_through_glass_stays() {
        let [mut opaque, mut glass] = [balls(1.0), balls(0.5)];
        let [of_opaque, of_glass] = [&mut opaque, &mut glass].map(fuse_scene);
        assert_eq!(of_opaque.imprint, of_glass.imprint);
        assert!(of_opaque.buried > of_glass.buried && of_glass.buried > 0);
        let [opaque, glass] = [&opaque, &glass].map(|scene| &scene.meshes[0].mesh);
        // Of the glass goes what is in the other, of the other nothing.
        assert_eq!(of_second(opaque), of_second(glass));
        assert!(opaque.faces.len() < glass.faces.len());
    }
}
