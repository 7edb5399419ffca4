//! Images of skeletons, detached from a document and attached again.

use serde_json::{Value, json};

use crate::error::ParseError;
use crate::gltf::document::entries::extend;
use crate::gltf::document::extensions::WEBP;
use crate::gltf::document::missing;
use crate::scene::image_file::mime_type;

/// Image for a scene made from a skeleton.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SkeletonImage {
    /// Encoded bytes of the image; empty if there are none.
    pub bytes: Vec<u8>,
    /// True if this is a smaller PNG in place of the image.
    pub is_preview: bool,
}

/// Replaces images in data URIs by empty buffer views, like images in buffers.
pub(crate) fn detach_images(json: &mut Value) {
    let count = json.get("bufferViews").and_then(Value::as_array).map_or(0, Vec::len);
    let mut added = Vec::new();
    let images = json.get_mut("images").and_then(Value::as_array_mut);
    for image in images.into_iter().flatten() {
        let is_data = |uri: &str| uri.get(..5).is_some_and(|s| s.eq_ignore_ascii_case("data:"));
        if image.get("uri").and_then(Value::as_str).is_some_and(is_data) {
            embed(image, count + added.len());
            added.push(json!({ "buffer": 0, "byteLength": 0 }));
        }
    }
    if !added.is_empty() {
        extend(json, "bufferViews", added);
    }
}

/// Makes an image refer to a view.
fn embed(image: &mut Value, view: usize) {
    if let Some(image) = image.as_object_mut() {
        image.shift_remove("uri");
        image.insert("bufferView".into(), view.into());
        image.entry("mimeType").or_insert("image/png".into());
    }
}

/// Adds embedded images and previews to the buffers. Returns the other images, which are files,
/// with empty ones in place of the embedded.
pub(crate) fn attach_images(
    json: &mut Value,
    images: Vec<SkeletonImage>,
    buffers: &mut Vec<Vec<u8>>,
) -> Result<Vec<SkeletonImage>, ParseError> {
    let mut files = vec![SkeletonImage::default(); images.len()];
    let mut replaced = vec![false; images.len()];
    for (index, SkeletonImage { mut bytes, is_preview }) in images.into_iter().enumerate() {
        let image = &mut json["images"][index];
        let kind = mime_type(&bytes);
        let view = image.get("bufferView").and_then(Value::as_u64).map(|view| view as usize);
        if view.is_none() && !is_preview {
            // As when a document is read, what is no image is not taken for one.
            if kind.is_some() {
                files[index].bytes = bytes;
            }
            continue;
        }
        replaced[index] = is_preview || bytes.is_empty();
        if bytes.is_empty() {
            // No valid document has an embedded image without bytes.
            bytes = NO_IMAGE.to_vec();
        }
        let whole = json!({ "buffer": buffers.len(), "byteLength": bytes.len() });
        buffers.push(bytes);
        let view = match view {
            Some(view) => {
                let views = json.get_mut("bufferViews").and_then(Value::as_array_mut);
                let count = views.as_ref().map_or(0, |views| views.len());
                let place = views.and_then(|views| views.get_mut(view));
                *place.ok_or_else(|| missing("bufferView", view, count))? = whole;
                view
            }
            None => extend(json, "bufferViews", vec![whole]),
        };
        embed(&mut json["images"][index], view);
        if let (Some(kind), Some(image)) = (kind, json["images"][index].as_object_mut()) {
            image.insert("mimeType".into(), kind.into());
        }
    }
    refer_to_png(json, &replaced);
    Ok(files)
}

/// Extensions for textures whose image is neither PNG nor JPEG.
const OTHER_FORMATS: [&str; 4] =
    [WEBP, "EXT_texture_avif", "KHR_texture_basisu", "MSFT_texture_dds"];

/// Makes textures refer directly to the marked images, which have become PNGs, and drops extensions
/// for other image formats that are no longer used.
fn refer_to_png(json: &mut Value, replaced: &[bool]) {
    if !replaced.contains(&true) {
        return;
    }
    let textures = json.get_mut("textures").and_then(Value::as_array_mut);
    for texture in textures.into_iter().flatten().filter_map(Value::as_object_mut) {
        let Some(own) = texture.get_mut("extensions").and_then(Value::as_object_mut) else {
            continue;
        };
        let mut found = None;
        for name in OTHER_FORMATS {
            let image = own.get(name).and_then(|other| other["source"].as_u64());
            if image.is_some_and(|image| replaced.get(image as usize) == Some(&true)) {
                own.shift_remove(name);
                found = found.or(image);
            }
        }
        if own.is_empty() {
            texture.shift_remove("extensions");
        }
        if let Some(image) = found {
            texture.insert("source".into(), image.into());
        }
    }
    let is_left = |name: &str| {
        let textures = json["textures"].as_array().into_iter().flatten();
        textures.into_iter().any(|texture| texture["extensions"].get(name).is_some())
    };
    let unused: Vec<&str> = OTHER_FORMATS.into_iter().filter(|name| !is_left(name)).collect();
    for key in ["extensionsUsed", "extensionsRequired"] {
        let Some(listed) = json.get_mut(key).and_then(Value::as_array_mut) else { continue };
        listed.retain(|name| !name.as_str().is_some_and(|name| unused.contains(&name)));
        if let (true, Some(json)) = (listed.is_empty(), json.as_object_mut()) {
            json.shift_remove(key);
        }
    }
}

/// Returns the name of a preview of an image file.
pub(crate) fn preview_name(name: &str) -> String {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    format!("{stem}.preview.png")
}

/// A white pixel as PNG, in place of an embedded image that is missing.
const NO_IMAGE: &[u8] = b"\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x01\x00\x00\x00\x01\x08\x00\x00\x00\x00\x3a\x7e\x9b\x55\x00\x00\x00\x0a\x49\x44\x41\x54\x78\xda\x63\xf8\x0f\x00\x01\x01\x01\x00\x1c\xb0\x8c\x99\x00\x00\x00\x00\x49\x45\x4e\x44\xae\x42\x60\x82";
