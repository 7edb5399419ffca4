//! New glTF documents, for scenes from other formats.

pub(crate) mod copies;
pub(crate) mod limits;
pub(crate) mod local_space;
pub(crate) mod material;
pub(crate) mod missing_uvs;
pub(crate) mod objects;

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use crate::gltf::document::extensions::{EMISSIVE_STRENGTH, WEBP, list_extension};
use crate::gltf::write::buffer::BufferBuilder;
use crate::remarks;
use crate::scene::image_file::{holds_image, mime_type};
use crate::scene::{IDENTITY, Image, Node, Scene, SceneMesh};
use copies::with_copies_as_nodes;
use missing_uvs::{UnmappedMaterials, is_mapped};

/// Builds the JSON of a scene with these images, without geometry; each mesh has an empty primitive
/// per material label. Materials have no textures on meshes without texture coordinates.
pub(crate) fn document(scene: &Scene, all: &[Image], builder: &mut BufferBuilder) -> Value {
    let mut images = Images::default();
    let unmapped = UnmappedMaterials::of(scene);
    let mut json = |(index, own)| match unmapped.is_nowhere_mapped(index) {
        true => material::material(own, &mut |_| None),
        false => material::material(own, &mut |image| images.texture(image, all, builder)),
    };
    let mut materials: Vec<Value> = scene.materials.iter().enumerate().map(&mut json).collect();
    let mut plain = BTreeMap::new();
    for index in unmapped.elsewhere_mapped() {
        plain.insert(index, materials.len());
        materials.push(material::material(&scene.materials[index], &mut |_| None));
    }
    let mut json = with_nodes(scene, materials, images.json);
    for (index, mesh) in scene.meshes.iter().enumerate().filter(|(_, m)| !is_mapped(&m.mesh)) {
        for (label, material) in mesh.materials.iter().enumerate() {
            if let Some(plain) = material.and_then(|material| plain.get(&material)) {
                json["meshes"][index]["primitives"][label]["material"] = (*plain).into();
            }
        }
    }
    remarks::put(&scene.ply.remarks, &mut json);
    json
}

/// Builds the JSON of a scene for [`Skeleton`](crate::gltf::Skeleton): with the names of all images
/// and all properties of materials.
pub(crate) fn skeleton(scene: &Scene) -> Value {
    let materials = scene.materials.iter().map(|own| {
        let mut json = material::material(own, &mut |image| image);
        let color = own.base_color.map(|x| if x.is_finite() { x } else { 1.0 });
        json["pbrMetallicRoughness"]["baseColorFactor"] = json!(color);
        material::keep_all(own, &mut json);
        json
    });
    let images = scene.images.iter().map(|image| json!({ "name": image.name }));
    let (materials, images) = (materials.collect(), images.collect());
    with_nodes(&with_copies_as_nodes(scene), materials, images)
}

/// Returns the images of a document built by [`skeleton`], without their bytes.
pub(crate) fn image_names(json: &Value) -> Vec<Image> {
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
    if materials.iter().any(|material| material.get("extensions").is_some()) {
        list_extension(&mut json, "extensionsUsed", EMISSIVE_STRENGTH);
    }
    if images.iter().any(is_webp) {
        // Textures have no other image to fall back to.
        list_extension(&mut json, "extensionsUsed", WEBP);
        list_extension(&mut json, "extensionsRequired", WEBP);
    }
    let textures = images.iter().enumerate().map(|(source, image)| match is_webp(image) {
        true => json!({ "extensions": { WEBP: { "source": source } } }),
        false => json!({ "source": source }),
    });
    for (key, values) in [
        ("nodes", scene.nodes.iter().map(node).collect()),
        ("meshes", scene.meshes.iter().map(mesh).collect()),
        ("materials", materials),
        ("textures", textures.collect()),
        ("images", images),
    ] {
        // glTF does not allow empty arrays.
        if !Vec::<Value>::is_empty(&values) {
            json[key] = values.into();
        }
    }
    json
}

fn is_webp(image: &Value) -> bool {
    image.get("mimeType").is_some_and(|kind| kind == "image/webp")
}

/// Images in use; image `i` is texture `i`.
#[derive(Default)]
struct Images {
    json: Vec<Value>,
    /// Image of the scene → texture.
    of_scene: BTreeMap<usize, usize>,
}

impl Images {
    /// Returns the texture of an image; `None` if the document cannot hold it.
    fn texture(
        &mut self,
        index: Option<usize>,
        all: &[Image],
        builder: &mut BufferBuilder,
    ) -> Option<usize> {
        let index = index?;
        if let Some(&texture) = self.of_scene.get(&index) {
            return Some(texture);
        }
        let image = all.get(index)?;
        let kind = mime_type(&image.bytes).filter(|_| holds_image(&image.bytes))?;
        let view = builder.add_view(&image.bytes);
        self.json.push(json!({ "name": image.name, "bufferView": view, "mimeType": kind }));
        self.of_scene.insert(index, self.json.len() - 1);
        Some(self.json.len() - 1)
    }
}

fn node(node: &Node) -> Value {
    let mut json = named(&node.name);
    let [x, y, z, [tx, ty, tz, _]] = node.transform;
    if [x, y, z] == IDENTITY[..3] && node.transform[3][3] == 1.0 && [tx, ty, tz] != [0.0; 3] {
        json.insert("translation".into(), json!([tx, ty, tz]));
    } else if node.transform != IDENTITY {
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

pub(crate) fn named(name: &str) -> Map<String, Value> {
    let mut json = Map::new();
    if !name.is_empty() {
        json.insert("name".into(), name.into());
    }
    json
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::cube;

    use super::*;
    use crate::gltf::{read, write_glb};
    use crate::{Format, Material, Note, Weld};

    #[test]
    fn webp_textures_need_the_extension_and_come_back() {
        let mut scene = Scene::from_mesh("", cube());
        let image = |name: &str, bytes: &[u8]| Image { name: name.into(), bytes: bytes.to_vec() };
        scene.images = vec![
            image("a.webp", b"RIFF\x04\0\0\0WEBPVP8L"),
            image("b.png", b"\x89PNG\r\n\x1a\n"),
            image("c.tif", b"II*\0"),
        ];
        scene.materials = (0..3)
            .map(|image| Material { base_color_image: Some(image), ..Material::default() })
            .collect();
        let notes: Vec<String> = scene.limits_of(Format::Glb).iter().map(Note::to_string).collect();
        assert_eq!(notes, ["1 image that is no PNG, JPEG or WebP (c.tif)"]);
        let json = document(&scene, &scene.images, &mut BufferBuilder::default());
        assert_eq!(json["extensionsRequired"], json!([WEBP]));
        assert_eq!(json["textures"][0], json!({ "extensions": { WEBP: { "source": 0 } } }));
        assert_eq!(json["textures"][1], json!({ "source": 1 }));
        let glb = write_glb(&scene, &[]).unwrap();
        let back = read(&glb, &mut |_| None, Weld::Exact).unwrap();
        let images: Vec<_> = back.materials.iter().map(|own| own.base_color_image).collect();
        assert_eq!(images, [Some(0), Some(1), None]);
        assert_eq!(back.images[0].bytes, scene.images[0].bytes);
        scene.images.remove(0);
        let json = document(&scene, &scene.images, &mut BufferBuilder::default());
        assert_eq!(json.get("extensionsUsed"), None);
    }
}
