//! Tests of glTF in passing: the triangles of scenes, and files that are damaged.

use std::fs;

use meshlod_fixtures::{own_file, shared_mesh};
use meshlod_io::{Note, ReadOptions, WriteOptions};
use meshlod_mesh::LayerKind;
use serde_json::{Value, json};
use tempfile::TempDir;

use super::*;
use crate::source::SceneSource;
use crate::source::fixtures::{all, patch};

/// Checks that a file has the same triangles, materials, images and notes in passing and as a scene.
#[track_caller]
fn check_same(path: &Path) -> usize {
    let scratch = tempfile::tempdir().unwrap();
    let scene = meshlod_io::read(path, &ReadOptions::default()).unwrap();
    let look = |scene: &Scene| (scene.materials.clone(), scene.images.clone());
    let (source, own) = GltfSource::open(path, 0, scratch.path()).unwrap().unwrap();
    assert_eq!(look(&own), look(&scene));
    assert_eq!(notes(&own), notes(&scene));
    let whole = SceneSource::new(scene);
    assert_eq!(source.layout(), whole.layout());
    let (found, expected) = (all(&source), all(&whole));
    assert_eq!(found.places, expected.places);
    assert_eq!(found.materials, expected.materials);
    assert!(found.values == expected.values, "values");
    assert_eq!(source.bounds().unwrap(), whole.bounds().unwrap());
    assert_eq!(fs::read_dir(scratch.path()).unwrap().count(), 0);
    expected.places.len()
}

/// Returns the notes on a scene and its tiles, but those that count corners of meshes.
fn notes(scene: &Scene) -> Vec<String> {
    let limits = scene.tile_limits();
    let texts = scene.notes.iter().chain(&limits).map(Note::to_string);
    texts.filter(|text| !text.contains("unit length") && !text.contains("weights")).collect()
}

/// Document of all that there is, and its buffer: attributes of several types in one view, lists,
/// strips and fans with and without indices, sparse and missing data, mirrored and repeated nodes.
fn everything() -> (Value, Vec<u8>) {
    let mut bytes = Vec::new();
    let wave = |i: usize, k: usize| ((i * 7 + k * 3) as f32 * 0.37).sin();
    let floats = |bytes: &mut Vec<u8>, values: &[f32]| {
        values.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    };
    for i in 0..9 {
        let normal = [wave(i, 5), 0.1, wave(i, 6)];
        floats(&mut bytes, &[wave(i, 0), wave(i, 1), wave(i, 2), normal[0], normal[1], normal[2]]);
        bytes.extend([(7000 * i) as u16, 123].map(u16::to_le_bytes).as_flattened());
        bytes.extend([i as u8, 20 * i as u8, 255, 128]);
    }
    bytes.extend([0u16, 1, 2, 2, 1, 3, 4, 4, 5, 8].map(u16::to_le_bytes).as_flattened());
    bytes.extend([0u8, 1, 2, 2, 3, 5, 4, 8]);
    for i in 0..9 {
        floats(&mut bytes, &[0.5, wave(i, 8).abs(), 0.25]);
    }
    bytes.extend([0u8, 127, 0, 1].repeat(9));
    bytes.extend([1u32, 4, 8].map(u32::to_le_bytes).as_flattened());
    floats(&mut bytes, &[5.0, 1.0, 0.0, 5.0, 0.0, 1.5, 6.0, 2.0, 0.1]);
    floats(&mut bytes, &[0.5, f32::NAN].repeat(9));
    floats(&mut bytes, &[1.0, 2.0, 3.0, -4.0, 0.0, 0.5]);
    let view =
        |at: usize, length: usize| json!({"buffer": 0, "byteOffset": at, "byteLength": length});
    let mut interleaved = view(0, 288);
    interleaved["byteStride"] = 32.into();
    let mut padded = view(424, 36);
    padded["byteStride"] = 4.into();
    let accessor = |view: usize, at: usize, kind: u32, count: usize, shape: &str, unit: bool| {
        json!({"bufferView": view, "byteOffset": at, "componentType": kind, "count": count,
               "type": shape, "normalized": unit})
    };
    let json = json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_mesh_quantization", "EXT_mesh_gpu_instancing"],
        "buffers": [{"byteLength": bytes.len()}],
        "bufferViews": [
            interleaved, view(288, 20), view(308, 8), view(316, 108), padded, view(460, 12),
            view(472, 36), view(508, 72), view(580, 24),
        ],
        "accessors": [
            accessor(0, 0, 5126, 9, "VEC3", false),
            accessor(0, 12, 5126, 9, "VEC3", false),
            accessor(0, 24, 5123, 9, "VEC2", true),
            accessor(0, 28, 5121, 9, "VEC4", true),
            accessor(1, 0, 5123, 10, "SCALAR", false),
            accessor(2, 0, 5121, 8, "SCALAR", false),
            accessor(3, 0, 5126, 9, "VEC3", false),
            accessor(4, 0, 5120, 9, "VEC3", true),
            {"componentType": 5126, "count": 9, "type": "VEC3", "sparse": {"count": 3,
                "indices": {"bufferView": 5, "componentType": 5125},
                "values": {"bufferView": 6}}},
            accessor(5, 0, 5125, 3, "SCALAR", false),
            accessor(7, 0, 5126, 9, "VEC2", false),
            accessor(8, 0, 5126, 2, "VEC3", false),
        ],
        "materials": [{"name": "first"}, {"name": "second"}],
        "meshes": [
            {"name": "all", "primitives": [
                {"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "COLOR_0": 3},
                 "indices": 4, "material": 1},
                {"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 5, "mode": 5},
                {"attributes": {"POSITION": 0, "COLOR_0": 6, "NORMAL": 7}, "mode": 6,
                 "material": 0},
                {"attributes": {"POSITION": 0}, "mode": 0},
                {"attributes": {"POSITION": 0, "NORMAL": 1}, "mode": 5, "material": 1},
            ]},
            {"primitives": [{"attributes": {"POSITION": 8, "NORMAL": 1, "TEXCOORD_0": 10,
                "TEXCOORD_1": 2}, "indices": 9, "material": 0}]},
            {"name": "hidden", "primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}}]},
        ],
        "nodes": [
            {"mesh": 0, "scale": [-2, 1, 1], "translation": [1, 2, 3], "children": [1]},
            {"mesh": 1, "rotation": [0, 0.6, 0, 0.8]},
            {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {
                "attributes": {"TRANSLATION": 11}}}},
            {"mesh": 2},
        ],
        "scenes": [{"nodes": [2, 0]}],
    });
    (json, bytes)
}

