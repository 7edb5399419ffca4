//! Document being written: its new geometry, then its files.

use serde_json::{Map, Value};

use super::buffer::BufferBuilder;
use super::buffer::accessor_use::free_accessors_with;
use super::empty_meshes::detach_meshes;
use super::levels::Levels;
use super::needle::images::{with_small_images, without_images};
use super::new_document::copies::with_copies_as_nodes;
use super::new_document::local_space::localized;
use super::new_document::objects::split_objects;
use super::quantized::{Grids, nodes};
use super::replacer::Replacer;
use super::same_geometry::same_geometry;
use super::settings::{Compression, CompressionReport};
use super::{lod, needle, new_document};
use crate::error::{ParseError, Unsupported};
use crate::files::names::inner_path;
use crate::gltf::animation::packing::PackedAnimations;
use crate::gltf::document::source::Contents;
use crate::gltf::document::uri::Uri;
use crate::gltf::document::{Document, container, uri};
use crate::gltf::read::mesh;
use crate::scene::{Image, Scene, image_file};

/// Contents of a `.gltf` file, its buffer and its images.
#[derive(Clone, Debug)]
pub struct GltfFiles {
    /// JSON text of the `.gltf` file.
    pub document: Vec<u8>,
    /// File name and contents of the binary buffer, if there is one.
    pub buffer: Option<(String, Vec<u8>)>,
    /// Image files that the document refers to, by the names it uses.
    pub images: Vec<Image>,
}

/// Document with its new geometry, before its buffer is attached.
pub(crate) struct Output {
    pub json: Map<String, Value>,
    pub builder: BufferBuilder,
    pub report: CompressionReport,
    /// Files beside the document, by names with `/`.
    pub parts: Vec<Image>,
}

impl Output {
    pub fn of(
        scene: &Scene,
        levels: Levels<'_>,
        compression: Option<&Compression>,
    ) -> Result<Self, Unsupported> {
        compression.map_or(Ok(()), Compression::check)?;
        match &scene.source {
            Some(source) => Self::with_source(scene, &source.0, levels, compression),
            None => {
                let scene = with_copies_as_nodes(scene);
                let small = levels.needle.map(|needle| with_small_images(&scene, needle));
                let scene = small.as_ref().unwrap_or(&scene);
                let (scene, moved) = localized(scene, levels.levels);
                let mut builder = BufferBuilder::default();
                // Objects on grids of their own would come apart where they meet.
                let split = compression.is_none().then(|| split_objects(&scene, &moved)).flatten();
                let split = split.as_ref().map(|split| (&split.scene, &split.levels[..]));
                let images = &scene.images;
                let (scene, moved) = split.unwrap_or((&scene, &moved));
                let levels = Levels { levels: moved, ..levels };
                let json = new_document::document(scene, images, &mut builder);
                let all = vec![true; scene.meshes.len()];
                let grids = grids((&json, None), scene, levels, compression);
                let mut replacer = Replacer::new(None, builder);
                replacer.compression = compression;
                let parts = (grids, PackedAnimations::default());
                Self::finish(json, (scene, &all), parts, replacer, levels)
            }
        }
    }

    fn with_source(
        scene: &Scene,
        source: &Contents,
        levels: Levels<'_>,
        compression: Option<&Compression>,
    ) -> Result<Self, Unsupported> {
        let own: Value;
        let (json, dropped) = match levels.needle {
            Some(needle) => {
                let dropped;
                (own, dropped) = without_images(&source.json, needle);
                (&own, dropped)
            }
            None => (&source.json, Vec::new()),
        };
        let document = Document::new(json, &source.buffers).map_err(unreadable)?;
        check_meshes(scene, &document)?;
        let mut changed = Vec::new();
        for (index, mesh) in scene.meshes.iter().enumerate() {
            let is_empty = || source.emptied.get(index) == Some(&true);
            let differs = || {
                let (old, replaced) =
                    mesh::read(&document, index, source.weld).map_err(unreadable)?;
                Ok(!replaced.is_empty() || !same_geometry(&old, &mesh.mesh))
            };
            let is_new = compression.is_some() || levels.needle.is_some();
            changed.push(is_new || is_empty() || differs()?);
        }
        let grids = grids((json, Some(&document)), scene, levels, compression);
        // A document of its own, so that its allowance of values is not spent on animations.
        let animations = match compression {
            Some(own) => {
                let document = Document::new(json, &source.buffers).map_err(unreadable)?;
                PackedAnimations::of(&document, own)
            }
            None => PackedAnimations::default(),
        };
        let free =
            free_accessors_with(&document, &changed, &grids.skins.replaced(json), &|place| {
                animations.replaces(place)
            });
        let mut replacer =
            Replacer::new(Some(&document), BufferBuilder::without(&document, &free, &dropped));
        replacer.compression = compression;
        let parts = (grids, animations);
        Self::finish(json.clone(), (scene, &changed), parts, replacer, levels)
    }

