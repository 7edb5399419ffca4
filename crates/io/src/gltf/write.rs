//! Writing glTF and GLB: the document that a scene was read from, with its geometry replaced.

use meshlod_mesh::Mesh;
use serde_json::{Map, Value};

use super::accessor_use::free_accessors_with;
use super::animation::packing::PackedAnimations;
use super::buffer_builder::BufferBuilder;
use super::compress::{Compression, CompressionReport, Grids};
use super::document::Document;
use super::instancing::with_copies_as_nodes;
use super::local_space::localized;
use super::lod::{self, Level, Levels, LodLayout};
use super::object_nodes::split_objects;
use super::primitives::Replacer;
use super::read::Contents;
use super::uri::{self, Uri};
use super::{container, dequantize_nodes, mesh, new_document};
use crate::{Image, ParseError, Scene, Unsupported, image_file};

/// Contents of a `.gltf` file and of the buffer and image files that belong to it.
#[derive(Clone, Debug)]
pub struct GltfFiles {
    /// JSON text of the `.gltf` file.
    pub document: Vec<u8>,
    /// File name and contents of the binary buffer, if there is one.
    pub buffer: Option<(String, Vec<u8>)>,
    /// Image files that the document refers to, by the names it uses.
    pub images: Vec<Image>,
}

/// Encodes a scene as a single GLB file; `levels`, which may be empty, are its coarser levels of
/// detail.
///
/// A scene read from glTF is written as that document. Nodes, materials, animations, extras,
/// extensions and everything else pass through. An unchanged mesh keeps its arrays bit for bit; a
/// changed one gets new arrays (f32, 16-bit indices where possible, colours in their old type). The
/// buffer is rebuilt without what is no longer used. Any other scene gets a new document with its
/// nodes, materials and images, in which each object of a mesh is a node and a mesh; meshes whose
/// coordinates 32 bits would round are stored relative to a centre, from which their nodes move them
/// back. A mesh without faces keeps one degenerate triangle, as glTF
/// does not allow empty meshes.
///
/// With levels, every node with a mesh is named `…_LOD0` and linked by the extension `MSFT_lod` to
/// nodes `…_LOD1`, `…_LOD2` and so on, and its `extras.MSFT_screencoverage` holds the coverage at
/// which each is shown. A node that has children or is animated keeps its name, and a new child
/// takes its mesh.
///
/// # Errors
/// If a mesh is invalid or exceeds 32 bits, if the labels or the number of meshes do not match the
/// source, or above 4 GB.
pub fn write_glb(scene: &Scene, levels: &[Level]) -> Result<Vec<u8>, Unsupported> {
    Output::of(scene, levels.into(), None)?.into_glb(scene)
}

/// Encodes a scene and its coarser levels of detail as a single GLB file, laid out as asked.
///
/// # Errors
/// Errors of [`write_glb`].
pub fn write_lods_glb(
    scene: &Scene,
    levels: &[Level],
    layout: LodLayout,
) -> Result<Vec<u8>, Unsupported> {
    Output::of(scene, Levels { levels, layout }, None)?.into_glb(scene)
}

/// Encodes a scene as a compressed GLB file, and returns the compressed sizes and the quantization
/// error.
///
/// Positions are quantized to a uniform grid per mesh, shared by its levels, with equal cells on
/// all axes. A vertex moves by at most half a cell per axis, and primitives that met still meet.
/// The nodes that show the mesh, or new children of them, scale and translate it back; of a skinned
/// mesh, so do the inverse bind matrices. Morph targets move vertices by whole cells. Positions stay
/// floats, and the report says so, where that cannot be: with points or lines, materials with
/// thickness, instancing.
///
/// Normals and tangents become bytes or shorts. Texture coordinates in [0, 1] become normalised
/// integers; others stay floats. Colours in [0, 1] become bytes, unless the file had shorts, and
/// joint weights bytes that sum to 255. Everything else is kept. Faces and vertices are sorted for
/// the vertex cache. With
/// [`Compression::meshopt`], the geometry is stored in meshopt streams, and texture coordinates
/// outside [0, 1] are rounded to the requested bits as well. Images are kept.
///
/// Animations keep their channels, and at any time a pose is within
/// [`Compression::animation_degrees`] of what it was: keys that interpolation of the others gives go,
/// rotations become shorts. Cubic splines, weights and malformed samplers stay as they are. The
/// objects of a mesh stay one mesh, and have no names.
///
/// # Errors
/// Errors of [`write_glb`]; also bit counts out of range.
/// # References
/// [Kap20], [KS21]
pub fn write_compressed_glb(
    scene: &Scene,
    levels: &[Level],
    compression: &Compression,
) -> Result<(Vec<u8>, CompressionReport), Unsupported> {
    let mut output = Output::of(scene, levels.into(), Some(compression))?;
    let report = std::mem::take(&mut output.report);
    Ok((output.into_glb(scene)?, report))
}

