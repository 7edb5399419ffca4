//! Textured materials of faces without texture coordinates, which glTF does not allow.

use std::collections::{BTreeMap, BTreeSet};

use meshlod_mesh::{LayerKind, Mesh};

use crate::notes::Note;
use crate::scene::Scene;
use crate::scene::image_file::holds_image;

/// Materials with textures that are used by faces without texture coordinates.
pub(crate) struct UnmappedMaterials {
    /// For each material, whether faces with texture coordinates also use it.
    is_mapped: BTreeMap<usize, bool>,
}

impl UnmappedMaterials {
    /// Finds the materials in a scene.
    ///
    /// Cost: linear in the number of faces.
    pub fn of(scene: &Scene) -> Self {
        let [mut mapped, mut unmapped] = [BTreeSet::new(), BTreeSet::new()];
        for mesh in &scene.meshes {
            let labels: BTreeSet<u32> = match &mesh.mesh.materials {
                Some(labels) => labels.of_face.iter().copied().collect(),
                None => BTreeSet::from([0]),
            };
            let materials = labels.iter().filter_map(|&l| *mesh.materials.get(l as usize)?);
            if is_mapped(&mesh.mesh) { &mut mapped } else { &mut unmapped }.extend(materials);
        }
        let holds =
            |image: usize| scene.images.get(image).is_some_and(|image| holds_image(&image.bytes));
        let has_images =
            |index: &usize| scene.materials.get(*index).is_some_and(|own| own.images().any(holds));
        unmapped.retain(has_images);
        Self { is_mapped: unmapped.into_iter().map(|m| (m, mapped.contains(&m))).collect() }
    }

    /// Reports whether only faces without texture coordinates use a material.
    pub fn is_nowhere_mapped(&self, material: usize) -> bool {
        self.is_mapped.get(&material) == Some(&false)
    }

    /// Lists the materials that faces with texture coordinates also use, in order.
    pub fn elsewhere_mapped(&self) -> impl Iterator<Item = usize> {
        self.is_mapped.iter().filter(|(_, is_mapped)| **is_mapped).map(|(&material, _)| material)
    }

    /// Notes the textures left out.
    pub fn note(&self, scene: &Scene) -> Note {
        let names = self.is_mapped.keys().map(|&material| &*scene.materials[material].name);
        Note::left_out(
            self.is_mapped.len(),
            "material's textures where faces have no texture coordinates",
            "materials' textures where faces have no texture coordinates",
        )
        .named(names.filter(|name| !name.is_empty()))
    }
}

/// Reports whether a mesh has texture coordinates for the textures of a new document.
pub(crate) fn is_mapped(mesh: &Mesh) -> bool {
    mesh.attributes.as_ref().is_some_and(|own| own.layer(LayerKind::Uv(0)).is_some())
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::{Attributes, Layer, WedgeId};

    use super::*;
    use crate::gltf::{read, write_glb};
    use crate::{Format, Image, Material, Node, SceneMesh, Weld};

    fn mapped(mut mesh: Mesh) -> Mesh {
        let wedge_count = mesh.positions.len();
        let values = vec![0.5; 2 * wedge_count];
        let layer = Layer { kind: LayerKind::Uv(0), name: "uv".into(), width: 2, values };
        let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
        mesh.attributes = Some(Attributes { corners, wedge_count, layers: vec![layer] });
        mesh
    }

    /// A scene of these meshes, all of one textured material.
    fn textured(meshes: Vec<Mesh>) -> Scene {
        let count = meshes.len();
        let mesh = |mesh| SceneMesh { mesh, materials: vec![Some(0)], ..SceneMesh::default() };
        let material = Material { base_color: [0.5, 1.0, 1.0, 1.0], ..Material::default() };
        Scene {
            meshes: meshes.into_iter().map(mesh).collect(),
            nodes: (0..count).map(|m| Node { mesh: Some(m), ..Node::default() }).collect(),
            roots: (0..count).collect(),
            materials: vec![Material {
                name: "wood".into(),
                base_color_image: Some(0),
                ..material
            }],
            images: vec![Image { name: "a.png".into(), bytes: b"\x89PNG\r\n\x1a\n".to_vec() }],
            ..Scene::default()
        }
    }

    /// Material and texture of each mesh after a round trip.
    fn textures(scene: &Scene) -> Vec<(usize, Option<usize>)> {
        let back = read(&write_glb(scene, &[]).unwrap(), &mut |_| None, Weld::Exact).unwrap();
        let of = |mesh: &SceneMesh| {
            let material = mesh.materials[0].unwrap();
            assert_eq!(back.materials[material].base_color[0], 0.5, "the rest stays");
            (material, back.materials[material].base_color_image)
        };
        back.meshes.iter().map(of).collect()
    }

    #[test]
    fn textures_go_where_no_coordinates_are_and_only_there() {
        let cube = meshlod_fixtures::cube;
        let all = textured(vec![mapped(cube())]);
        assert_eq!(textures(&all), [(0, Some(0))]);
        assert!(all.limits_of(Format::Glb).is_empty());
        let none = textured(vec![cube()]);
        assert_eq!(textures(&none), [(0, None)]);
        let both = textured(vec![cube(), mapped(cube())]);
        assert_eq!(textures(&both), [(1, None), (0, Some(0))]);
        for scene in [none, both] {
            let notes = scene.limits_of(Format::Glb);
            let text = "1 material's textures where faces have no texture coordinates (wood)";
            assert_eq!(notes.iter().map(Note::to_string).collect::<Vec<_>>(), [text]);
        }
    }
}
