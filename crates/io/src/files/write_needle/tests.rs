use std::collections::BTreeMap;
use std::path::PathBuf;

use meshlod_fixtures::{folder_files, seam_strip};
use meshlod_mesh::{Labels, Mesh};
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use super::*;
use crate::gltf::document::container;
use crate::gltf::{ImageSizes, Level, SizedImage};
use crate::{Image, Material, ReadOptions, WriteOptions, read, write};

const NAME: &str = "NEEDLE_progressive";

/// A strip of twelve faces in two materials, the first with a texture.
fn strip() -> Scene {
    let labels = Labels {
        names: ["a", "b"].map(String::from).to_vec(),
        of_face: [[0; 6], [1; 6]].as_flattened().to_vec(),
    };
    let mut scene = Scene::from_mesh("strip", Mesh { materials: Some(labels), ..seam_strip() });
    scene.images = vec![Image { name: "wood.png".into(), bytes: picture(200) }];
    scene.materials[0] = Material { base_color_image: Some(0), ..scene.materials[0].clone() };
    scene
}

/// Bytes that begin as a PNG does.
fn picture(length: usize) -> Vec<u8> {
    [b"\x89PNG\r\n\x1a\n".to_vec(), vec![length as u8; length]].concat()
}

fn sizes() -> Vec<ImageSizes> {
    let size = |side: u32| SizedImage { size: [side, side], bytes: picture(side as usize) };
    vec![ImageSizes { image: 0, sizes: [200, 100, 50].map(size).to_vec() }]
}

/// Levels with the first faces of a scene.
fn levels(scene: &Scene, faces: &[usize]) -> Vec<Level> {
    let first = |mesh: &Mesh, faces: usize| {
        let mut mesh = mesh.clone();
        mesh.faces.truncate(faces);
        mesh.materials.iter_mut().for_each(|labels| labels.of_face.truncate(faces));
        mesh.attributes.iter_mut().for_each(|own| own.corners.truncate(faces));
        mesh.compact();
        mesh
    };
    let of_scene = |&faces: &usize| Level {
        meshes: scene.meshes.iter().map(|own| first(&own.mesh, faces)).collect(),
        screen_coverage: 0.5,
    };
    faces.iter().map(of_scene).collect()
}

fn write_all(
    path: &Path,
    scene: &Scene,
    faces: &[usize],
    images: &[ImageSizes],
) -> Vec<WrittenFile> {
    let levels = levels(scene, faces);
    let errors: Vec<_> = (0..levels.len()).map(|k| Some(k as f64)).collect();
    let needle = NeedleLevels { levels: &levels, errors: &errors, images };
    write_needle(path, scene, needle).unwrap()
}

/// Reads a GLB file, which another reader has to accept, too.
fn document(path: &Path) -> Value {
    let bytes = fs::read(path).unwrap();
    gltf::Gltf::from_slice(&bytes).unwrap();
    serde_json::from_slice(container::split(&bytes).unwrap().0).unwrap()
}

/// Writes the strip with levels of 7, 6 and 0 faces; the input is read from a GLB file, unless it is
/// `bare`.
fn written(bare: bool) -> (TempDir, PathBuf, Scene) {
    let folder = tempdir().unwrap();
    let mut scene = strip();
    if !bare {
        let input = folder.path().join("in.glb");
        write(&input, &scene, &WriteOptions::default()).unwrap();
        scene = read(&input, &ReadOptions::default()).unwrap();
        fs::remove_file(&input).unwrap();
    }
    let path = folder.path().join("a b.glb");
    write_all(&path, &scene, &[7, 6, 0], &sizes());
    (folder, path, scene)
}