/// Writes a document and its buffer beside each other.
fn folder(json: &Value, bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let mut json = json.clone();
    json["buffers"][0]["uri"] = "a buffer.bin".into();
    fs::write(folder.path().join("a buffer.bin"), bytes).unwrap();
    let path = folder.path().join("a.gltf");
    fs::write(&path, json.to_string()).unwrap();
    (folder, path)
}

#[track_caller]
fn error(change: impl FnOnce(&mut Value, &mut Vec<u8>)) -> String {
    let (mut json, mut bytes) = everything();
    change(&mut json, &mut bytes);
    let (folder, path) = folder(&json, &bytes);
    let whole = meshlod_io::read(&path, &ReadOptions::default()).map(drop);
    let passed = match GltfSource::open(&path, 0, folder.path()) {
        Ok(opened) => opened.unwrap().0.triangles(&mut |_| Ok(())),
        Err(error) => Err(error),
    };
    let text = passed.unwrap_err().to_string();
    assert_eq!(text, whole.unwrap_err().to_string());
    text.split_once("a.gltf: ").unwrap().1.to_owned()
}

#[test]
fn triangles_are_those_of_a_scene() {
    let (json, bytes) = everything();
    let (_folder, path) = folder(&json, &bytes);
    assert_eq!(check_same(&path), 3 * (3 + 4 + 7 + 7) + 1);
}

#[test]
fn many_faces_come_some_at_a_time() {
    let kinds = [LayerKind::Normal, LayerKind::Uv(0), LayerKind::Color(0)];
    let scene = Scene::from_mesh("patch", patch(150_000, &kinds));
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.glb", "a.gltf"] {
        let path = folder.path().join(name);
        meshlod_io::write(&path, &scene, &WriteOptions::default()).unwrap();
        assert!(check_same(&path) > 2 * MOST_TRIANGLES);
        meshlod_io::write_compressed(&path, &scene, &meshlod_io::gltf::Compression::default())
            .unwrap();
        assert!(check_same(&path) > 2 * MOST_TRIANGLES);
    }
}

#[test]
fn strips_and_fans_come_some_at_a_time() {
    let count = 3 * GROUP + 1;
    let bytes: Vec<u8> = (0..count)
        .flat_map(|i| [(i as f32).sin(), (i % 7) as f32, i as f32])
        .flat_map(f32::to_le_bytes)
        .collect();
    let primitive = |mode: u32| json!({"attributes": {"POSITION": 0}, "mode": mode});
    let json = json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": bytes.len()}],
        "bufferViews": [{"buffer": 0, "byteLength": bytes.len()}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3"}],
        "meshes": [{"primitives": [primitive(0), primitive(4), primitive(5), primitive(6)]}],
        "nodes": [{"mesh": 0}],
    });
    let (_folder, path) = folder(&json, &bytes);
    assert_eq!(check_same(&path), count / 3 + 2 * (count - 2));
}

