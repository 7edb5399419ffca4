//! Skeletons: documents without geometry and images, and what is made of them.

use meshlod_fixtures::shared_mesh;
use meshlod_mesh::Mesh;
use serde_json::{Value, json};

use super::carried::rich;
use super::{assert_valid, json_of, read_alone, read_parts, square};
use crate::gltf::document::{Document, container};
use crate::gltf::{Skeleton, SkeletonImage, write_glb};
use crate::{Material, Node, ReadOptions, Scene, SceneMesh};

const MODELS: [&str; 6] = [
    "fox.glb",
    "cesium-man.glb",
    "cesium-milk-truck.glb",
    "duck.glb",
    "dragon-attenuation.glb",
    "flight-helmet/FlightHelmet.gltf",
];

/// Images of a scene, as they are.
fn images(scene: &Scene) -> Vec<SkeletonImage> {
    let image = |bytes: &Vec<u8>| SkeletonImage { bytes: bytes.clone(), is_preview: false };
    scene.images.iter().map(|image_of| image(&image_of.bytes)).collect()
}

/// Takes a scene apart and puts it together again.
fn again(scene: &Scene) -> Scene {
    let emptied = vec![true; scene.meshes.len()];
    let skeleton = Skeleton::of(scene, emptied).unwrap();
    let mut new = skeleton.into_scene(images(scene), true).unwrap();
    for (new, old) in new.meshes.iter_mut().zip(&scene.meshes) {
        assert!(new.mesh.positions.is_empty());
        new.mesh = old.mesh.clone();
    }
    new
}

/// Reads the values of all key frames and inverse bind matrices of a document.
fn moving_values(scene: &Scene) -> Vec<Vec<f32>> {
    let source = &scene.source.as_ref().unwrap().0;
    let document = Document::new(&source.json, &source.buffers).unwrap();
    let mut accessors = Vec::new();
    let list = |value: &Value, key: &str| value[key].as_array().cloned().unwrap_or_default();
    for animation in list(&source.json, "animations") {
        for sampler in list(&animation, "samplers") {
            accessors.extend(["input", "output"].map(|key| sampler[key].as_u64().unwrap()));
        }
    }
    let skins = list(&source.json, "skins");
    accessors.extend(skins.iter().filter_map(|skin| skin["inverseBindMatrices"].as_u64()));
    accessors.iter().map(|&at| document.floats(at as usize).unwrap().values).collect()
}

fn rest_of(glb: &[u8]) -> Value {
    let mut json = json_of(glb);
    for key in ["accessors", "bufferViews", "buffers", "meshes", "animations", "skins", "images"] {
        json.as_object_mut().unwrap().remove(key);
    }
    json
}

#[test]
fn real_scenes_come_back() {
    for name in MODELS {
        let Some(path) = shared_mesh(name) else { continue };
        let scene = crate::read(&path, &ReadOptions::default()).unwrap();
        let [old, new] = [&scene, &again(&scene)].map(|scene| write_glb(scene, &[]).unwrap());
        assert_valid(&new);
        assert_eq!(rest_of(&old), rest_of(&new), "{name}");
        // Geometry is written in the order of the arrays, which is that of the file.
        assert!(new.len() <= old.len() + old.len() / 20, "{name}: {} {}", new.len(), old.len());
        let [old, new] = [old, new].map(|glb| read_alone(&glb).unwrap());
        assert_eq!(old.materials, new.materials, "{name}");
        assert!(old.images == new.images && old.nodes == new.nodes, "{name}");
        assert!(moving_values(&old) == moving_values(&new), "{name}");
        for (old, new) in old.meshes.iter().zip(&new.meshes) {
            assert_eq!((&old.name, &old.materials), (&new.name, &new.materials));
            assert!(old.mesh.faces.len() == new.mesh.faces.len(), "{name}");
        }
    }
}

#[test]
fn what_nobody_here_knows_comes_back() {
    let scene = rich();
    let [old, new] = [&scene, &again(&scene)].map(|scene| write_glb(scene, &[]).unwrap());
    assert_valid(&new);
    assert_eq!(rest_of(&old), rest_of(&new));
    let [old, new] = [old, new].map(|glb| read_alone(&glb).unwrap());
    assert_eq!(old.meshes[0].mesh, new.meshes[0].mesh);
    assert_eq!(moving_values(&old), moving_values(&new));
    let [old, new] = [&old, &new].map(|scene| &scene.source.as_ref().unwrap().0.json);
    assert_eq!(old["meshes"][0]["extras"], new["meshes"][0]["extras"]);
    assert_eq!(new["meshes"][0]["primitives"][0]["mode"], 0, "points stay");
    assert!(new["meshes"][0]["primitives"][1]["targets"][0]["POSITION"].is_u64());
}

