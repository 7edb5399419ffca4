//! Sizes of images: the smallest for the document, each other in a file.

use serde_json::{Map, Value, json};

use super::meshes::set_extension;
use super::part::{PartFile, head, id};
use crate::error::Unsupported;
use crate::gltf::document::extensions::{NEEDLE, WEBP, drop_entry, forget_names, list_extension};
use crate::gltf::write::buffer::BufferBuilder;
use crate::gltf::write::levels::{ImageSizes, Needle, SizedImage};
use crate::scene::image_file::mime_type;
use crate::scene::{Image, Scene};

/// Copies a document without the images that are written in several sizes, and lists the buffer
/// views that held them.
pub(crate) fn without_images(json: &Value, needle: &Needle<'_>) -> (Value, Vec<usize>) {
    let (mut json, mut views) = (json.clone(), Vec::new());
    for sizes in needle.levels.images.iter().filter(|sizes| is_chain(sizes)) {
        if textures_of(&json, sizes.image).is_empty() {
            continue;
        }
        let Some(image) = json["images"][sizes.image].as_object_mut() else { continue };
        image.shift_remove("uri");
        views.extend(image.shift_remove("bufferView").and_then(|view| view.as_u64()));
    }
    (json, views.into_iter().map(|view| view as usize).collect())
}

/// Copies a scene with the smallest size of each image that is written in several.
pub(crate) fn with_small_images(scene: &Scene, needle: &Needle<'_>) -> Scene {
    let mut scene = scene.clone();
    for sizes in needle.levels.images.iter().filter(|sizes| is_chain(sizes)) {
        if let (Some(image), Some(small)) = (scene.images.get_mut(sizes.image), sizes.sizes.last())
        {
            image.bytes.clone_from(&small.bytes);
        }
    }
    scene
}

/// Puts the smallest size of each image into the document, and returns the files of the others.
///
/// The document is that of [`without_images`], or of the scene [`with_small_images`].
pub(crate) fn add(
    json: &mut Value,
    scene: &Scene,
    needle: &Needle<'_>,
    builder: &mut BufferBuilder,
) -> Result<Vec<Image>, Unsupported> {
    let mut files = Vec::new();
    for sizes in needle.levels.images.iter().filter(|sizes| is_chain(sizes)) {
        let place = match &scene.source {
            Some(_) => Some(sizes.image),
            None => place_of(json, scene, sizes, builder),
        };
        let Some(image) = place else { continue };
        let textures = textures_of(json, image);
        if textures.is_empty() {
            continue;
        }
        if scene.source.is_some() {
            embed(&mut json["images"][image], &sizes.sizes[sizes.sizes.len() - 1], builder);
        }
        files.extend(write(json, (image, &textures), sizes, needle)?);
    }
    let textures = json.get("textures").and_then(Value::as_array).into_iter().flatten();
    if textures.filter(|texture| texture["extensions"].get(WEBP).is_some()).count() == 0 {
        forget_names(json, &[WEBP]);
    }
    Ok(files)
}

fn is_chain(sizes: &ImageSizes) -> bool {
    sizes.sizes.len() > 1
}

/// Lists the textures that show an image.
fn textures_of(json: &Value, image: usize) -> Vec<usize> {
    let textures = json.get("textures").and_then(Value::as_array).into_iter().flatten();
    let shown = |texture: &Value| {
        let webp = texture["extensions"][WEBP]["source"].as_u64();
        webp.or_else(|| texture["source"].as_u64()) == Some(image as u64)
    };
    textures.enumerate().filter(|(_, texture)| shown(texture)).map(|(t, _)| t).collect()
}

/// Finds the image in a new document that has the smallest of these sizes.
fn place_of(
    json: &Value,
    scene: &Scene,
    sizes: &ImageSizes,
    builder: &BufferBuilder,
) -> Option<usize> {
    let (name, small) = (&scene.images.get(sizes.image)?.name, sizes.sizes.last()?);
    json.get("images")?.as_array()?.iter().position(|image| {
        let view = image["bufferView"].as_u64();
        image["name"].as_str() == Some(name)
            && view.is_some_and(|view| builder.view_bytes(view as usize) == Some(&small.bytes))
    })
}

fn embed(image: &mut Value, small: &SizedImage, builder: &mut BufferBuilder) {
    image["bufferView"] = builder.add_view(&small.bytes).into();
    image["mimeType"] = mime_type(&small.bytes).unwrap_or("image/png").into();
}

/// Writes the larger sizes of an image, each with all textures that show it.
fn write(
    json: &mut Value,
    (image, textures): (usize, &[usize]),
    sizes: &ImageSizes,
    needle: &Needle<'_>,
) -> Result<Vec<Image>, Unsupported> {
    let guid = |texture: &usize| {
        let number = texture.to_string();
        let texts = [needle.stem.as_bytes(), b"texture", number.as_bytes()];
        id(texts.into_iter().chain(sizes.sizes.iter().map(|size| &size.bytes[..])))
    };
    let guids: Vec<String> = textures.iter().map(guid).collect();
    let (small, larger) = sizes.sizes.split_last().expect("a chain has two");
    let (mut lods, mut files) = (Vec::new(), Vec::new());
    for own in larger {
        let [width, height] = own.size;
        let (document, buffer) = document(own, &guids);
        let name = format!("image{image}_{width}x{height}");
        let part = PartFile::new(needle.stem, &name, document, &buffer)?;
        lods.push(json!({
            "path": part.path, "hash": part.hash, "width": width, "height": height,
        }));
        files.push(part.file);
    }
    for (&texture, guid) in textures.iter().zip(&guids) {
        let texture = &mut json["textures"][texture];
        if mime_type(&small.bytes) != Some("image/webp") {
            drop_entry(texture, WEBP);
            texture["source"] = image.into();
        }
        set_extension(texture, json!({ "guid": guid, "lods": lods }));
    }
    Ok(files)
}

/// Builds the document of one size of an image: a texture for each id.
fn document(own: &SizedImage, guids: &[String]) -> (Map<String, Value>, Vec<u8>) {
    let kind = mime_type(&own.bytes).unwrap_or("image/png");
    let mut builder = BufferBuilder::default();
    let view = builder.add_view(&own.bytes);
    let mut json = Value::Object(head());
    list_extension(&mut json, "extensionsUsed", NEEDLE);
    if kind == "image/webp" {
        list_extension(&mut json, "extensionsUsed", WEBP);
        list_extension(&mut json, "extensionsRequired", WEBP);
    }
    json["images"] = json!([{ "bufferView": view, "mimeType": kind }]);
    let texture = |guid: &String| {
        let mut texture = match kind {
            "image/webp" => json!({ "extensions": { WEBP: { "source": 0 } } }),
            _ => json!({ "source": 0 }),
        };
        set_extension(&mut texture, json!({ "guid": guid }));
        texture
    };
    json["textures"] = guids.iter().map(texture).collect();
    let mut json = json.as_object().cloned().unwrap_or_default();
    let buffer = builder.finish(&mut json);
    (json, buffer)
}
