//! Places and materials of the faces of a scene's levels, for renderers that draw the levels as they are.

use glam::DMat4;

use super::ModelScene;

/// Places and materials that a scene gives to the faces of its levels.
///
/// A level has the faces of each mesh once. This tells what they look like and where they are seen,
/// without taking the level apart as [`ModelScene::into_scene`] does.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneLayout {
    /// Label that [`Scene::flatten`](meshlod_io::Scene::flatten) gives to the faces of each material
    /// label of the levels, and in the end that of faces with another label or none; empty if it is
    /// the label itself.
    pub materials: Vec<u32>,
    /// Mesh of the scene of each object label of the levels; empty if all are of one mesh.
    pub meshes: Vec<u32>,
    /// Every place where a mesh is shown; empty if all are at their places in the levels.
    pub instances: Vec<LevelInstance>,
}

/// Place where the scene shows a mesh of its levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelInstance {
    /// Number of the mesh in the scene.
    pub mesh: u32,
    /// Column-major matrix from the space of the levels to that of the scene.
    pub transform: [[f64; 4]; 4],
}

impl ModelScene {
    /// Returns where the scene shows the faces of its levels, and in which materials.
    ///
    /// `objects` is the number of object labels of the levels. It fits the levels of the same file:
    /// [`ModelScene::into_scene`] tells whether they are damaged.
    pub fn layout(&self, objects: usize) -> SceneLayout {
        let (head, scene) = (&self.head, &self.scene);
        if head.meshes.is_empty() {
            return SceneLayout::default();
        }
        let bare = scene.materials.len() as u32;
        let slots = head.slots.iter().map(|slot| slot.material.unwrap_or(bare));
        let materials = slots.chain([bare]).collect();
        let entries = (0..).zip(&head.meshes);
        let entries = entries.filter_map(|(mesh, entry)| Some((mesh, entry.as_ref()?)));
        let owners = entries.clone().flat_map(|(mesh, entry)| {
            std::iter::repeat_n(mesh, entry.objects.unwrap_or(1) as usize)
        });
        let owners = owners.take(objects);
        let instance = |at: meshlod_io::MeshInstance| {
            let entry = head.meshes.get(at.mesh)?.as_ref()?;
            let placement = DMat4::from_cols_array_2d(&entry.placement);
            let world = DMat4::from_cols_array_2d(&at.transform) * placement.inverse();
            let transform = world.to_cols_array_2d();
            Some(LevelInstance { mesh: at.mesh as u32, transform })
        };
        let instances = match self.is_flat() {
            true => Vec::new(),
            false => scene.instances().into_iter().filter_map(instance).collect(),
        };
        SceneLayout { materials, meshes: owners.collect(), instances }
    }
}