#[test]
fn views_of_sparse_targets_do_not_come_back_empty() {
    let (mut json, mut buffer) = square();
    let start = buffer.len();
    buffer.extend([1, 0, 0, 0]);
    buffer.extend([0.0f32, 0.0, 1.0].iter().flat_map(|x| x.to_le_bytes()));
    json["buffers"][0]["byteLength"] = buffer.len().into();
    let views = json["bufferViews"].as_array_mut().unwrap();
    let first = views.len();
    views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": 2 }));
    views.push(json!({ "buffer": 0, "byteOffset": start + 4, "byteLength": 12 }));
    let accessors = json["accessors"].as_array_mut().unwrap();
    let target = accessors.len();
    accessors.push(json!({
        "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 1],
        "sparse": {
            "count": 1, "values": { "bufferView": first + 1 },
            "indices": { "bufferView": first, "componentType": 5123 },
        },
    }));
    json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": target }]);
    let glb = write_glb(&again(&read_parts(&json, &buffer).unwrap()), &[]).unwrap();
    assert_valid(&glb);
    let views = json_of(&glb)["bufferViews"].as_array().cloned().unwrap();
    assert!(views.iter().all(|view| view["byteLength"].as_u64() > Some(0)), "{views:?}");
}

#[test]
fn a_skeleton_has_no_geometry_and_key_frames_apart() {
    let Some(path) = shared_mesh("fox.glb") else { return };
    let scene = crate::read(&path, &ReadOptions::default()).unwrap();
    let skeleton = Skeleton::of(&scene, vec![true]).unwrap();
    // 24 matrices.
    assert_eq!(skeleton.buffer.len(), 24 * 64);
    assert!(skeleton.animations.len() > 10_000);
    let lost = Skeleton { animations: Vec::new(), ..skeleton.clone() };
    let mut still = lost.into_scene(images(&scene), false).unwrap();
    still.meshes[0].mesh = scene.meshes[0].mesh.clone();
    let glb = write_glb(&still, &[]).unwrap();
    assert_valid(&glb);
    let json = json_of(&glb);
    assert!(json.get("animations").is_none() && json["skins"][0]["joints"].is_array());
    // Attributes, indices and matrices; a view for each, and one for the image.
    let count = |key: &str| json[key].as_array().unwrap().len();
    assert_eq!([count("accessors"), count("bufferViews")], [6, 7]);
    assert!(json["accessors"].as_array().unwrap().iter().all(|a| a["count"].as_u64() > Some(0)));
    // Without being told that they are lost, there is an error.
    let lost = Skeleton { animations: Vec::new(), ..skeleton };
    assert!(lost.into_scene(images(&scene), true).is_err());
}

#[test]
fn previews_are_embedded_and_files_stay_files() {
    let (mut json, buffer) = square();
    json["images"] = json!([
        { "uri": "a.jpg" }, { "uri": "b.png" }, { "uri": "data:image/jpeg;base64,/9j/AAAA" }
    ]);
    let scene = read_parts(&json, &buffer).unwrap();
    let skeleton = Skeleton::of(&scene, vec![true]).unwrap();
    let png = |is_preview| SkeletonImage { bytes: b"\x89PNG".to_vec(), is_preview };
    let jpeg = SkeletonImage { bytes: scene.images[2].bytes.clone(), is_preview: false };
    let images = |scene: &Scene| scene.source.as_ref().unwrap().0.json["images"].clone();
    let whole = skeleton.clone().into_scene(vec![png(false), png(false), jpeg], true).unwrap();
    assert_eq!(images(&whole)[0], json!({ "uri": "a.jpg" }));
    assert_eq!(images(&whole)[2]["mimeType"], "image/jpeg");
    assert_eq!(whole.images[2].bytes, scene.images[2].bytes);
    let none = SkeletonImage { bytes: Vec::new(), is_preview: true };
    let part = skeleton.clone().into_scene(vec![png(true), none, png(true)], true).unwrap();
    for image in images(&part).as_array().unwrap() {
        assert!(image["mimeType"] == "image/png" && image["uri"].is_null(), "{image}");
    }
    assert!(part.images.iter().all(|image| image.bytes.starts_with(b"\x89PNG")));
    let script = SkeletonImage { bytes: b"#!/bin/sh".to_vec(), is_preview: false };
    let scene = skeleton.clone().into_scene(vec![script, png(true), png(true)], true).unwrap();
    assert!(scene.images[0].bytes.is_empty(), "no image");
    assert!(skeleton.into_scene(vec![png(true)], true).is_err());
}