/// Encodes a scene as a `.gltf` file named `stem.gltf` and its buffer `stem.bin`.
///
/// Images that were files stay files. See [`write_glb`].
///
/// # Errors
/// Errors of [`write_glb`], except for the size.
pub fn write(scene: &Scene, levels: &[Level], stem: &str) -> Result<GltfFiles, Unsupported> {
    Ok(files(scene, levels.into(), None, &|_| buffer_name(stem))?.0)
}

/// Encodes a scene as a compressed `.gltf` file and the files that belong to it.
///
/// Files are laid out as by [`write()`] and compressed as by [`write_compressed_glb`].
///
/// # Errors
/// Errors of [`write_compressed_glb`], except for the size.
pub fn write_compressed(
    scene: &Scene,
    levels: &[Level],
    stem: &str,
    compression: &Compression,
) -> Result<(GltfFiles, CompressionReport), Unsupported> {
    files(scene, levels.into(), Some(compression), &|_| buffer_name(stem))
}

/// Encodes a scene as [`write()`] or [`write_compressed`] does; `name` names the buffer by its bytes.
pub(crate) fn files(
    scene: &Scene,
    levels: Levels<'_>,
    compression: Option<&Compression>,
    name: &dyn Fn(&[u8]) -> String,
) -> Result<(GltfFiles, CompressionReport), Unsupported> {
    let mut output = Output::of(scene, levels, compression)?;
    let report = std::mem::take(&mut output.report);
    Ok((output.into_files(scene, name)?, report))
}

pub(super) fn buffer_name(stem: &str) -> String {
    format!("{stem}.bin")
}

/// Document with its new geometry, before its buffer is attached.
pub(super) struct Output {
    pub json: Map<String, Value>,
    pub builder: BufferBuilder,
    pub report: CompressionReport,
}

impl Output {
    fn of(
        scene: &Scene,
        levels: Levels<'_>,
        compression: Option<&Compression>,
    ) -> Result<Self, Unsupported> {
        compression.map_or(Ok(()), Compression::check)?;
        match &scene.source {
            Some(source) => Self::with_source(scene, &source.0, levels, compression),
            None => {
                let scene = with_copies_as_nodes(scene);
                let (scene, moved) = localized(&scene, levels.levels);
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
        let json = &source.json;
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
            changed.push(compression.is_some() || is_empty() || differs()?);
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
        let mut replacer = Replacer::new(Some(&document), BufferBuilder::of(&document, &free));
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
            dequantize_nodes::add_transforms(&mut json, &grids);
            if compression.meshopt {
                replacer.builder.compress();
            }
            animations.enter(&mut json, &mut replacer.builder);
        }
        for (index, mesh) in scene.meshes.iter().enumerate().filter(|&(index, _)| changed[index]) {
            let mut new = templates[index].clone();
            replacer.replace(&mut new, &mesh.mesh, grids[index].as_ref())?;
            json["meshes"][index] = new;
        }
        if !levels.levels.is_empty() {
            lod::add(&mut json, &templates, &grids, levels, &mut replacer)?;
        }
        let report = replacer.report(kept);
        replacer.list_extensions(&mut json);
        match json {
            Value::Object(json) => Ok(Self { json, builder: replacer.builder, report }),
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
        self.embed_images(scene, |name| crate::files::inner_path(name).is_none());
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

/// Chooses the quantization grids of a scene that is written as this JSON, of this document.
fn grids(
    of: (&Value, Option<&Document<'_>>),
    scene: &Scene,
    levels: Levels<'_>,
    compression: Option<&Compression>,
) -> Grids {
    match compression {
        Some(own) => Grids::choose(of, scene, levels.levels, own.position_bits),
        None => Grids::none(scene),
    }
}

/// Refuses a scene that has not as many meshes as the document that it was read from.
pub(super) fn check_meshes(scene: &Scene, document: &Document<'_>) -> Result<(), Unsupported> {
    let (count, found) = (document.meshes.len(), scene.meshes.len());
    if found == count {
        return Ok(());
    }
    let reason = format!("has {count} meshes, but the scene has {found}; drop the source");
    Err(Unsupported::new("source", reason))
}

/// Returns the error that a document that was read cannot be read again.
pub(super) fn unreadable(error: ParseError) -> Unsupported {
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

/// Reports whether two meshes are equal in everything that is written of them.
fn same_geometry(a: &Mesh, b: &Mesh) -> bool {
    let label = |mesh: &Mesh, face| mesh.materials.as_ref().map(|labels| labels.of(face));
    a.positions == b.positions
        && a.faces == b.faces
        && a.attributes == b.attributes
        && (0..a.faces.len()).all(|face| label(a, face) == label(b, face))
}

fn to_bytes(json: Map<String, Value>) -> Result<Vec<u8>, Unsupported> {
    serde_json::to_vec(&json).map_err(|error| Unsupported::new("JSON", error.to_string()))
}
