//! Materials of new glTF documents.

use serde::Deserialize;
use serde_json::{Value, json};

use super::named;
use crate::error::ParseError;
use crate::gltf::document::extensions::EMISSIVE_STRENGTH;
use crate::gltf::document::missing;
use crate::scene::material::{Material, MtlStatement, Shading};

/// Builds the JSON of a material; `texture` gives the texture of an image, if it may have one.
pub(crate) fn material(
    material: &Material,
    texture: &mut dyn FnMut(Option<usize>) -> Option<usize>,
) -> Value {
    let own = &material.shading;
    let color = material.base_color.map(|x| if x.is_finite() { unit(x) } else { 1.0 });
    let mut pbr = json!({
        "baseColorFactor": color,
        "metallicFactor": unit(own.metallic),
        "roughnessFactor": unit(own.roughness),
    });
    let mut image = |json: &mut Value, key: &str, image| {
        if let Some(index) = texture(image) {
            json[key] = json!({ "index": index });
        }
    };
    image(&mut pbr, "baseColorTexture", material.base_color_image);
    image(&mut pbr, "metallicRoughnessTexture", own.metallic_roughness_image());
    let mut json = Value::from(named(&material.name));
    json["pbrMetallicRoughness"] = pbr;
    image(&mut json, "normalTexture", own.normal_image);
    if json.get("normalTexture").is_some() && own.normal_scale != 1.0 {
        json["normalTexture"]["scale"] = json!(own.normal_scale);
    }
    emit(own, &mut json);
    image(&mut json, "emissiveTexture", own.emission_image);
    // Only the alpha of the base colour's texture counts.
    let has_alpha = own.opacity_image.is_some() && own.opacity_image == material.base_color_image;
    if material.base_color[3] < 1.0 || has_alpha {
        json["alphaMode"] = "BLEND".into();
    }
    if material.is_double_sided {
        json["doubleSided"] = true.into();
    }
    json
}

/// Adds the emitted light; brighter than 1, it needs an extension.
fn emit(own: &Shading, json: &mut Value) {
    let emission = own.emission.map(|x| if x.is_finite() { x.max(0.0) } else { 0.0 });
    let strength = emission.into_iter().fold(1.0, f32::max);
    if emission != [0.0; 3] {
        json["emissiveFactor"] = json!(emission.map(|x| unit(x / strength)));
    }
    if strength > 1.0 {
        json["extensions"] = json!({ EMISSIVE_STRENGTH: { "emissiveStrength": strength } });
    }
}

fn unit(x: f32) -> f32 {
    if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.0 }
}

/// Stores properties unknown to glTF in the extras of a material.
pub(crate) fn keep_all(material: &Material, json: &mut Value) {
    if material.shading != Shading::default() {
        json["extras"]["shading"] = json!(material.shading);
    }
    if !material.mtl.is_empty() {
        json["extras"]["mtl"] = json!(material.mtl);
    }
}

/// Restores the properties stored by [`keep_all`].
///
/// # Errors
/// Malformed extras, or image indices at or above `images`.
pub(crate) fn take_all(
    json: &Value,
    images: usize,
    materials: &mut [Material],
) -> Result<(), ParseError> {
    let entries = json.get("materials").and_then(Value::as_array).into_iter().flatten();
    for (index, (entry, material)) in entries.zip(materials).enumerate() {
        let wrong = |error: serde_json::Error| {
            ParseError::part(format!("material {index}"), error.to_string())
        };
        let extras = |key: &str| entry.get("extras").and_then(|extras| extras.get(key));
        material.shading = match extras("shading") {
            Some(shading) => Shading::deserialize(shading).map_err(wrong)?,
            None => Shading::default(),
        };
        if let Some(lines) = extras("mtl") {
            material.mtl = Vec::<MtlStatement>::deserialize(lines).map_err(wrong)?;
        }
        if let Some(image) = material.images().find(|&image| image >= images) {
            return Err(missing("image", image, images));
        }
    }
    Ok(())
}