#[test]
fn textures_with_previews_need_no_extension() {
    let (mut json, buffer) = square();
    let webp = |source: u32| json!({ "EXT_texture_webp": { "source": source } });
    json["images"] = json!([{ "uri": "a.webp" }, { "uri": "b.webp" }, { "uri": "c.png" }]);
    json["textures"] = json!([
        { "extensions": webp(0) }, { "extensions": webp(1), "source": 2 }, { "source": 2 }
    ]);
    json["extensionsUsed"] = json!(["EXT_texture_webp", "KHR_texture_transform"]);
    json["extensionsRequired"] = json!(["EXT_texture_webp"]);
    let scene = read_parts(&json, &buffer).unwrap();
    let skeleton = Skeleton::of(&scene, vec![true]).unwrap();
    let image = |is_preview| {
        let bytes: &[u8] = if is_preview { b"\x89PNG" } else { b"RIFF\x04\0\0\0WEBPVP8L" };
        SkeletonImage { bytes: bytes.to_vec(), is_preview }
    };
    let of = |previews: [bool; 3]| {
        let scene = skeleton.clone().into_scene(previews.map(image).to_vec(), true).unwrap();
        scene.source.as_ref().unwrap().0.json.clone()
    };
    let half = of([true, false, true]);
    assert_eq!(half["textures"][0], json!({ "source": 0 }));
    assert_eq!(half["textures"][1], json["textures"][1]);
    assert_eq!(half["extensionsRequired"], json["extensionsRequired"]);
    let none = of([true; 3]);
    assert_eq!(none["textures"], json!([{ "source": 0 }, { "source": 1 }, { "source": 2 }]));
    assert_eq!(none["extensionsUsed"], json!(["KHR_texture_transform"]));
    assert!(none.get("extensionsRequired").is_none());
    assert_eq!(of([false; 3])["textures"], json["textures"]);
}

#[test]
fn scenes_of_other_formats_come_back() {
    let node = |mesh, children| Node { name: "n".into(), mesh, children, ..Node::default() };
    let mut nodes = vec![node(None, vec![1, 2]), node(Some(0), vec![]), node(Some(0), vec![])];
    nodes[2].transform[3] = [0.1, 1.0 / 3.0, -7e-9, 1.0];
    let material = |image| Material {
        name: "m".into(),
        base_color: [1.5, 0.1, 0.0, 0.3],
        base_color_image: image,
        is_double_sided: image.is_none(),
        ..Material::default()
    };
    let image = |name: &str| crate::Image { name: name.into(), bytes: b"any".to_vec() };
    let materials = vec![Some(1), None];
    let scene = Scene {
        meshes: vec![SceneMesh { name: "mesh".into(), mesh: Mesh::default(), materials }],
        nodes,
        roots: vec![0],
        materials: [None, Some(1)].map(material).to_vec(),
        images: vec![image("sea.tga"), image("a b.png")],
        ..Scene::default()
    };
    // The mesh has one label for all its faces.
    let new = again(&scene);
    assert_eq!(
        (&new.nodes, &new.roots, &new.materials),
        (&scene.nodes, &scene.roots, &scene.materials)
    );
    assert_eq!((&new.images, &new.meshes[0].name), (&scene.images, &scene.meshes[0].name));
    assert!(new.source.is_none() && new.meshes[0].materials == [Some(1)]);
    let preview = SkeletonImage { bytes: b"\x89PNG".to_vec(), is_preview: true };
    let skeleton = Skeleton::of(&scene, vec![true]).unwrap();
    let part = skeleton.into_scene(vec![preview.clone(), preview], true).unwrap();
    assert_eq!([0, 1].map(|i| &part.images[i].name[..]), ["sea.preview.png", "a b.preview.png"]);
}

/// Every bit of a skeleton is changed in turn: it is refused, or what is written can be read.
#[test]
fn damaged_skeletons_do_no_harm() {
    let scene = rich();
    let skeleton = Skeleton::of(&scene, vec![true]).unwrap();
    let (mut refused, mut read) = (0, 0);
    for at in 0..8 * skeleton.document.len() {
        let mut wrong = skeleton.clone();
        wrong.document[at / 8] ^= 1 << (at % 8);
        let has_animations = at % 3 > 0;
        let Ok(mut scene) = wrong.into_scene(images(&scene), has_animations) else {
            refused += 1;
            continue;
        };
        read += 1;
        if let Some(mesh) = scene.meshes.first_mut() {
            mesh.mesh = rich().meshes[0].mesh.clone();
        }
        if let Ok(glb) = write_glb(&scene, &[]) {
            container::split(&glb).unwrap();
        }
    }
    assert!(refused > 1000 && read > 1000, "{refused} {read}");
}
