//! Tests of content that is carried through from a document, and of replaced geometry.

use meshlod_fixtures::{cube, seam_strip};
use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, WedgeId};
use serde_json::json;

use super::{json_of, read_parts, round_trip, square};
use crate::gltf::write_glb;
use crate::{Format, Image, Material, Note, Scene};

/// A square with morph target, bytes as colours, points beside it, an animation, and things that
/// nobody here knows.
pub(crate) fn rich() -> Scene {
    let (mut json, mut buffer) = square();
    let floats = |buffer: &mut Vec<u8>, values: &[f32]| {
        buffer.extend(values.iter().flat_map(|x| x.to_le_bytes()));
    };
    floats(&mut buffer, &[0.0, 0.0, 0.5].repeat(4));
    buffer.extend([255, 0, 128, 255].repeat(4));
    floats(&mut buffer, &[0.0, 1.0]);
    json["buffers"][0]["byteLength"] = buffer.len().into();
    for (offset, length) in [(60, 48), (108, 16), (124, 8)] {
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
        json["bufferViews"].as_array_mut().unwrap().push(view);
    }
    for accessor in [
        json!({ "bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3",
                "min": [0, 0, 0.5], "max": [0, 0, 0.5] }),
        json!({ "bufferView": 3, "componentType": 5121, "normalized": true, "count": 4,
                "type": "VEC4" }),
        json!({ "bufferView": 4, "componentType": 5126, "count": 2, "type": "SCALAR",
                "min": [0], "max": [1] }),
    ] {
        json["accessors"].as_array_mut().unwrap().push(accessor);
    }
    json["meshes"][0] = json!({
        "name": "rich",
        "weights": [0.0],
        "extras": { "kept": [1, 2.5, "three"] },
        "primitives": [
            { "mode": 0, "attributes": { "POSITION": 0 } },
            { "attributes": { "POSITION": 0, "COLOR_0": 3 }, "indices": 1, "material": 0,
              "targets": [{ "POSITION": 2 }], "extras": "mine" },
        ],
    });
    json["materials"] = json!([{ "name": "red", "extensions": { "VENDOR_thing": { "a": 1 } } }]);
    json["extensionsUsed"] = json!(["VENDOR_thing"]);
    json["animations"] = json!([{
        "samplers": [{ "input": 4, "output": 4 }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }],
    }]);
    json["unknown"] = json!({ "deep": [{ "down": null }] });
    read_parts(&json, &buffer).unwrap()
}

fn layer(mesh: &Mesh, kind: LayerKind) -> &Layer {
    mesh.attributes.as_ref().unwrap().layer(kind).unwrap()
}

#[test]
fn attributes_become_layers_and_primitives_labels() {
    let scene = rich();
    let mesh = &scene.meshes[0].mesh;
    assert_eq!(scene.meshes[0].materials, [None, Some(0)]);
    assert_eq!(mesh.materials.as_ref().unwrap().of_face, [1, 1]);
    assert_eq!(layer(mesh, LayerKind::Color(0)).of(WedgeId(0)), [1.0, 0.0, 128.0 / 255.0, 1.0]);
    let target = layer(mesh, LayerKind::Other);
    assert_eq!(
        (&target.name[..], target.of(WedgeId(0))),
        ("target 0 POSITION", &[0.0, 0.0, 0.5][..])
    );
}

#[test]
fn all_but_geometry_passes_through_a_change() {
    let mut scene = rich();
    let before = json_of(&write_glb(&scene, &[]).unwrap());
    scene.meshes[0].mesh.positions[0][2] = -1.0;
    let glb = write_glb(&scene, &[]).unwrap();
    let after = json_of(&glb);
    for key in ["materials", "nodes", "scenes", "unknown", "animations", "extensionsUsed", "asset"]
    {
        assert_eq!(after[key], before[key], "{key}");
    }
    let [old, new] = [&before, &after].map(|json| &json["meshes"][0]);
    for key in ["name", "weights", "extras"] {
        assert_eq!(new[key], old[key], "{key}");
    }
    assert_eq!(new["primitives"][0], old["primitives"][0], "points stay as they are");
    assert_eq!(new["primitives"][1]["extras"], "mine");
    assert_eq!(new["primitives"][1]["material"], 0);
    let colors = new["primitives"][1]["attributes"]["COLOR_0"].as_u64().unwrap() as usize;
    assert_eq!(after["accessors"][colors]["componentType"], 5121, "colours stay bytes");
    assert_eq!(after["accessors"][4], before["accessors"][4], "the animation's accessor");
    let target = new["primitives"][1]["targets"][0]["POSITION"].as_u64().unwrap() as usize;
    assert_eq!(after["accessors"][target]["max"], json!([0.0, 0.0, 0.5]));
    let again = round_trip(&scene);
    assert_eq!(again.meshes[0].mesh, scene.meshes[0].mesh);
}

