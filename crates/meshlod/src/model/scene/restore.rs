//! Scenes that come out of a file of one mesh, multiresolution or compressed.

use meshlod_io::gltf::{SkeletonImage, SourceDocument};
use meshlod_io::{Note, ParseError, Scene};
use meshlod_mesh::Mesh;
use meshlod_multires::{Archive, FileError, Source};
use thiserror::Error;

use super::head::Head;
use super::parts::PartKind;
use super::resources::{JoinedResources, Resources};
use super::split::split;
use crate::model::PoseCounts;

/// Scene of a multiresolution or compressed file, without the geometry of its mesh.
#[derive(Clone, Debug, Default)]
pub struct ModelScene {
    pub(super) head: Head,
    /// The scene, whose meshes of the levels are empty.
    pub(super) scene: Scene,
    /// True if positions and attributes have been rounded.
    is_rounded: bool,
    /// Parts that a truncated file lacks.
    pub missing: MissingParts,
}

/// Parts of a scene that a truncated file lacks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MissingParts {
    /// True if the file ends before nodes and materials.
    pub scene: bool,
    /// Number of images that exist as a smaller version only.
    pub previews: usize,
    /// Number of images that are missing altogether.
    pub images: usize,
    /// True if there are no key frames, so that the scene has no animations.
    pub animations: bool,
}

impl MissingParts {
    /// Returns notes on all kinds of parts, with a count of 0 where none is missing.
    pub fn notes(&self) -> Vec<Note> {
        let Self { scene, previews, images, animations } = *self;
        let note = |count, one, many| {
            Note::left_out(count, one, many).detailed(", which the truncated file lacks")
        };
        vec![
            note(scene.into(), "set of nodes and materials", ""),
            note(previews, "image but for a smaller version", "images but for smaller versions"),
            note(images, "image", "images"),
            note(animations.into(), "set of animations", ""),
        ]
    }
}

