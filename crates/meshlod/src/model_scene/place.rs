//! Scenes on their way into a multiresolution file.

use std::collections::{BTreeMap, BTreeSet};

use meshlod_io::gltf::Skeleton;
use meshlod_io::{Image, Material, Node, Scene, SceneMesh, Unsupported};
use meshlod_mesh::{LayerKind, Locks, Mesh};
use meshlod_multires::Resource;
use meshlod_simplify::{Options, SimplifyError};
use thiserror::Error;

use super::head::{Head, MeshEntry, Slot};
use super::image_versions::versions;
use super::parts::{interleave, sort_parts};
use super::placement::placements;
use crate::{Constraints, VertexLocking, join_locks, locks};

/// A scene merged into one mesh in world space, of which levels are made.
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

/// Numbers of what a scene has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneCounts {
    /// Nodes, whether they show a mesh or not.
    pub nodes: usize,
    /// Meshes that the scene shows.
    pub meshes: usize,
    /// Meshes that it does not show. Of glTF they are kept as they are, of other formats left out.
    pub hidden_meshes: usize,
    /// Instances of meshes, at least as many as meshes shown.
    pub instances: usize,
    /// Materials.
    pub materials: usize,
    /// Images, including those without bytes.
    pub images: usize,
    /// Images whose file was not found.
    pub missing_images: usize,
    /// Skins.
    pub skins: usize,
    /// Animations.
    pub animations: usize,
    /// Shown meshes with joints.
    pub skinned_meshes: usize,
    /// Shown meshes with morph targets.
    pub morphing_meshes: usize,
}

/// All of a scene but the geometry of its levels, ready to be written.
#[derive(Clone, Debug)]
pub struct PackedScene {
    head: Head,
    animations: Vec<u8>,
    images: Vec<Image>,
    /// Marks the images that are base colours.
    is_color: Vec<bool>,
}

/// Reason why a scene cannot be merged into one mesh for its levels.
#[derive(Debug, Error)]
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
/// Cost: linear, or that of [`scene_locks`](crate::scene_locks) for contacts.
/// # Errors
/// Locks that do not match the scene, or a scene that does not match its source.
pub fn place_scene(
    mut scene: Scene,
    constraints: &Constraints,
    options: Options,
) -> Result<PlacedScene, PlaceError> {
    let locks = locks_of_meshes(&scene, constraints)?;
    let placed = placements(&scene);
    let counts = SceneCounts::of(&scene);
    let slots = slots_of(&scene);
    let is_bare = is_bare(&scene);
    let (mut flat, mut entries, mut given) = (Scene::default(), Vec::new(), Vec::new());
    flat.materials = slots.iter().map(|slot| material_of(&scene, *slot)).collect();
    let of_slots: BTreeMap<Slot, usize> = slots.iter().copied().zip(0..).collect();
    let names = names_of(&scene);
    let skeleton = match is_bare {
        true => Skeleton::default(),
        false => Skeleton::of(&scene, placed.iter().map(Option::is_some).collect())?,
    };
    for (index, placement) in placed.into_iter().enumerate() {
        entries.push(placement.map(|placement| MeshEntry {
            placement: placement.transform,
            is_only: placement.is_only,
            ..MeshEntry::default()
        }));
        let Some(placement) = placement else { continue };
        let mesh = std::mem::take(&mut scene.meshes[index]);
        let labels = slots_of_labels(&mesh.materials)
            .iter()
            .map(|slot| of_slots.get(slot).copied())
            .collect();
        let name = names[index].clone();
        let (transform, own) = (placement.transform, Some(flat.meshes.len()));
        flat.roots.push(flat.nodes.len());
        flat.nodes.push(Node { name, transform, mesh: own, children: Vec::new() });
        flat.meshes.push(SceneMesh { materials: labels, ..mesh });
        given.push(locks.get(index).cloned().unwrap_or_default());
    }
    let own_layers: Vec<_> = flat.meshes.iter().map(|mesh| layer_keys(&mesh.mesh)).collect();
    let own_objects: Vec<_> = flat.meshes.iter().map(|mesh| object_count(&mesh.mesh)).collect();
    let constraints = Constraints { locks: VertexLocking::Given(given), ..constraints.clone() };
    let (mesh, options) = constraints.flatten(flat, options)?;
    let all = layer_keys(&mesh);
    let placed = entries.iter_mut().flatten().zip(own_layers).zip(own_objects);
    for ((entry, layers), objects) in placed {
        entry.objects = objects;
        entry.layers = layers.iter().filter_map(|own| index_of(own, &all)).collect();
    }
    let is_color = colors(&scene);
    let rest = (!is_bare).then(|| {
        let animations = skeleton.animations.clone();
        let images = std::mem::take(&mut scene.images);
        let skeleton = Skeleton { animations: Vec::new(), ..skeleton };
        let count = images.len() as u32;
        let head = Head { skeleton, meshes: entries, slots, images: count, parts: Vec::new() };
        PackedScene { head, animations, images, is_color }
    });
    Ok(PlacedScene { mesh, options, rest, counts })
}