#[test]
fn an_unchanged_mesh_keeps_its_accessors() {
    let scene = rich();
    let json = json_of(&write_glb(&scene, &[]).unwrap());
    assert_eq!(json["accessors"].as_array().unwrap().len(), 5);
    assert_eq!(
        json["meshes"][0]["primitives"][1]["attributes"],
        json!({"POSITION": 0, "COLOR_0": 3})
    );
    assert_eq!(round_trip(&scene).meshes[0].mesh, scene.meshes[0].mesh);
}

#[test]
fn a_mesh_without_faces_stays_a_valid_document() {
    for mut scene in [rich(), Scene::from_mesh("none", Mesh::default())] {
        scene.meshes[0].mesh = Mesh::default();
        let flat = round_trip(&scene).flatten();
        assert!(flat.bounds().diagonal() == 0.0, "{flat:?}");
    }
}

#[test]
fn labels_that_are_no_primitive_are_refused() {
    let mut scene = rich();
    for label in [0, 2] {
        let names = ["a", "b", "c"].map(String::from).into();
        scene.meshes[0].mesh.materials = Some(Labels { names, of_face: vec![label; 2] });
        let error = write_glb(&scene, &[]).unwrap_err().to_string();
        assert!(error.contains("\"rich\"") && error.contains(&format!("label {label}")), "{error}");
    }
}

#[test]
fn coordinates_beyond_32_bits_are_refused() {
    let mut mesh = cube();
    mesh.positions[3][1] = 1e300;
    let error = write_glb(&Scene::from_mesh("", mesh), &[]).unwrap_err().to_string();
    assert!(error.starts_with("v3"), "{error}");
}

#[test]
fn a_plain_scene_comes_back_with_seams_materials_and_images() {
    let mut scene = Scene::from_mesh("strip", seam_strip());
    let faces = scene.meshes[0].mesh.faces.len();
    let half = |face| u32::from(face >= faces / 2);
    let of_face: Vec<u32> = (0..faces).map(half).collect();
    let names = ["front", "back"].map(String::from);
    scene.meshes[0].mesh.materials = Some(Labels { names: names.clone().into(), of_face });
    scene.meshes[0].materials = vec![Some(1), Some(0)];
    let [back, front] = names.map(|name| Material {
        is_double_sided: name == "back",
        name,
        base_color: [0.5, 0.25, 1.0, 1.0],
        base_color_image: Some(0),
        ..Material::default()
    });
    scene.materials = vec![front, back];
    scene.images = vec![Image { name: "a.png".into(), bytes: b"\x89PNG1234".to_vec() }];
    scene.nodes[0].name = "there".into();
    scene.nodes[0].transform[3] = [1.0, 2.0, 3.0, 1.0];
    let again = round_trip(&scene);
    assert_eq!(again.materials, scene.materials);
    assert_eq!(again.images, scene.images);
    assert_eq!(again.nodes, scene.nodes);
    let (new, old) = (again.flatten(), scene.flatten());
    assert_eq!(new.materials.as_ref().unwrap().of_face, old.materials.as_ref().unwrap().of_face);
    assert_eq!(new.objects, old.objects);
    assert_eq!(new.positions.len(), old.positions.len(), "seams do not tear");
    let corner_values = |mesh: &Mesh| -> Vec<f32> {
        let attributes = mesh.attributes.as_ref().unwrap();
        let layer = layer(mesh, LayerKind::Uv(0));
        attributes.corners.iter().flatten().flat_map(|&w| layer.of(w).to_vec()).collect()
    };
    assert_eq!(corner_values(&new), corner_values(&old));
}

