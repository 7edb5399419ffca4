//! Meshes shown several times by `EXT_mesh_gpu_instancing`.

use serde_json::{Value, json};

use crate::{Format, ReadOptions, Scene, gltf, read_bytes};

const NAME: &str = "EXT_mesh_gpu_instancing";

/// Builds a document of a triangle that a node at x = 10 shows twice: moved by 1 and 3 along x, and
/// scaled by 1 and 2.
fn document() -> Value {
    let positions = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let moves = [1.0f32, 0.0, 0.0, 3.0, 0.0, 0.0];
    let scales = [1.0f32, 1.0, 1.0, 2.0, 2.0, 2.0];
    let values = [&positions[..], &moves, &scales].concat();
    let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
    let uri = {
        use base64::Engine;
        base64::engine::general_purpose::STANDARD.encode(&bytes)
    };
    let vectors = |view: usize, count: usize| json!({ "bufferView": view, "componentType": 5126, "type": "VEC3", "count": count });
    let view =
        |at: usize, length: usize| json!({ "buffer": 0, "byteOffset": at, "byteLength": length });
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": [NAME],
        "extensionsRequired": [NAME],
        "buffers": [{
            "byteLength": bytes.len(),
            "uri": format!("data:application/octet-stream;base64,{uri}"),
        }],
        "bufferViews": [view(0, 36), view(36, 24), view(60, 24)],
        "accessors": [vectors(0, 3), vectors(1, 2), vectors(2, 2)],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "nodes": [{
            "mesh": 0,
            "translation": [10, 0, 0],
            "extensions": { NAME: { "attributes": { "TRANSLATION": 1, "SCALE": 2 } } },
        }],
    })
}

fn read(json: &Value) -> Result<Scene, String> {
    let bytes = json.to_string().into_bytes();
    read_bytes(&bytes, Format::Gltf, &mut |_| None, &ReadOptions::default())
        .map_err(|error| error.to_string())
}

#[test]
fn each_instance_is_shown_where_it_is() {
    let scene = read(&document()).unwrap();
    let flat = scene.flatten();
    let corners: Vec<f64> = flat.positions.iter().map(|position| position[0]).collect();
    assert_eq!(corners, [11.0, 12.0, 11.0, 13.0, 15.0, 13.0]);
    assert_eq!(scene.instances().len(), 2);
    let notes = scene.limits_of(Format::Ply);
    assert_eq!(notes[0].to_string(), "2 instances of meshes merged into one mesh");
}

#[test]
fn instances_are_written_unchanged() {
    let mut scene = read(&document()).unwrap();
    let expected = scene.instances();
    scene.meshes[0].mesh.positions[0][2] = 0.5;
    let written = gltf::write_glb(&scene, &[]).unwrap();
    let again = read_bytes(&written, Format::Glb, &mut |_| None, &ReadOptions::default()).unwrap();
    assert_eq!(again.instances(), expected);
    let source = again.source.unwrap();
    assert_eq!(source.file_facts().extensions_required, [NAME]);
}

#[test]
fn a_new_document_has_a_node_for_each_instance() {
    let mut scene = read(&document()).unwrap();
    scene.source = None;
    let written = gltf::write_glb(&scene, &[]).unwrap();
    let again = read_bytes(&written, Format::Glb, &mut |_| None, &ReadOptions::default()).unwrap();
    let transforms = |scene: &Scene| -> Vec<_> {
        scene.instances().into_iter().map(|instance| instance.transform).collect()
    };
    assert_eq!(transforms(&again), transforms(&scene));
}

#[test]
fn damaged_instances_are_errors_that_name_the_node() {
    let damages: [(&str, Value); 4] = [
        ("not an accessor", json!({ "attributes": { "SCALE": 9 } })),
        ("2 and 3", json!({ "attributes": { "SCALE": 2, "_ID": 0 } })),
        ("VEC4", json!({ "attributes": { "ROTATION": 2 } })),
        ("not an accessor", json!({ "attributes": { "SCALE": "x" } })),
    ];
    for (reason, damage) in damages {
        let mut json = document();
        json["nodes"][0]["extensions"][NAME] = damage;
        let error = read(&json).unwrap_err();
        assert!(error.starts_with("node 0: ") && error.contains(reason), "{reason}: {error}");
    }
    let mut json = document();
    let zeros = json!({ "componentType": 5126, "type": "VEC4", "count": 2 });
    json["accessors"].as_array_mut().unwrap().push(zeros);
    json["nodes"][0]["extensions"][NAME]["attributes"] = json!({ "ROTATION": 3 });
    assert!(read(&json).unwrap_err().contains("unit quaternion"));
    let mut json = document();
    json["accessors"][1]["count"] = 0.into();
    json["accessors"][2]["count"] = 0.into();
    assert!(read(&json).unwrap_err().contains("no instances"));
    // Billions of instances without bytes exceed the limit on values.
    let mut json = document();
    for accessor in [1, 2] {
        json["accessors"][accessor] =
            json!({ "componentType": 5126, "type": "VEC3", "count": 4_000_000_000u32 });
    }
    assert!(read(&json).unwrap_err().contains("far more than the file has data for"));
}
