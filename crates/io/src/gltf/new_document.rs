//! New glTF documents, for scenes that were read from another format.

use serde_json::{Map, Value, json};

use super::buffer_builder::BufferBuilder;
use crate::scene::IDENTITY;
use crate::{Image, Material, Node, Scene, SceneMesh};

/// Builds the JSON of a scene without geometry; each mesh has an empty primitive per material
/// label.
pub(super) fn document(scene: &Scene, builder: &mut BufferBuilder) -> Value {
    let mut images = Images::default();
    let materials: Vec<Value> =
        scene.materials.iter().map(|m| material(m, images.texture(m, scene, builder))).collect();
    with_nodes(scene, materials, images.json)
}

/// Builds the JSON of a scene as one that only [`Skeleton`](super::Skeleton) reads: with all images,
/// by name, and base colours of any size.
pub(super) fn skeleton(scene: &Scene) -> Value {
    let materials = scene.materials.iter().map(|own| {
        let mut json = material(own, own.base_color_image);
        let color = own.base_color.map(|x| if x.is_finite() { x } else { 1.0 });
        json["pbrMetallicRoughness"]["baseColorFactor"] = json!(color);
        json
    });
    let images = scene.images.iter().map(|image| json!({ "name": image.name }));
    with_nodes(scene, materials.collect(), images.collect())
}

/// Returns the images of a document built by [`skeleton`], without their bytes.
pub(super) fn image_names(json: &Value) -> Vec<Image> {
    let images = json.get("images").and_then(Value::as_array).into_iter().flatten();
    let name = |image: &Value| image.get("name").and_then(Value::as_str).unwrap_or_default().into();
    images.map(|image| Image { name: name(image), bytes: Vec::new() }).collect()
}

/// Builds the JSON of a scene with these materials and images; image `i` is texture `i`.
fn with_nodes(scene: &Scene, materials: Vec<Value>, images: Vec<Value>) -> Value {
    let mut json = json!({
        "asset": {
            "version": "2.0",
            "generator": concat!("meshlod ", env!("CARGO_PKG_VERSION")),
        },
        "scene": 0,
        "scenes": [if scene.roots.is_empty() { json!({}) } else { json!({ "nodes": scene.roots }) }],
    });
    for (key, values) in [
        ("nodes", nodes(&scene.nodes)),
        ("meshes", scene.meshes.iter().map(mesh).collect()),
        ("materials", materials),
        ("textures", (0..images.len()).map(|i| json!({ "source": i })).collect()),
        ("images", images),
    ] {
        // glTF does not allow empty arrays.
        if !Vec::<Value>::is_empty(&values) {
            json[key] = values.into();
        }
    }
    json
}

/// Detects the MIME type of an encoded image by its first bytes, if glTF knows the type.
pub(super) fn mime_type(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xff, 0xd8, 0xff, ..] => Some("image/jpeg"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        [0xab, b'K', b'T', b'X', ..] => Some("image/ktx2"),
        _ => None,
    }
}

/// Reports whether an encoded image is a PNG or JPEG, the only types that core glTF allows.
pub(crate) fn has_core_type(bytes: &[u8]) -> bool {
    matches!(mime_type(bytes), Some("image/png" | "image/jpeg"))
}

/// Images in use; image `i` is texture `i`.
#[derive(Default)]
struct Images {
    json: Vec<Value>,
    /// Image of the scene → texture.
    of_scene: std::collections::BTreeMap<usize, usize>,
}

impl Images {
    /// Returns the texture of a material; `None` if its image is neither PNG nor JPEG.
    fn texture(
        &mut self,
        material: &Material,
        scene: &Scene,
        builder: &mut BufferBuilder,
    ) -> Option<usize> {
        let index = material.base_color_image?;
        if let Some(&texture) = self.of_scene.get(&index) {
            return Some(texture);
        }
        let image = scene.images.get(index)?;
        let kind = mime_type(&image.bytes).filter(|_| has_core_type(&image.bytes))?;
        let view = builder.add_view(&image.bytes);
        self.json.push(json!({ "name": image.name, "bufferView": view, "mimeType": kind }));
        self.of_scene.insert(index, self.json.len() - 1);
        Some(self.json.len() - 1)
    }
}

fn material(material: &Material, texture: Option<usize>) -> Value {
    let mut surface = json!({
        "baseColorFactor": material.base_color.map(|x| if x.is_finite() { x.clamp(0.0, 1.0) } else { 1.0 }),
        "metallicFactor": 0,
        "roughnessFactor": 1,
    });
    if let Some(texture) = texture {
        surface["baseColorTexture"] = json!({ "index": texture });
    }
    let mut json = named(&material.name);
    json.insert("pbrMetallicRoughness".into(), surface);
    if material.base_color[3] < 1.0 {
        json.insert("alphaMode".into(), "BLEND".into());
    }
    if material.is_double_sided {
        json.insert("doubleSided".into(), true.into());
    }
    json.into()
}

/// Builds the nodes; copies of a mesh become children of their node, behind all others.
fn nodes(nodes: &[Node]) -> Vec<Value> {
    let mut all: Vec<Value> = nodes.iter().map(node).collect();
    for (i, parent) in nodes.iter().enumerate().filter(|(_, node)| !node.instances.is_empty()) {
        let copies = parent.instances.iter().map(|&transform| {
            node(&Node { name: String::new(), transform, mesh: parent.mesh, ..Node::default() })
        });
        let mut children = parent.children.clone();
        children.extend(all.len()..all.len() + parent.instances.len());
        all.extend(copies);
        all[i]["children"] = json!(children);
        all[i].as_object_mut().map(|node| node.shift_remove("mesh"));
    }
    all
}

fn node(node: &Node) -> Value {
    let mut json = named(&node.name);
    if node.transform != IDENTITY {
        json.insert("matrix".into(), json!(node.transform.as_flattened()));
    }
    if let Some(mesh) = node.mesh {
        json.insert("mesh".into(), mesh.into());
    }
    if !node.children.is_empty() {
        json.insert("children".into(), json!(node.children));
    }
    json.into()
}

fn mesh(mesh: &SceneMesh) -> Value {
    let count = mesh.mesh.materials.as_ref().map_or(1, |labels| labels.names.len().max(1));
    let primitive = |label: usize| match mesh.materials.get(label).copied().flatten() {
        Some(material) => json!({ "material": material }),
        None => json!({}),
    };
    let mut json = named(&mesh.name);
    json.insert("primitives".into(), (0..count).map(primitive).collect());
    json.into()
}

fn named(name: &str) -> Map<String, Value> {
    let mut json = Map::new();
    if !name.is_empty() {
        json.insert("name".into(), name.into());
    }
    json
}
