//! Skeletons of scenes: everything except the geometry of meshes, as bytes.

pub(crate) mod images;

use std::sync::Arc;

use meshlod_mesh::{Labels, Mesh};
use serde_json::{Value, json};

use crate::error::{ParseError, Unsupported};
use crate::gltf::document::buffers::Buffers;
use crate::gltf::document::extensions::check_head;
use crate::gltf::document::facts::FileFacts;
use crate::gltf::document::source::{Contents, SourceDocument};
use crate::gltf::document::{Document, missing};
use crate::gltf::read::images::read_images;
use crate::gltf::read::{materials, mesh, nodes};
use crate::gltf::write::buffer::accessor_use::{animation_accessors, free_accessors};
use crate::gltf::write::buffer::views::{copy_views, mark_views};
use crate::gltf::write::new_document;
use crate::gltf::write::new_document::material;
use crate::gltf::write::output::{check_meshes, unreadable};
use crate::options::Weld;
use crate::scene::{Scene, SceneMesh};
use images::{SkeletonImage, attach_images, detach_images, preview_name};

/// Scene without the geometry of some of its meshes and without its images, as bytes.
///
/// The rest of a scene read from glTF is kept: nodes, cameras, materials, skins, animations, extras
/// and extensions. Other scenes keep their nodes, names and materials.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Skeleton {
    /// JSON text of a glTF document.
    pub document: Vec<u8>,
    /// Buffer of everything except animations: inverse bind matrices, remaining geometry.
    pub buffer: Vec<u8>,
    /// Buffer of the key frames of animations.
    pub animations: Vec<u8>,
    /// True if the scene was read from glTF.
    pub is_gltf: bool,
    /// Marks the meshes whose geometry is left out.
    pub emptied: Vec<bool>,
}

/// Buffer of the key frames.
const ANIMATIONS: u64 = 1;

impl Skeleton {
    /// Copies a scene without its images and the geometry of the marked meshes. Points, lines and
    /// the geometry of other meshes are kept.
    ///
    /// # Errors
    /// If the number of marks or meshes differs from the source of the scene.
    pub fn of(scene: &Scene, emptied: Vec<bool>) -> Result<Self, Unsupported> {
        let Some(source) = &scene.source else {
            let document = new_document::skeleton(scene).to_string().into_bytes();
            return Ok(Self { document, emptied, ..Self::default() });
        };
        let document = Document::new(&source.0.json, &source.0.buffers).map_err(unreadable)?;
        check_meshes(scene, &document)?;
        if emptied.len() != document.meshes.len() {
            return Err(Unsupported::new("source", "has another number of meshes"));
        }
        let mut json = document.json.clone();
        let [buffer, animations] = split_buffers(&document, &mut json, &emptied);
        detach_images(&mut json);
        let document = json.to_string().into_bytes();
        Ok(Self { document, buffer, animations, is_gltf: true, emptied })
    }

    /// Makes a scene of the skeleton with these images; the marked meshes are empty, with a
    /// material label for each primitive.
    ///
    /// Embedded images are embedded again, and so are previews, since they differ from their files.
    /// `has_animations` is false if the key frames are lost: then there are no animations.
    ///
    /// # Errors
    /// The location and the reason, see [`read`](super::read), if the document is damaged.
    pub fn into_scene(
        self,
        images: Vec<SkeletonImage>,
        has_animations: bool,
    ) -> Result<Scene, ParseError> {
        let mut json: Value = serde_json::from_slice(&self.document)
            .map_err(|error| ParseError::part("JSON", error.to_string()))?;
        check_head(&json)?;
        if !has_animations {
            drop_animations(&mut json);
        }
        let mut buffers = vec![self.buffer, self.animations];
        check_count("images", json["images"].as_array().map_or(0, Vec::len), images.len())?;
        let files = match self.is_gltf {
            true => attach_images(&mut json, images, &mut buffers)?,
            false => images,
        };
        set_buffers(&mut json, &buffers);
        let buffers = Buffers::new(buffers);
        let mut scene = Scene::default();
        let document = Document::new(&json, &buffers)?;
        check_count("meshes", document.meshes.len(), self.emptied.len())?;
        read_materials(self.is_gltf, &document, files, &mut scene)?;
        for (index, &is_empty) in self.emptied.iter().enumerate() {
            scene.meshes.push(scene_mesh(&document, index, is_empty, scene.materials.len())?);
        }
        nodes::read(&document, &mut scene)?;
        if self.is_gltf {
            let facts = FileFacts::of(&json);
            let (weld, emptied) = (Weld::Off, self.emptied);
            let contents = Contents { json, buffers, weld, emptied, facts };
            scene.source = Some(SourceDocument(Arc::new(contents)));
        }
        Ok(scene)
    }
}

/// Lists the buffers in the document; the first one keeps its other entries.
fn set_buffers(json: &mut Value, buffers: &[Vec<u8>]) {
    let first = json.pointer("/buffers/0").cloned().filter(Value::is_object);
    let lengths = buffers.iter().map(|bytes| json!({ "byteLength": bytes.len() }));
    json["buffers"] = lengths.collect();
    if let Some(first) = first {
        json["buffers"][0] = first;
        json["buffers"][0]["byteLength"] = buffers[0].len().into();
    }
}

