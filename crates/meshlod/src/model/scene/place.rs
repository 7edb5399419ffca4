//! Scenes on their way into a file of one mesh, multiresolution or compressed.

use std::collections::BTreeMap;

use glam::DMat4;
use meshlod_io::gltf::Skeleton;
use meshlod_io::{Image, Node, Scene, SceneMesh, Unsupported};
use meshlod_mesh::{LayerKind, Locks, Mesh};
use meshlod_multires::{FileError, Resource};
use meshlod_simplify::{Options, SimplifyError};
use thiserror::Error;

use super::counts::SceneCounts;
use super::head::{Head, MeshEntry, Slot};
use super::image_versions::{ImageVersion, versions, whole};
use super::parts::{interleave, sort_parts};
use super::placement::{Placement, placements};
use super::resources::join_resources;
use super::slots::{material_of, slots_of, slots_of_labels};
use crate::model::posed::PosedMesh;
use crate::model::{PoseCounts, ScenePoses};
use crate::scene::join_locks;
use crate::scene::locks;
use crate::{Constraints, VertexLocking};

/// A scene merged into one mesh in world space, ready for levels or compression.
#[derive(Clone, Debug)]
pub struct PlacedScene {
    /// Every mesh that the scene shows, once, as its largest instance.
    ///
    /// Materials are labels by index into those of the scene, and so on for [`Scene::flatten`], except
    /// that several primitives of one mesh with the same material have labels of their own.
    pub mesh: Mesh,
    /// Options with the constraints, for that mesh.
    pub options: Options,
    /// The rest of the scene; `None` if that is only a mesh.
    pub rest: Option<PackedScene>,
    /// Numbers of what the scene has.
    pub counts: SceneCounts,
}

/// All of a scene but the geometry of its merged mesh, ready to be written.
#[derive(Clone, Debug)]
pub struct PackedScene {
    head: Head,
    animations: Vec<u8>,
    images: Vec<Image>,
    /// Marks the images that are base colours.
    is_color: Vec<bool>,
    /// Nodes of the scene and its source, by which it is animated.
    animated: Scene,
}

