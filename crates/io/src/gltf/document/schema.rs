//! Typed view of the parts of a glTF document that define its geometry.
//!
//! The document itself is kept as JSON, so that everything else is carried through.

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::error::ParseError;

/// `accessors[i]`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default)]
    pub byte_offset: usize,
    pub component_type: u32,
    #[serde(default)]
    pub normalized: bool,
    pub count: usize,
    #[serde(rename = "type")]
    pub shape: String,
    pub sparse: Option<Sparse>,
}

/// `accessors[i].sparse`.
#[derive(Debug, Deserialize)]
pub(crate) struct Sparse {
    pub count: usize,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

/// `accessors[i].sparse.indices`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SparseIndices {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: usize,
    pub component_type: u32,
}

/// `accessors[i].sparse.values`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SparseValues {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: usize,
}

/// `bufferViews[i]`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct BufferView {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: Option<usize>,
    #[serde(default)]
    pub extensions: Map<String, Value>,
}

/// `meshes[i]`.
#[derive(Debug, Deserialize)]
pub(crate) struct GltfMesh {
    pub name: Option<String>,
    pub primitives: Vec<Primitive>,
}

/// `meshes[i].primitives[j]`.
#[derive(Debug, Deserialize)]
pub(crate) struct Primitive {
    #[serde(default)]
    pub attributes: Map<String, Value>,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    #[serde(default = "Primitive::triangles")]
    pub mode: u32,
    #[serde(default)]
    pub targets: Vec<Map<String, Value>>,
}

impl Primitive {
    fn triangles() -> u32 {
        4
    }

    /// Reports whether the primitive consists of triangles, a strip or a fan, not of points or
    /// lines.
    pub fn has_faces(&self) -> bool {
        matches!(self.mode, 4..=6)
    }

    /// Lists the attributes with the indices of their accessors, then those of the morph targets
    /// under their [`target_name`].
    ///
    /// # Errors
    /// If the value of an attribute is not an accessor index.
    pub fn accessors(&self) -> Result<Vec<(String, usize)>, String> {
        let own = self.attributes.iter().map(|(name, value)| (name.clone(), value));
        let targets = self.targets.iter().enumerate().flat_map(|(k, target)| {
            target.iter().map(move |(name, value)| (target_name(k, name), value))
        });
        own.chain(targets)
            .map(|(name, value)| match value.as_u64() {
                Some(index) => Ok((name, index as usize)),
                None => Err(format!("attribute {name} must be the index of an accessor")),
            })
            .collect()
    }
}

/// Returns the layer name of an attribute of a morph target.
pub(crate) fn target_name(target: usize, attribute: &str) -> String {
    format!("target {target} {attribute}")
}

/// Splits the layer name of an attribute of a morph target, such as `target 0 POSITION`, into the
/// number of the target and the attribute; `None` for the names of other layers.
pub fn parse_target_name(name: &str) -> Option<(usize, &str)> {
    let (target, attribute) = name.strip_prefix("target ")?.split_once(' ')?;
    Some((target.parse().ok()?, attribute))
}

/// `nodes[i]`.
#[derive(Debug, Deserialize)]
pub(crate) struct GltfNode {
    pub name: Option<String>,
    #[serde(default)]
    pub children: Vec<usize>,
    pub mesh: Option<usize>,
    pub matrix: Option<[f64; 16]>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
}

/// `scenes[i]`.
#[derive(Debug, Deserialize)]
pub(crate) struct GltfScene {
    #[serde(default)]
    pub nodes: Vec<usize>,
}

/// `materials[i]`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct GltfMaterial {
    pub name: Option<String>,
    #[serde(default)]
    pub pbr_metallic_roughness: MetallicRoughness,
    #[serde(default)]
    pub double_sided: bool,
    pub normal_texture: Option<TextureUse>,
    pub emissive_texture: Option<TextureUse>,
    pub emissive_factor: Option<[f32; 3]>,
    pub alpha_mode: Option<String>,
    #[serde(default)]
    pub extensions: Map<String, Value>,
}

/// `materials[i].pbrMetallicRoughness`.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct MetallicRoughness {
    pub base_color_factor: Option<[f32; 4]>,
    pub base_color_texture: Option<TextureUse>,
    pub metallic_factor: Option<f32>,
    pub roughness_factor: Option<f32>,
    pub metallic_roughness_texture: Option<TextureUse>,
}

/// Reference of a material to a texture.
#[derive(Debug, Deserialize)]
pub(crate) struct TextureUse {
    pub index: usize,
    /// Factor of the x and y coordinates of normals.
    pub scale: Option<f32>,
}

/// `textures[i]`.
#[derive(Debug, Deserialize)]
pub(crate) struct Texture {
    pub source: Option<usize>,
    #[serde(default)]
    pub extensions: Map<String, Value>,
}

/// `images[i]`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct GltfImage {
    pub name: Option<String>,
    pub uri: Option<String>,
    pub buffer_view: Option<usize>,
}

/// `buffers[i]`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Buffer {
    pub uri: Option<String>,
    pub byte_length: usize,
}

/// Deserializes the array `json[key]`; empty if absent. Errors name the entry, as in `accessor 7`.
pub(crate) fn array<T: DeserializeOwned>(
    json: &Value,
    key: &str,
    entry: &str,
) -> Result<Vec<T>, ParseError> {
    let Some(value) = json.get(key) else { return Ok(Vec::new()) };
    let Some(values) = value.as_array() else {
        return Err(ParseError::part(key, "must be an array"));
    };
    let typed = |(i, value): (usize, &Value)| {
        // Deserializing would accept an array for a struct, field by field; later code needs
        // objects.
        if value.is_array() {
            return Err(ParseError::part(format!("{entry} {i}"), "must not be an array"));
        }
        T::deserialize(value).map_err(|error: serde_json::Error| {
            ParseError::part(format!("{entry} {i}"), error.to_string())
        })
    };
    values.iter().enumerate().map(typed).collect()
}
