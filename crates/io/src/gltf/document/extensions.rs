//! Extensions of glTF: their names, the supported ones, and the lists in a document.

use serde_json::{Value, json};

use super::entries::extend;
use super::schema;
use crate::error::ParseError;
use crate::gltf::read::tiles::RTC;

/// Extensions for meshopt streams; the second adds a version and a filter to the first.
pub(crate) const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Extension for primitives compressed by Draco.
pub(crate) const DRACO: &str = "KHR_draco_mesh_compression";

/// Extension for several instances of a node's mesh.
pub(crate) const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// Extension that links a node to its coarser levels.
pub(crate) const MSFT_LOD: &str = "MSFT_lod";

/// Extension of the client of Needle: finer levels of meshes and sizes of images, in other files.
pub(crate) const NEEDLE: &str = "NEEDLE_progressive";

/// Extension for emitted light brighter than 1.
pub(crate) const EMISSIVE_STRENGTH: &str = "KHR_materials_emissive_strength";

/// Extension for textures whose image is a WebP.
pub(crate) const WEBP: &str = "EXT_texture_webp";

/// Advice for glTF 1.0.
pub(super) const OLD: &str = "; convert it first, as gltf-pipeline does";

/// Rejects other versions of glTF and unknown required extensions.
pub(crate) fn check_head(json: &Value) -> Result<(), ParseError> {
    let version = json.pointer("/asset/version").and_then(Value::as_str).unwrap_or("");
    if !version.starts_with("2.") {
        let advice = if version.starts_with("1.") { OLD } else { "" };
        let reason = format!("glTF version {version:?}; only 2.0 is supported{advice}");
        return Err(ParseError::part("asset", reason));
    }
    let required: Vec<String> = schema::array(json, "extensionsRequired", "extensionsRequired")?;
    match required.iter().find(|name| !is_understood(name)) {
        None => Ok(()),
        Some(name) if compresses(name) => Err(compressed("extensionsRequired", name)),
        Some(name) => {
            let reason = format!("the file requires the extension {name}, which is not supported");
            Err(ParseError::part("extensionsRequired", reason))
        }
    }
}

/// Reports whether an extension is supported or leaves the geometry alone: none of the latter refers
/// to accessors.
pub(crate) fn is_understood(name: &str) -> bool {
    const GEOMETRY: [&str; 6] =
        ["KHR_mesh_quantization", "MSFT_lod", INSTANCING, MESHOPT[0], MESHOPT[1], RTC];
    const OTHERS: [&str; 13] = [
        "KHR_materials_",
        "KHR_texture_",
        "KHR_lights_",
        "KHR_animation_",
        "KHR_xmp",
        "KHR_audio",
        "EXT_texture_",
        "EXT_lights_",
        "MSFT_texture_",
        "MSFT_packing_",
        "MSFT_screencoverage",
        "EXT_materials_",
        NEEDLE,
    ];
    let is_draco = cfg!(feature = "draco") && name == DRACO;
    is_draco || GEOMETRY.contains(&name) || OTHERS.iter().any(|prefix| name.starts_with(prefix))
}

/// Reports whether an extension compresses geometry.
pub(super) fn compresses(name: &str) -> bool {
    name.contains("draco") || name.contains("meshopt")
}

/// Error for geometry in an unsupported compressed form.
pub(crate) fn compressed(part: &str, extension: &str) -> ParseError {
    let reason = match extension {
        DRACO => format!(
            "compressed with {DRACO}, which needs a build with the feature `draco`; build with \
             `--features draco`, or export the file without Draco"
        ),
        _ => format!("compressed with {extension}, which is not supported; decompress it first"),
    };
    ParseError::part(part, reason)
}

/// Removes an extension from an object, and `extensions` if it becomes empty.
pub(crate) fn drop_entry(of: &mut Value, name: &str) {
    let Some(of) = of.as_object_mut() else { return };
    if let Some(extensions) = of.get_mut("extensions").and_then(Value::as_object_mut) {
        extensions.shift_remove(name);
        if extensions.is_empty() {
            of.shift_remove("extensions");
        }
    }
}

/// Removes extensions from the lists of used and required ones.
pub(crate) fn forget_names(json: &mut Value, extensions: &[&str]) {
    for key in ["extensionsUsed", "extensionsRequired"] {
        let Some(names) = json.get_mut(key).and_then(Value::as_array_mut) else { continue };
        let before = names.len();
        names.retain(|name| !extensions.iter().any(|known| *name == json!(known)));
        if names.is_empty() && before > 0 {
            json.as_object_mut().map(|json| json.shift_remove(key));
        }
    }
}

/// Adds an extension to `extensionsUsed` or `extensionsRequired`, once.
pub(crate) fn list_extension(json: &mut Value, key: &str, extension: &str) {
    let listed = json.get(key).and_then(Value::as_array);
    if !listed.is_some_and(|names| names.iter().any(|name| name == extension)) {
        extend(json, key, vec![extension.into()]);
    }
}