#[test]
fn every_level_keeps_all_primitives_in_order() {
    for bare in [true, false] {
        let (folder, path, scene) = written(bare);
        let json = document(&path);
        assert_eq!(json["extensionsUsed"], json!([NAME]));
        assert_eq!(json.get("extensionsRequired"), None);
        let own = &json["meshes"][0]["extensions"][NAME];
        let lods = own["lods"].as_array().unwrap();
        assert_eq!(lods.len(), 3);
        assert_eq!(own["extras"], json!({ "level": "LOD3", "error_measured": 2.0 }));
        let names = |primitive: &Value| {
            primitive["attributes"].as_object().unwrap().keys().cloned().collect::<Vec<_>>()
        };
        let shown = &json["meshes"][0]["primitives"];
        for (lod, faces) in lods.iter().zip([[6, 6], [6, 1], [6, 0]]) {
            let name = lod["path"].as_str().unwrap().replace("%20", " ");
            assert!(name.contains(lod["hash"].as_str().unwrap()), "{lod}");
            let level = document(&folder.path().join(&name));
            assert_eq!(level["meshes"][0]["extensions"][NAME]["guid"], own["guid"]);
            assert_eq!(level["extensionsUsed"], json!([NAME]));
            let primitives = level["meshes"][0]["primitives"].as_array().unwrap();
            assert_eq!(primitives.len(), 2);
            for (at, primitive) in primitives.iter().enumerate() {
                assert_eq!(names(primitive), names(&shown[at]), "materials stay what they are");
                let accessor = |key: &Value| &level["accessors"][key.as_u64().unwrap() as usize];
                let count = accessor(&primitive["indices"])["count"].as_u64().unwrap();
                assert_eq!(count, 3 * faces[at].max(1));
                let position = accessor(&primitive["attributes"]["POSITION"]);
                let of_shown = shown[at]["attributes"]["POSITION"].as_u64().unwrap() as usize;
                if faces[at] == 0 {
                    let bounds = &json["accessors"][of_shown];
                    assert_eq!(
                        [&position["min"], &position["max"]],
                        [&bounds["min"], &bounds["max"]]
                    );
                }
            }
            assert_eq!(lod["densities"].as_array().unwrap().len(), 2);
            assert_eq!(lod["densities"][1].as_f64().unwrap() == 0.0, faces[1] == 0);
            assert_eq!(lod["indexCount"], faces.iter().map(|&f| 3 * f.max(1)).sum::<u64>());
        }
        let finest = lods[0]["path"].as_str().unwrap().replace("%20", " ");
        let finest = read(folder.path().join(finest), &ReadOptions::default()).unwrap();
        assert_eq!(finest.meshes[0].mesh.faces.len(), scene.meshes[0].mesh.faces.len());
        let density = |lod: usize| lods[lod]["densities"][1].as_f64().unwrap();
        assert!((density(0) / density(1) - 6.0).abs() < 1e-4, "densities count triangles");
    }
}

#[test]
fn a_primitive_without_faces_has_the_bounds_that_it_had() {
    let (_folder, path, _) = written(false);
    let json = document(&path);
    for primitive in json["meshes"][0]["primitives"].as_array().unwrap() {
        let accessor = |key: &Value| &json["accessors"][key.as_u64().unwrap() as usize];
        assert_eq!(accessor(&primitive["indices"])["count"], 3, "no face is left");
        let position = accessor(&primitive["attributes"]["POSITION"]);
        assert_eq!(position["count"], 2);
        let side = |axis: usize| {
            let at = |key: &str| position[key][axis].as_f64().unwrap();
            at("max") - at("min")
        };
        assert!(side(0) > 0.5 && side(2) == 1.0, "{position}");
        assert!(primitive["attributes"].get("TEXCOORD_0").is_some());
    }
}

#[test]
fn larger_images_are_files_and_the_smallest_is_in_the_document() {
    for bare in [true, false] {
        let (folder, path, _) = written(bare);
        let json = document(&path);
        let own = &json["textures"][0]["extensions"][NAME];
        let mut widths = Vec::new();
        for lod in own["lods"].as_array().unwrap() {
            widths.push(lod["width"].as_u64().unwrap());
            let file = folder.path().join(lod["path"].as_str().unwrap().replace("%20", " "));
            let image = document(&file);
            assert_eq!(image["textures"][0]["extensions"][NAME]["guid"], own["guid"]);
            let bytes = fs::read(&file).unwrap();
            let has = picture(widths[widths.len() - 1] as usize);
            assert!(bytes.windows(has.len()).any(|part| part == has));
        }
        assert_eq!(widths, [200, 100]);
        let bytes = fs::read(&path).unwrap();
        let has = |length: usize| {
            let picture = picture(length);
            bytes.windows(picture.len()).any(|part| part == picture)
        };
        assert_eq!([200, 100, 50].map(has), [false, false, true], "bare: {bare}");
    }
}

#[test]
fn the_same_input_gives_the_same_files_and_old_ones_go() {
    let (folder, path, scene) = written(false);
    let before = folder_files(folder.path());
    write_all(&path, &scene, &[7, 6, 0], &sizes());
    assert_eq!(folder_files(folder.path()), before);
    let own = folder.path().join("a b_levels/notes.txt");
    fs::write(&own, "mine").unwrap();
    let written = write_all(&path, &scene, &[5], &[]);
    let after = folder_files(folder.path());
    let parts: Vec<&str> = written.iter().map(|file| &file.name[..]).collect();
    assert_eq!(parts.len(), 2);
    for (name, bytes) in &after {
        let listed = written.iter().find(|file| file.name == *name);
        assert!(
            listed.is_some_and(|file| file.bytes == bytes.len()) || name.ends_with("notes.txt")
        );
    }
    assert_eq!(after.len(), 3);
}