/// Reason why the scene of a multiresolution or compressed file cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ModelSceneError {
    /// The file is damaged.
    #[error(transparent)]
    File(#[from] FileError),
    /// The skeleton of the scene is damaged.
    #[error("the scene in the file is damaged: {0}; create the file again")]
    Skeleton(#[from] ParseError),
    /// The scene does not fit the levels.
    #[error("the scene in the file is damaged: {0}; create the file again")]
    Damaged(&'static str),
}

impl ModelScene {
    /// Reads the scene of a file, each image as large as the file has it. A file without a scene has
    /// one mesh.
    /// # Errors
    /// A file that is damaged.
    pub fn read<S: Source>(archive: &Archive<S>) -> Result<Self, ModelSceneError> {
        Ok(Self { is_rounded: !archive.is_lossless(), ..Self::of_resources(archive)? })
    }

    /// Decodes the scene in the resources of a compressed file, which
    /// [`PackedScene::to_bytes`](super::PackedScene::to_bytes) encoded. Without bytes, it has one
    /// mesh.
    ///
    /// # Errors
    /// Damaged bytes.
    pub fn unpack(bytes: &[u8]) -> Result<Self, ModelSceneError> {
        let resources = JoinedResources::split(bytes);
        let resources = resources.ok_or(ModelSceneError::Damaged("its parts are cut off"))?;
        Ok(Self { is_rounded: true, ..Self::of_resources(&resources)? })
    }

    fn of_resources(resources: &impl Resources) -> Result<Self, ModelSceneError> {
        if resources.count() == 0 {
            return Ok(Self::default());
        }
        let Some(bytes) = resources.read(0)? else {
            let missing = MissingParts { scene: true, ..MissingParts::default() };
            return Ok(Self { missing, ..Self::default() });
        };
        let mut head =
            Head::from_bytes(&bytes).ok_or(ModelSceneError::Damaged("its tables are wrong"))?;
        if head.parts.len() + 1 != resources.count() {
            return Err(ModelSceneError::Damaged("its parts are not those of the file"));
        }
        let mut missing = MissingParts::default();
        let images = read_images(resources, &head, &mut missing)?;
        let place = head.parts.iter().position(|part| *part == PartKind::Animations);
        let animations = match place {
            Some(place) => resources.read(place + 1)?,
            None => Some(Vec::new()),
        };
        missing.animations = animations.is_none();
        let mut skeleton = std::mem::take(&mut head.skeleton);
        skeleton.animations = animations.unwrap_or_default();
        let scene = skeleton.into_scene(images, !missing.animations)?;
        let count = scene.materials.len();
        let is_material = |material: Option<u32>| material.is_none_or(|m| (m as usize) < count);
        if !head.slots.iter().all(|slot| is_material(slot.material)) {
            return Err(ModelSceneError::Damaged("it lacks a material"));
        }
        Ok(Self { head, scene, is_rounded: false, missing })
    }

    /// Returns the numbers of poses in which the errors of the levels were measured; `None` if that was
    /// only the pose of the file.
    pub fn poses(&self) -> Option<PoseCounts> {
        self.head.poses
    }

    /// Returns the glTF document that the scene was read from, without geometry; `None` for other
    /// formats.
    pub fn source(&self) -> Option<&SourceDocument> {
        self.scene.source.as_ref()
    }

    /// Returns true if a level is what the scene shows: if it has each mesh where it is, and only
    /// there.
    pub fn is_flat(&self) -> bool {
        self.head.meshes.iter().flatten().all(|mesh| mesh.is_only)
    }

    /// Returns the number of meshes that the levels consist of.
    pub fn mesh_count(&self) -> usize {
        self.head.meshes.iter().flatten().count().max(1)
    }

    /// Returns true if each mesh of the levels is where it is by itself, so that coordinates are not
    /// changed when a level is taken apart.
    pub fn is_unmoved(&self) -> bool {
        let is_one = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        let identity = std::array::from_fn(|i| std::array::from_fn(|j| is_one(i, j)));
        self.head.meshes.iter().flatten().all(|mesh| mesh.placement == identity)
    }

    /// Returns a level as one mesh with the materials and images of the scene. Of several instances
    /// of a mesh it has one.
    pub fn flat_scene(&self, name: impl Into<String>, level: Mesh) -> Scene {
        let mut scene = Scene::from_mesh(name, level);
        if self.head.meshes.is_empty() {
            return scene;
        }
        let material = |label: &mut Option<usize>| {
            let slot = label.and_then(|label| self.head.slots.get(label));
            *label = slot.and_then(|slot| slot.material).map(|material| material as usize);
        };
        scene.meshes.iter_mut().flat_map(|mesh| &mut mesh.materials).for_each(material);
        let (materials, images) = (self.scene.materials.clone(), self.scene.images.clone());
        Scene { materials, images, ..scene }
    }

    /// Returns the scene with the meshes of a level, each in its own space: nodes, instances and
    /// materials, and all else that the file has of it. Without a scene in the file, the level is
    /// the only mesh.
    ///
    /// Cost: linear.
    /// # Errors
    /// A level that does not fit, as in a damaged file.
    pub fn into_scene(
        mut self,
        name: impl Into<String>,
        level: Mesh,
    ) -> Result<Scene, ModelSceneError> {
        if self.head.meshes.is_empty() {
            return Ok(Scene::from_mesh(name, level));
        }
        let Head { meshes, slots, .. } = &self.head;
        let split = split(&level, meshes, slots, self.is_rounded, &mut self.scene);
        split.ok_or(ModelSceneError::Damaged("the meshes of its levels are others"))?;
        match shown_size(&self.scene) <= MOST_SHOWN {
            true => Ok(self.scene),
            false => Err(ModelSceneError::Damaged("it shows more than 2^28 faces")),
        }
    }
}

/// Returns the numbers of poses in which the errors stored in a file were measured; `None` if that was
/// only the pose of the file, or if a truncated file does not tell.
///
/// Reads the scene without its images.
/// # Errors
/// A file that is damaged.
pub fn measured_poses<S: Source>(archive: &Archive<S>) -> Result<Option<PoseCounts>, FileError> {
    if archive.resource_count() == 0 || archive.has_old_resources() {
        return Ok(None);
    }
    let head = archive.resource(0)?.and_then(|bytes| Head::from_bytes(&bytes));
    Ok(head.and_then(|head| head.poses))
}

/// Most faces or vertices that a scene may show, over all instances, as where glTF is read.
const MOST_SHOWN: usize = 1 << 28;

fn shown_size(scene: &Scene) -> usize {
    let size = |mesh: &Mesh| mesh.faces.len().max(mesh.positions.len());
    let instances = scene.instances().into_iter();
    let sizes = instances.map(|instance| size(&scene.meshes[instance.mesh].mesh));
    sizes.fold(0, usize::saturating_add)
}

/// Reads the largest version that there is of each image.
fn read_images(
    resources: &impl Resources,
    head: &Head,
    missing: &mut MissingParts,
) -> Result<Vec<SkeletonImage>, ModelSceneError> {
    let mut best: Vec<Option<usize>> = vec![None; head.images as usize];
    let mut is_whole = vec![true; head.images as usize];
    for (part, kind) in head.parts.iter().enumerate() {
        let (PartKind::Preview(image) | PartKind::Image(image)) = *kind else { continue };
        let is_there = resources.has(part + 1)?;
        is_whole[image as usize] = is_there;
        if is_there {
            best[image as usize] = Some(part);
        }
    }
    let mut images = Vec::with_capacity(best.len());
    for (best, is_whole) in best.into_iter().zip(is_whole) {
        let Some(part) = best else {
            missing.images += usize::from(!is_whole);
            images.push(SkeletonImage { bytes: Vec::new(), is_preview: !is_whole });
            continue;
        };
        missing.previews += usize::from(!is_whole);
        let bytes = resources.read(part + 1)?.unwrap_or_default();
        images.push(SkeletonImage { bytes, is_preview: !is_whole });
    }
    Ok(images)
}