#[test]
fn compressed_and_shared_files_are_those_of_a_scene() {
    for name in ["edgebreaker.glb", "sequential.glb", "unquantized.glb"] {
        check_same(&own_file("draco").join(name));
    }
    let names = [
        "cesium-man.glb",
        "cesium-milk-truck.glb",
        "city.glb",
        "duck.glb",
        "fox.glb",
        "dragon-attenuation.glb",
        "flight-helmet/FlightHelmet.gltf",
        "mountains.gltf",
        "strip-mode5.gltf",
    ];
    for path in names.into_iter().filter_map(shared_mesh) {
        check_same(&path);
    }
}

#[test]
fn faces_without_normals_get_their_own() {
    let (mut json, bytes) = everything();
    json["meshes"][1]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("NORMAL");
    let (folder, path) = folder(&json, &bytes);
    let (source, scene) = GltfSource::open(&path, 0, folder.path()).unwrap().unwrap();
    let texts = notes(&scene);
    assert!(texts.contains(&"1 of 70 faces that lack normals, which get their own".to_owned()));
    let triangles = all(&source);
    let last = triangles.values.len() - 3 * source.layout().width();
    let normal = &triangles.values[last..][..3];
    let length: f32 = normal.iter().map(|x| x * x).sum();
    assert!((length - 1.0).abs() < 1e-6, "{normal:?}");
}

#[test]
fn the_size_of_a_document_is_that_of_its_buffers_too() {
    let (json, bytes) = everything();
    let (folder, path) = folder(&json, &bytes);
    let whole = fs::metadata(&path).unwrap().len() + bytes.len() as u64;
    let open = |least: u64| GltfSource::open(&path, least, folder.path()).unwrap().is_some();
    assert!(open(whole) && !open(whole + 1));
    fs::write(&path, "{").unwrap();
    assert!(!open(2));
}

#[test]
fn damage_is_named_as_in_a_scene() {
    assert_eq!(
        error(|_, bytes| bytes[288] = 9),
        "accessor 4: index 0 is 9, but there are only 9 vertices"
    );
    assert_eq!(
        error(|_, bytes| bytes[32..36].copy_from_slice(&f32::NAN.to_le_bytes())),
        "accessor 0: element 1 is not finite: NaN"
    );
    assert!(error(|_, bytes| bytes.truncate(100)).starts_with("buffer 0: has 100 bytes"));
    assert!(error(|json, _| json["accessors"][0]["count"] = 10.into()).contains("accessor 0"));
    assert!(error(|json, _| json["accessors"][1]["count"] = 8.into()).contains("primitive 0"));
    assert!(error(|json, _| json["nodes"][0]["mesh"] = 7.into()).starts_with("mesh 7"));
    let material = |json: &mut Value| json["meshes"][0]["primitives"][0]["material"] = 2.into();
    assert!(error(|json, _| material(json)).starts_with("material 2"));
    let kind = |json: &mut Value| json["accessors"][4]["componentType"] = 5126.into();
    assert!(error(|json, _| kind(json)).starts_with("accessor 4: indices must be"));
    let gone = |json: &mut Value| json["bufferViews"][0]["byteOffset"] = 9999.into();
    assert!(error(|json, _| gone(json)).starts_with("bufferView 0"));
}

#[test]
fn every_cut_of_a_glb_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let scene = Scene::from_mesh("patch", patch(20, &[LayerKind::Normal]));
    meshlod_io::write(&path, &scene, &WriteOptions::default()).unwrap();
    let bytes = fs::read(&path).unwrap();
    for end in 0..bytes.len() {
        fs::write(&path, &bytes[..end]).unwrap();
        let whole = meshlod_io::read(&path, &ReadOptions::default()).unwrap_err();
        let passed = GltfSource::open(&path, 0, folder.path()).map(drop).unwrap_err();
        assert_eq!(passed.to_string(), whole.to_string(), "{end}");
    }
}

#[test]
fn a_file_that_changes_meanwhile_is_an_error() {
    let (json, bytes) = everything();
    let (folder, path) = folder(&json, &bytes);
    let (source, _) = GltfSource::open(&path, 0, folder.path()).unwrap().unwrap();
    fs::write(folder.path().join("a buffer.bin"), &bytes[..100]).unwrap();
    let error = source.triangles(&mut |_| Ok(())).unwrap_err().to_string();
    assert!(error.contains("a.gltf: buffer 0: "), "{error}");
}
