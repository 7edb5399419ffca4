//! Reading the materials and images of a glTF document.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::error::ParseError;
use crate::gltf::document::extensions::{EMISSIVE_STRENGTH, WEBP};
use crate::gltf::document::schema::{Texture, TextureUse};
use crate::gltf::document::source::SourceDocument;
use crate::gltf::document::uri::Uri;
use crate::gltf::document::{missing, schema, uri};
use crate::scene::material::{Material, Shading};

impl SourceDocument {
    /// Lists the materials with properties that [`Material`](crate::Material) lacks, by name or as
    /// `material 3`.
    pub(crate) fn richer_materials(&self) -> Vec<String> {
        richer_materials(&self.0.json)
    }

    /// Lists the images that only texture extensions refer to, which scenes lack.
    pub(crate) fn extension_images(&self) -> Vec<String> {
        extension_images(&self.0.json)
    }

    /// Returns the set of texture coordinates that the base colour of each material uses.
    pub(crate) fn texture_sets(&self) -> Vec<u8> {
        texture_sets(&self.0.json)
    }
}

/// Reads the materials; every image they refer to must be below `images`.
pub(crate) fn materials(json: &Value, images: usize) -> Result<Vec<Material>, ParseError> {
    let textures: Vec<Texture> = schema::array(json, "textures", "texture")?;
    let materials: Vec<schema::GltfMaterial> = schema::array(json, "materials", "material")?;
    let image_of = |texture: &Option<TextureUse>| {
        let Some(texture) = texture else { return Ok(None) };
        let Some(found) = textures.get(texture.index) else {
            return Err(missing("texture", texture.index, textures.len()));
        };
        let source = found.webp_source().or(found.source);
        match source.filter(|&image| image >= images) {
            Some(image) => Err(missing("image", image, images)),
            None => Ok(source),
        }
    };
    let read = |material: schema::GltfMaterial| {
        let pbr = &material.pbr_metallic_roughness;
        let base_color_image = image_of(&pbr.base_color_texture)?;
        Ok(Material {
            base_color: pbr.base_color_factor.unwrap_or([1.0; 4]),
            base_color_image,
            is_double_sided: material.double_sided,
            shading: shading(&material, base_color_image, image_of)?,
            name: material.name.unwrap_or_default(),
            mtl: Vec::new(),
        })
    };
    materials.into_iter().map(read).collect()
}

fn shading(
    material: &schema::GltfMaterial,
    base_color_image: Option<usize>,
    image_of: impl Fn(&Option<TextureUse>) -> Result<Option<usize>, ParseError>,
) -> Result<Shading, ParseError> {
    let pbr = &material.pbr_metallic_roughness;
    let combined = image_of(&pbr.metallic_roughness_texture)?;
    let strength = material.extensions.get(EMISSIVE_STRENGTH);
    let strength = strength.and_then(|own| own.get("emissiveStrength")?.as_f64()).unwrap_or(1.0);
    let is_opaque = material.alpha_mode.as_deref().is_none_or(|mode| mode == "OPAQUE");
    let scale = material.normal_texture.as_ref().and_then(|texture| texture.scale);
    // A number may be too large for 32 bits.
    let finite = |x: f32| if x.is_finite() { x } else { 1.0 };
    Ok(Shading {
        metallic: finite(pbr.metallic_factor.unwrap_or(1.0)),
        metallic_image: combined,
        roughness: finite(pbr.roughness_factor.unwrap_or(1.0)),
        roughness_image: combined,
        normal_image: image_of(&material.normal_texture)?,
        normal_scale: finite(scale.unwrap_or(1.0)),
        emission: material.emissive_factor.unwrap_or_default().map(|x| finite(x * strength as f32)),
        emission_image: image_of(&material.emissive_texture)?,
        opacity_image: base_color_image.filter(|_| !is_opaque),
    })
}

/// Lists the materials with properties that [`materials`] ignores, by name or as `material 3`.
pub(crate) fn richer_materials(json: &Value) -> Vec<String> {
    let materials = json.get("materials").and_then(Value::as_array);
    let is_richer = |own: &Value| is_richer(own) || has_other_image(json, own);
    let richer = materials.into_iter().flatten().enumerate().filter(|(_, own)| is_richer(own));
    let name = |(i, material): (usize, &Value)| match material["name"].as_str() {
        Some(name) if !name.is_empty() => name.to_owned(),
        _ => format!("material {i}"),
    };
    richer.map(name).collect()
}