/// Reason why a scene cannot be merged into one mesh for its levels.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlaceError {
    /// The scene is not that of its glTF source.
    #[error(transparent)]
    Source(#[from] Unsupported),
    /// The locks do not match the scene.
    #[error(transparent)]
    Locks(#[from] SimplifyError),
}

/// Merges a scene into one mesh in world space with constraints, each mesh once, and packs the rest.
///
/// A mesh that several nodes show is placed as the largest of them, so that an error of the merged
/// mesh is as large or larger than those it makes anywhere in the scene. Skins and morph targets are
/// not applied. Meshes are objects of the merged one.
///
/// Cost: linear, or that of [`scene_locks`](crate::scene::scene_locks) for contacts.
/// # Errors
/// Locks that do not match the scene, or a scene that does not match its source.
pub fn place_scene(
    mut scene: Scene,
    constraints: &Constraints,
    options: Options,
) -> Result<PlacedScene, PlaceError> {
    let locks = locks_of_meshes(&scene, constraints)?;
    let counts = SceneCounts::of(&scene);
    let placed = placements(&scene);
    let mut rest = None;
    if !is_bare(&scene) {
        let skeleton = Skeleton::of(&scene, placed.iter().map(Option::is_some).collect())?;
        rest = Some(PackedScene::new(&scene, skeleton));
    }
    let flat = each_mesh_once(&mut scene, &placed);
    let own: Vec<MeshParts> = flat.meshes.iter().map(|mesh| MeshParts::of(&mesh.mesh)).collect();
    let shown = (0..placed.len()).filter(|&index| placed[index].is_some());
    let given = shown.map(|index| locks.get(index).cloned().unwrap_or_default()).collect();
    let constraints = Constraints { locks: VertexLocking::Given(given), ..constraints.clone() };
    let (mesh, options) = constraints.flatten(flat, options)?;
    if let Some(rest) = &mut rest {
        rest.images = std::mem::take(&mut scene.images);
        let (all, mut own) = (MeshParts::of(&mesh), own.iter());
        let entry = |placement: &Option<Placement>| {
            placement.zip(own.next()).map(|(placement, own)| own.entry(placement, &all))
        };
        rest.head.meshes = placed.iter().map(entry).collect();
    }
    Ok(PlacedScene { mesh, options, rest, counts })
}

/// Moves the meshes out of a scene into one that shows each once, where it is placed, with slots for
/// materials.
fn each_mesh_once(scene: &mut Scene, placed: &[Option<Placement>]) -> Scene {
    let slots = slots_of(scene);
    let of_slots: BTreeMap<Slot, usize> = slots.iter().copied().zip(0..).collect();
    let materials = slots.iter().map(|slot| material_of(scene, *slot)).collect();
    let mut flat = Scene { materials, ..Scene::default() };
    let names = names_of(scene);
    for (index, (placement, name)) in placed.iter().zip(names).enumerate() {
        let Some(Placement { transform, .. }) = *placement else { continue };
        let mesh = std::mem::take(&mut scene.meshes[index]);
        let labels = slots_of_labels(&mesh.materials);
        let materials = labels.iter().map(|slot| of_slots.get(slot).copied()).collect();
        flat.roots.push(flat.nodes.len());
        let own = Some(flat.meshes.len());
        flat.nodes.push(Node { name, transform, mesh: own, ..Node::default() });
        flat.meshes.push(SceneMesh { materials, ..mesh });
    }
    flat
}

impl PackedScene {
    /// Packs a scene without its meshes and images.
    fn new(scene: &Scene, mut skeleton: Skeleton) -> Self {
        let animations = std::mem::take(&mut skeleton.animations);
        let (slots, images) = (slots_of(scene), scene.images.len() as u32);
        let head = Head { skeleton, slots, images, ..Head::default() };
        let animated = Scene {
            nodes: scene.nodes.clone(),
            roots: scene.roots.clone(),
            source: scene.source.clone(),
            ..Scene::default()
        };
        Self { head, animations, images: Vec::new(), is_color: colors(scene), animated }
    }

    /// Chooses poses of the scene's animations, in which the errors of levels of its merged mesh can
    /// be measured; `None` if it has no animations, and its nodes bend no mesh.
    ///
    /// Cost: linear in the mesh, for each pose.
    pub fn poses(&self, mesh: &Mesh) -> Option<ScenePoses> {
        let posed = |entry: &MeshEntry| PosedMesh {
            back: DMat4::from_cols_array_2d(&entry.placement).inverse(),
            objects: entry.objects.unwrap_or(1),
            layers: entry.layers.iter().map(|[layer, _]| *layer).collect(),
        };
        let meshes: Vec<Option<PosedMesh>> =
            self.head.meshes.iter().map(|entry| entry.as_ref().map(posed)).collect();
        ScenePoses::new(&self.animated, &meshes, mesh)
    }

    /// Notes in how many poses errors were measured, for who reads the file.
    pub fn note_poses(&mut self, counts: PoseCounts) {
        self.head.poses = (counts.measured > 0).then_some(counts);
    }

    /// Returns the scene as resources of a multiresolution file whose chunks have these lengths in
    /// bytes: what all need first, then images by size among the chunks.
    ///
    /// Cost: decoding every image, and encoding about a third of its texels.
    pub fn resources(&self, chunks: &[u64]) -> Vec<Resource> {
        let pairs = self.images.iter().zip(&self.is_color);
        let images = pairs.map(|(image, &is_color)| versions(&image.bytes, is_color)).collect();
        self.with_images(images, chunks)
    }

    /// Returns the scene as the resources of a compressed file, images at full size only. Read it
    /// with [`ModelScene::unpack`](super::ModelScene::unpack).
    ///
    /// Cost: linear.
    /// # Errors
    /// An image or animations of 4 GiB or more.
    pub fn to_bytes(&self) -> Result<Vec<u8>, FileError> {
        let images = self.images.iter().map(|image| whole(&image.bytes)).collect();
        join_resources(&self.with_images(images, &[]))
    }

    fn with_images(&self, images: Vec<Vec<ImageVersion>>, chunks: &[u64]) -> Vec<Resource> {
        let parts = sort_parts(self.animations.clone(), images, &self.is_color);
        let kinds = parts.iter().map(|part| part.kind).collect();
        let head = Head { parts: kinds, ..self.head.clone() };
        interleave(head.to_bytes(), &parts, chunks)
    }
}

/// Returns true if a scene is nothing but a mesh.
fn is_bare(scene: &Scene) -> bool {
    let plain = Node { mesh: Some(0), ..Node::default() };
    let is_one = scene.meshes.len() == 1 && scene.nodes == [plain];
    is_one && scene.source.is_none() && scene.materials.is_empty()
}

/// Returns the locks of each mesh; none if there are no locks.
fn locks_of_meshes(scene: &Scene, constraints: &Constraints) -> Result<Vec<Locks>, SimplifyError> {
    let joined = join_locks(scene, &constraints.locks_of_meshes(scene))?;
    if joined == Locks::default() { Ok(Vec::new()) } else { locks::split(scene, &joined) }
}

/// Returns for each mesh the name of the first node that shows it.
fn names_of(scene: &Scene) -> Vec<String> {
    let mut names = vec![None; scene.meshes.len()];
    for instance in scene.instances() {
        names[instance.mesh].get_or_insert(&scene.nodes[instance.node].name);
    }
    names.into_iter().map(|name| name.cloned().unwrap_or_default()).collect()
}

/// Marks the images of a scene that are base colours.
fn colors(scene: &Scene) -> Vec<bool> {
    let mut is_color = vec![false; scene.images.len()];
    for image in scene.materials.iter().filter_map(|material| material.base_color_image) {
        is_color.get_mut(image).into_iter().for_each(|is_color| *is_color = true);
    }
    is_color
}

/// Objects and attribute layers of a mesh.
struct MeshParts {
    objects: Option<u32>,
    /// Kind, name and width of each layer.
    layers: Vec<(LayerKind, String, usize)>,
}

impl MeshParts {
    fn of(mesh: &Mesh) -> Self {
        let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
        let layers = layers.map(|layer| (layer.kind, layer.name.clone(), layer.width)).collect();
        Self { objects: mesh.objects.as_ref().map(|own| own.names.len() as u32), layers }
    }

    /// Returns the entry of this mesh, once it is merged into one that has all these layers.
    fn entry(&self, placement: Placement, all: &Self) -> MeshEntry {
        let place = |(kind, name, width): &(LayerKind, String, usize)| {
            let is_same = |other: &(LayerKind, String, usize)| {
                other.0 == *kind && (!kind.is_named() || (&other.1, other.2) == (name, *width))
            };
            Some([all.layers.iter().position(is_same)? as u32, *width as u32])
        };
        let mut layers: Vec<[u32; 2]> = Vec::new();
        for layer in self.layers.iter().filter_map(place) {
            // Layers that mean the same are one layer.
            if layers.iter().all(|known| known[0] != layer[0]) {
                layers.push(layer);
            }
        }
        let Placement { transform: placement, is_only } = placement;
        MeshEntry { placement, is_only, objects: self.objects, layers }
    }
}