/// Reads the images, with the bytes of their files, and the materials.
fn read_materials(
    is_gltf: bool,
    document: &Document<'_>,
    files: Vec<SkeletonImage>,
    scene: &mut Scene,
) -> Result<(), ParseError> {
    let json = document.json;
    scene.images = match is_gltf {
        true => read_images(document, &mut |_| None)?,
        false => new_document::image_names(json),
    };
    for (image, file) in scene.images.iter_mut().zip(files) {
        image.bytes.extend(file.bytes);
        if file.is_preview {
            image.name = preview_name(&image.name);
        }
    }
    scene.materials = materials::materials(json, scene.images.len())?;
    if !is_gltf {
        material::take_all(json, scene.images.len(), &mut scene.materials)?;
    }
    Ok(())
}

/// Splits the bytes of a document into other data and animations, and drops geometry and images,
/// whose views become empty.
fn split_buffers(document: &Document<'_>, json: &mut Value, emptied: &[bool]) -> [Vec<u8>; 2] {
    let freed = free_accessors(document, emptied);
    let animated = animation_accessors(document, emptied);
    let count = document.views.len();
    let [mut unneeded, mut of_animations, mut of_others] = [(); 3].map(|()| vec![false; count]);
    for (key, value) in document.json.as_object().into_iter().flatten() {
        let marks = if key == "images" { &mut unneeded } else { &mut of_others };
        if key != "accessors" {
            mark_views(value, marks);
        }
    }
    let accessors = json.get_mut("accessors").and_then(Value::as_array_mut);
    for (index, accessor) in accessors.into_iter().flatten().enumerate() {
        let marks = match (freed[index], animated[index]) {
            (true, _) => &mut unneeded,
            (false, true) => &mut of_animations,
            (false, false) => &mut of_others,
        };
        mark_views(accessor, marks);
        if freed[index] {
            empty(accessor);
        }
    }
    let mut views = json.get("bufferViews").and_then(Value::as_array).cloned().unwrap_or_default();
    let [mut buffer, mut animations] = [Vec::new(), Vec::new()];
    let select = |wanted: &dyn Fn(usize) -> bool| (0..count).filter(|&v| wanted(v)).collect();
    let is_animated = |v: usize| of_animations[v] && !of_others[v];
    let is_kept = |v: usize| of_others[v] || !unneeded[v] && !of_animations[v];
    copy_views(document, select(&is_kept), &mut views, (0, &mut buffer));
    copy_views(document, select(&is_animated), &mut views, (1, &mut animations));
    let dropped: Vec<usize> = select(&|v| !is_animated(v) && !is_kept(v));
    dropped.into_iter().for_each(|v| views[v] = json!({ "buffer": 0, "byteLength": 0 }));
    if count > 0 {
        json["bufferViews"] = views.into();
    }
    [buffer, animations]
}

/// Empties an accessor but keeps its type.
fn empty(accessor: &mut Value) {
    let kept = ["bufferView", "componentType", "normalized", "type"];
    let entries = accessor.as_object().into_iter().flatten();
    let entries = entries.filter(|(key, _)| kept.contains(&key.as_str()));
    let mut new: serde_json::Map<_, _> = entries.map(|(k, v)| (k.clone(), v.clone())).collect();
    new.insert("count".into(), 0.into());
    *accessor = new.into();
}

/// Removes the animations, whose key frames are lost, and empties their accessors and views.
fn drop_animations(json: &mut Value) {
    if let Some(json) = json.as_object_mut() {
        json.shift_remove("animations");
    }
    let views = json.get_mut("bufferViews").and_then(Value::as_array_mut);
    let mut lost = Vec::new();
    for view in views.into_iter().flatten() {
        let is_lost = view.get("buffer").and_then(Value::as_u64) == Some(ANIMATIONS);
        lost.push(is_lost);
        if is_lost {
            *view = json!({ "buffer": 0, "byteLength": 0 });
        }
    }
    let accessors = json.get_mut("accessors").and_then(Value::as_array_mut);
    for accessor in accessors.into_iter().flatten() {
        let view = accessor.get("bufferView").and_then(Value::as_u64);
        if view.is_some_and(|view| lost.get(view as usize) == Some(&true)) {
            empty(accessor);
        }
    }
}

fn check_count(what: &str, listed: usize, there: usize) -> Result<(), ParseError> {
    match listed == there {
        true => Ok(()),
        false => Err(ParseError::part(what, format!("are {there}, but {listed} are listed"))),
    }
}

fn scene_mesh(
    document: &Document<'_>,
    index: usize,
    is_empty: bool,
    material_count: usize,
) -> Result<SceneMesh, ParseError> {
    let read = &document.meshes[index];
    let materials: Vec<Option<usize>> = read.primitives.iter().map(|p| p.material).collect();
    if let Some(&material) = materials.iter().flatten().find(|&&m| m >= material_count) {
        return Err(missing("material", material, material_count));
    }
    let mut mesh = Mesh::default();
    if is_empty {
        let names = (0..materials.len()).map(|p| format!("primitive {p}")).collect();
        mesh.materials = Some(Labels { names, of_face: Vec::new() });
    } else {
        (mesh, _) = mesh::read(document, index, Weld::Off)?;
    }
    Ok(SceneMesh { name: read.name.clone().unwrap_or_default(), mesh, materials })
}