#[test]
fn layers_of_any_name_and_kind_come_back() {
    let mut mesh = cube();
    let vertices = mesh.positions.len();
    let of = |kind, name: &str, width: usize, scale: f32| Layer {
        kind,
        name: name.into(),
        width,
        values: (0..vertices * width).map(|i| i as f32 * scale).collect(),
    };
    mesh.attributes = Some(Attributes {
        corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
        wedge_count: vertices,
        layers: vec![
            of(LayerKind::Color(0), "bytes", 3, 1.0 / 255.0),
            of(LayerKind::Joints(0), "joints", 4, 20.0),
            of(LayerKind::Other, "confidence", 1, 0.1),
            of(LayerKind::Other, "Confidence", 1, 0.2),
            of(LayerKind::Other, "_MAT", 9, 0.3),
        ],
    });
    let again = round_trip(&Scene::from_mesh("", mesh.clone()));
    let layers = |mesh: &Mesh| -> Vec<(LayerKind, Vec<f32>)> {
        let mut layers: Vec<_> = mesh
            .attributes
            .iter()
            .flat_map(|attributes| &attributes.layers)
            .map(|layer| (layer.kind, layer.values.clone()))
            .collect();
        layers.sort_by(|a, b| format!("{a:?}").cmp(&format!("{b:?}")));
        layers
    };
    assert_eq!(layers(&again.meshes[0].mesh), layers(&mesh));
}

#[test]
fn what_only_gltf_holds_is_noted_for_other_formats() {
    let scene = rich();
    assert!(scene.limits_of(Format::Glb).is_empty());
    for format in [Format::Obj, Format::Ply, Format::Stl, Format::Off, Format::Smf] {
        let notes: Vec<String> = scene.limits_of(format).iter().map(Note::to_string).collect();
        for lost in [
            "1 primitive of points or lines (rich)",
            "1 extension of glTF (VENDOR_thing)",
            "1 entry with extras (meshes 0)",
        ] {
            assert!(notes.iter().any(|note| note == lost), "{format:?}: {notes:?}");
        }
    }
}

#[test]
fn textures_that_only_an_unknown_extension_has_are_noted() {
    let (mut json, buffer) = square();
    json["materials"] = json!([{ "name": "wood",
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
    json["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
    json["images"] = json!([{ "uri": "wood.ktx2" }]);
    json["meshes"][0]["primitives"][0]["material"] = 0.into();
    let lost = |json: &serde_json::Value| {
        let notes = read_parts(json, &buffer).unwrap().limits_of(Format::Obj);
        notes.iter().any(|note| note.to_string() == "1 material's properties that MTL lacks (wood)")
    };
    assert!(lost(&json));
    json["textures"][0]["source"] = 0.into();
    assert!(!lost(&json));
}

#[test]
fn normals_that_a_primitive_never_had_are_no_change() {
    let (mut json, mut buffer) = square();
    let start = buffer.len();
    buffer.extend([0.0f32, 0.0, 1.0].repeat(4).iter().flat_map(|x| x.to_le_bytes()));
    json["buffers"][0]["byteLength"] = buffer.len().into();
    let view = json["bufferViews"].as_array().unwrap().len();
    let new_view = json!({ "buffer": 0, "byteOffset": start, "byteLength": 48 });
    json["bufferViews"].as_array_mut().unwrap().push(new_view);
    let normals = json["accessors"].as_array().unwrap().len();
    let accessor = json!({ "bufferView": view, "componentType": 5126, "count": 4, "type": "VEC3" });
    json["accessors"].as_array_mut().unwrap().push(accessor);
    let bare = json["meshes"][0]["primitives"][0].clone();
    let mut with = bare.clone();
    with["attributes"]["NORMAL"] = normals.into();
    json["meshes"][0]["primitives"] = json!([with, bare]);
    let notes = |buffer: &[u8]| -> Vec<String> {
        let mut scene = read_parts(&json, buffer).unwrap();
        crate::scene::normals::make_unit(&mut scene);
        scene.notes.iter().map(Note::to_string).collect()
    };
    assert_eq!(notes(&buffer), [""; 0]);
    buffer[start..start + 12].fill(0);
    let one = "1 normal without a length computed from the faces around it";
    assert_eq!(notes(&buffer), [one]);
}

#[test]
fn names_of_embedded_images_are_names_of_files() {
    let (mut json, buffer) = square();
    let png = "data:image/png;base64,iVBORw0KGgo=";
    json["images"] = json!([{ "uri": png, "name": "../a\\b:c?" }, { "uri": png, "name": "" }]);
    let scene = read_parts(&json, &buffer).unwrap();
    let names: Vec<&str> = scene.images.iter().map(|image| &*image.name).collect();
    assert_eq!(names, [".._a_b_c_.png", "image1.png"]);
}