    /// Puts the changed meshes and the levels into the document.
    fn finish(
        mut json: Value,
        (scene, changed): (&Scene, &[bool]),
        (grids, animations): (Grids, PackedAnimations),
        mut replacer: Replacer<'_>,
        levels: Levels<'_>,
    ) -> Result<Self, Unsupported> {
        let templates = json.get("meshes").and_then(Value::as_array).cloned().unwrap_or_default();
        let Grids { of_mesh: grids, skins, kept } = grids;
        if let Some(compression) = replacer.compression {
            skins.enter(&mut json, &mut replacer.builder);
            nodes::add_transforms(&mut json, &grids);
            if compression.meshopt {
                replacer.builder.compress();
            }
            animations.enter(&mut json, &mut replacer.builder);
        }
        if let Some(needle) = levels.needle {
            let parts =
                needle::add(&mut json, scene, levels.levels, needle, &grids, &mut replacer)?;
            return Self::of_json(json, replacer, kept, parts);
        }
        let mut gone = Vec::new();
        for (index, mesh) in scene.meshes.iter().enumerate().filter(|&(index, _)| changed[index]) {
            let mut new = templates[index].clone();
            if replacer.replace(&mut new, &mesh.mesh, grids[index].as_ref())? {
                gone.push(index);
            }
            json["meshes"][index] = new;
        }
        if levels.levels.is_empty() {
            detach_meshes(&mut json, &gone);
        } else {
            lod::add(&mut json, &templates, &grids, levels, &mut replacer)?;
        }
        Self::of_json(json, replacer, kept, Vec::new())
    }

    fn of_json(
        mut json: Value,
        replacer: Replacer<'_>,
        kept: Vec<String>,
        parts: Vec<Image>,
    ) -> Result<Self, Unsupported> {
        let report = replacer.report(kept);
        replacer.list_extensions(&mut json);
        match json {
            Value::Object(json) => Ok(Self { json, builder: replacer.builder, report, parts }),
            _ => Err(Unsupported::new("source", "is not a JSON object")),
        }
    }

    pub fn into_glb(mut self, scene: &Scene) -> Result<Vec<u8>, Unsupported> {
        self.embed_images(scene, |_| true);
        let buffer = self.builder.finish(&mut self.json);
        container::join(&to_bytes(self.json)?, &buffer)
    }

    /// Makes files of the document; `name` names the buffer by its bytes.
    pub fn into_files(
        mut self,
        scene: &Scene,
        name: &dyn Fn(&[u8]) -> String,
    ) -> Result<GltfFiles, Unsupported> {
        // An image outside the folder is embedded: that file is not ours to write.
        self.embed_images(scene, |name| inner_path(name).is_none());
        let images = self.external_images(scene);
        let bytes = self.builder.finish(&mut self.json);
        let name = name(&bytes);
        if let Some(buffer) = self.json.get_mut("buffers") {
            buffer[0]["uri"] = uri::of_file(&name).into();
        }
        let document = to_bytes(self.json)?;
        Ok(GltfFiles { document, buffer: (!bytes.is_empty()).then_some((name, bytes)), images })
    }

    /// Moves images from files into the buffer, if their bytes are known and `inside` holds for
    /// their names.
    fn embed_images(&mut self, scene: &Scene, inside: impl Fn(&str) -> bool) {
        let images = self.json.get_mut("images").and_then(Value::as_array_mut);
        for (image, read) in images.into_iter().flatten().zip(&scene.images) {
            let Some(name) = file_name(image) else { continue };
            let Some(kind) = mime_type(&name, &read.bytes).filter(|_| inside(&name)) else {
                continue;
            };
            image["bufferView"] = self.builder.add_view(&read.bytes).into();
            image["mimeType"] = kind.into();
            if let Some(image) = image.as_object_mut() {
                image.shift_remove("uri");
            }
        }
    }

    fn external_images(&self, scene: &Scene) -> Vec<Image> {
        let images = self.json.get("images").and_then(Value::as_array);
        let pairs = images.into_iter().flatten().zip(&scene.images);
        pairs
            .filter(|(_, read)| !read.bytes.is_empty())
            .filter_map(|(image, read)| {
                Some(Image { name: file_name(image)?, bytes: read.bytes.clone() })
            })
            .collect()
    }
}

/// Chooses the quantization grids of a scene to be written as this JSON, from this document.
fn grids(
    of: (&Value, Option<&Document<'_>>),
    scene: &Scene,
    levels: Levels<'_>,
    compression: Option<&Compression>,
) -> Grids {
    match compression {
        Some(own) => Grids::choose(of, scene, levels.levels, own),
        None => Grids::none(scene),
    }
}

/// Refuses a scene whose number of meshes differs from its source document.
pub(crate) fn check_meshes(scene: &Scene, document: &Document<'_>) -> Result<(), Unsupported> {
    let (count, found) = (document.meshes.len(), scene.meshes.len());
    if found == count {
        return Ok(());
    }
    let reason = format!("has {count} meshes, but the scene has {found}; drop the source");
    Err(Unsupported::new("source", reason))
}

/// Returns the error that the source document cannot be read again.
pub(crate) fn unreadable(error: ParseError) -> Unsupported {
    Unsupported::new("source", error.to_string())
}

/// Returns the file that an image of a document refers to.
fn file_name(image: &Value) -> Option<String> {
    match uri::parse(image.get("uri")?.as_str()?) {
        Ok(Uri::File(name)) => Some(name),
        _ => None,
    }
}

/// Returns the MIME type of an image by its bytes, else by its name; `None` without bytes.
fn mime_type(name: &str, bytes: &[u8]) -> Option<&'static str> {
    let by_name = || {
        let suffix = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
        if suffix == "png" { "image/png" } else { "image/jpeg" }
    };
    (!bytes.is_empty()).then(|| image_file::mime_type(bytes).unwrap_or_else(by_name))
}

fn to_bytes(json: Map<String, Value>) -> Result<Vec<u8>, Unsupported> {
    serde_json::to_vec(&json).map_err(|error| Unsupported::new("JSON", error.to_string()))
}