#[test]
fn ids_differ_by_mesh_and_by_document() {
    let folder = tempdir().unwrap();
    let mut scene = strip();
    scene.meshes.push(scene.meshes[0].clone());
    scene.nodes.push(crate::Node { mesh: Some(1), ..Default::default() });
    scene.roots.push(1);
    let mut ids = Vec::new();
    for name in ["a.glb", "b.glb"] {
        let path = folder.path().join(name);
        write_all(&path, &scene, &[4], &[]);
        let json = document(&path);
        let meshes = json["meshes"].as_array().unwrap();
        ids.extend(meshes.iter().map(|mesh| mesh["extensions"][NAME]["guid"].to_string()));
    }
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), 4, "two equal meshes in two documents");
}

#[test]
fn a_mesh_that_stays_the_same_has_no_levels() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.glb");
    assert_eq!(write_all(&path, &strip(), &[12, 12], &[]).len(), 1);
    let json = document(&path);
    assert_eq!(json.get("extensionsUsed"), None);
    assert_eq!(json["meshes"][0].get("extensions"), None);
    assert_eq!(folder_files(folder.path()).len(), 1);
}

#[test]
fn lines_before_a_surface_keep_its_number() {
    let folder = tempdir().unwrap();
    let input = folder.path().join("in.glb");
    write(&input, &strip(), &WriteOptions::default()).unwrap();
    let bytes = fs::read(&input).unwrap();
    let (json, buffer) = container::split(&bytes).unwrap();
    let mut json: Value = serde_json::from_slice(json).unwrap();
    let mut lines = json["meshes"][0]["primitives"][1].clone();
    lines["mode"] = 1.into();
    json["meshes"][0]["primitives"].as_array_mut().unwrap().insert(0, lines);
    fs::write(&input, container::join(json.to_string().as_bytes(), buffer.unwrap()).unwrap())
        .unwrap();
    let scene = read(&input, &ReadOptions::default()).unwrap();
    let path = folder.path().join("a.glb");
    write_all(&path, &scene, &[7], &[]);
    let json = document(&path);
    assert_eq!(json["meshes"][0]["primitives"][0]["mode"], 1, "the document keeps its lines");
    let lods = json["meshes"][0]["extensions"][NAME]["lods"].as_array().unwrap();
    let level = document(&folder.path().join(lods[0]["path"].as_str().unwrap()));
    let modes: Vec<_> = level["meshes"][0]["primitives"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p.get("mode"))
        .collect();
    assert_eq!(modes, [None; 3], "the client counts triangles alone");
    assert_eq!(lods[0]["densities"][0], 0.0);
}

#[test]
fn gltf_has_the_same_levels() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    let written = write_all(&path, &strip(), &[7], &sizes());
    let files = folder_files(folder.path());
    let listed: BTreeMap<_, _> =
        written.iter().map(|file| (file.name.clone(), file.bytes)).collect();
    assert_eq!(
        files.iter().map(|(name, bytes)| (name.clone(), bytes.len())).collect::<BTreeMap<_, _>>(),
        listed
    );
    let json: Value = serde_json::from_slice(&files["a.gltf"]).unwrap();
    let lods = json["meshes"][0]["extensions"][NAME]["lods"].as_array().unwrap();
    assert!(lods.iter().all(|lod| files.contains_key(lod["path"].as_str().unwrap())));
    read(&path, &ReadOptions::default()).unwrap();
}

#[test]
fn a_failure_leaves_what_was_there() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.glb");
    fs::write(&path, "old").unwrap();
    fs::write(folder.path().join("a_levels"), "a file, no folder").unwrap();
    let before = folder_files(folder.path());
    let (scene, images) = (strip(), sizes());
    let levels = levels(&scene, &[4]);
    let needle = NeedleLevels { levels: &levels, errors: &[None], images: &images };
    write_needle(&path, &scene, needle).unwrap_err();
    assert_eq!(folder_files(folder.path()), before);
    let refused = write_needle(folder.path().join("a.ply"), &scene, needle).unwrap_err();
    assert!(refused.to_string().contains("only .glb and .gltf"), "{refused}");
    let wrong = Level { meshes: vec![], screen_coverage: 0.5 };
    let needle = NeedleLevels { levels: &[wrong], ..needle };
    let refused = write_needle(folder.path().join("b.glb"), &scene, needle).unwrap_err();
    assert!(refused.to_string().contains("has 0 meshes"), "{refused}");
    assert_eq!(folder_files(folder.path()), before);
}