fn is_richer(material: &Value) -> bool {
    const OF_MATERIAL: [&str; 10] = [
        "name",
        "extras",
        "doubleSided",
        "alphaMode",
        "alphaCutoff",
        "pbrMetallicRoughness",
        "normalTexture",
        "emissiveFactor",
        "emissiveTexture",
        "extensions",
    ];
    const OF_SURFACE: [&str; 5] = [
        "baseColorFactor",
        "baseColorTexture",
        "metallicFactor",
        "roughnessFactor",
        "metallicRoughnessTexture",
    ];
    let has_more = |json: Option<&Value>, known: &[&str]| {
        let json = json.and_then(Value::as_object);
        json.is_some_and(|json| json.keys().any(|key| !known.contains(&&**key)))
    };
    let pbr = material.get("pbrMetallicRoughness");
    let textures = [
        material.get("normalTexture"),
        material.get("emissiveTexture"),
        pbr.and_then(|pbr| pbr.get("baseColorTexture")),
        pbr.and_then(|pbr| pbr.get("metallicRoughnessTexture")),
    ];
    // Transforms, and other texture coordinates than those of the base colour.
    let own = texture_set(material);
    let is_moved = |texture: &Value| texture.get("extensions").is_some() || set_of(texture) != own;
    has_more(Some(material), &OF_MATERIAL)
        || has_more(pbr, &OF_SURFACE)
        || has_more(material.get("extensions"), &[EMISSIVE_STRENGTH])
        || textures.into_iter().flatten().any(is_moved)
}

/// Returns the set of texture coordinates that the base colour of each material uses; 0 if it has
/// no texture.
pub(crate) fn texture_sets(json: &Value) -> Vec<u8> {
    let materials = json.get("materials").and_then(Value::as_array).into_iter().flatten();
    materials.map(|material| u8::try_from(texture_set(material)).unwrap_or(0)).collect()
}

fn texture_set(material: &Value) -> u64 {
    set_of(&material["pbrMetallicRoughness"]["baseColorTexture"])
}

fn set_of(texture: &Value) -> u64 {
    texture["texCoord"].as_u64().unwrap_or(0)
}

/// Lists the images that only extensions unknown to [`materials`] refer to, by name or as `image
/// 3`.
pub(crate) fn extension_images(json: &Value) -> Vec<String> {
    let textures = json.get("textures").and_then(Value::as_array).into_iter().flatten();
    let sources = textures.filter(|texture| is_extended(texture)).flat_map(|texture| {
        let extensions = texture["extensions"].as_object().into_iter().flatten();
        extensions.filter_map(|(_, extension)| extension["source"].as_u64())
    });
    let sources: BTreeSet<u64> = sources.collect();
    let name = |index: u64| {
        let image = &json["images"][index as usize];
        // A data URI is no name.
        let uri = image["uri"].as_str().filter(|uri| matches!(uri::parse(uri), Ok(Uri::File(_))));
        uri.or(image["name"].as_str()).map_or_else(|| format!("image {index}"), str::to_owned)
    };
    sources.into_iter().map(name).collect()
}

fn is_extended(texture: &Value) -> bool {
    let extensions = texture["extensions"].as_object();
    texture.get("source").is_none()
        && extensions.is_some_and(|all| !all.is_empty() && !all.contains_key(WEBP))
}

/// Reports whether a texture of a material has its image only in an extension unknown to
/// [`materials`].
fn has_other_image(json: &Value, material: &Value) -> bool {
    let pbr = &material["pbrMetallicRoughness"];
    let textures = [
        &material["normalTexture"],
        &material["emissiveTexture"],
        &pbr["baseColorTexture"],
        &pbr["metallicRoughnessTexture"],
    ];
    let indices = textures.iter().filter_map(|texture| texture["index"].as_u64());
    indices.into_iter().any(|index| is_extended(&json["textures"][index as usize]))
}

impl Texture {
    /// Returns the image given by `EXT_texture_webp`; the texture's own source, if any, is a
    /// fallback for programs without WebP.
    fn webp_source(&self) -> Option<usize> {
        let extension = self.extensions.get(WEBP)?;
        extension.get("source")?.as_u64().map(|source| source as usize)
    }
}