impl PackedScene {
    /// Returns the scene as resources of a file whose chunks have these lengths in bytes: what all
    /// need first, then images by size among the chunks.
    ///
    /// Cost: decoding every image, and encoding about a third of its texels.
    pub fn resources(&self, chunks: &[u64]) -> Vec<Resource> {
        let pairs = self.images.iter().zip(&self.is_color);
        let images = pairs.map(|(image, &is_color)| versions(&image.bytes, is_color)).collect();
        let parts = sort_parts(self.animations.clone(), images, &self.is_color);
        let kinds = parts.iter().map(|part| part.kind).collect();
        let head = Head { parts: kinds, ..self.head.clone() };
        interleave(head.to_bytes(), &parts, chunks)
    }
}

impl SceneCounts {
    fn of(scene: &Scene) -> Self {
        let instances = scene.instances();
        let mut is_shown = vec![false; scene.meshes.len()];
        instances.iter().for_each(|instance| is_shown[instance.mesh] = true);
        let shown = || scene.meshes.iter().zip(&is_shown).filter(|(_, shown)| **shown);
        let having = |is_meant: fn(LayerKind, &str) -> bool| {
            let has = |mesh: &Mesh| {
                let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
                layers.into_iter().any(|layer| is_meant(layer.kind, &layer.name))
            };
            shown().filter(|(mesh, _)| has(&mesh.mesh)).count()
        };
        let of_source = |key| scene.source.as_ref().map_or(0, |source| source.count(key));
        Self {
            nodes: scene.nodes.len(),
            meshes: shown().count(),
            hidden_meshes: is_shown.iter().filter(|shown| !**shown).count(),
            instances: instances.len(),
            materials: scene.materials.len(),
            images: scene.images.len(),
            missing_images: scene.images.iter().filter(|image| image.bytes.is_empty()).count(),
            skins: of_source("skins"),
            animations: of_source("animations"),
            skinned_meshes: having(|kind, _| matches!(kind, LayerKind::Joints(_))),
            morphing_meshes: having(|kind, name| {
                kind == LayerKind::Other && name.starts_with("target ")
            }),
        }
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

/// Lists the material labels of a merged scene: its materials, in order, and then what repeats
/// within a mesh. Repeated labels without material have one too, but for the first.
fn slots_of(scene: &Scene) -> Vec<Slot> {
    let all = (0..scene.materials.len() as u32).map(|i| Slot { material: Some(i), ordinal: 0 });
    let mut slots: Vec<Slot> = all.collect();
    let mut repeated = BTreeSet::new();
    for mesh in &scene.meshes {
        repeated
            .extend(slots_of_labels(&mesh.materials).into_iter().filter(|slot| slot.ordinal > 0));
    }
    slots.extend(repeated);
    slots
}

/// Returns the slot of each material label of a mesh, given their materials.
pub(super) fn slots_of_labels(materials: &[Option<usize>]) -> Vec<Slot> {
    let mut seen = BTreeMap::new();
    let slot = |material: &Option<usize>| {
        let material = material.map(|material| material as u32);
        let ordinal = seen.entry(material).or_insert(0);
        *ordinal += 1;
        Slot { material, ordinal: *ordinal - 1 }
    };
    materials.iter().map(slot).collect()
}

fn material_of(scene: &Scene, slot: Slot) -> Material {
    let material = slot.material.and_then(|index| scene.materials.get(index as usize));
    material.cloned().unwrap_or_default()
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

/// Kind, name and width, by which layers are told apart when meshes are merged.
type LayerKey = (LayerKind, String, usize);

fn layer_keys(mesh: &Mesh) -> Vec<LayerKey> {
    let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
    layers.map(|layer| (layer.kind, layer.name.clone(), layer.width)).collect()
}

/// Returns the index of a layer among those of the merged mesh, and its own width.
fn index_of((kind, name, width): &LayerKey, all: &[LayerKey]) -> Option<[u32; 2]> {
    let is_same = |other: &LayerKey| {
        other.0 == *kind && (*kind != LayerKind::Other || (&other.1, other.2) == (name, *width))
    };
    Some([all.iter().position(is_same)? as u32, *width as u32])
}

fn object_count(mesh: &Mesh) -> Option<u32> {
    mesh.objects.as_ref().map(|objects| objects.names.len() as u32)
}
