//! Invalid documents: one clear error, or whatever can be read of them.

use meshlod_fixtures::shared_mesh;
use serde_json::{Value, json};

use super::{json_of, read_parts, square};
use crate::ReadOptions;
use crate::gltf::write_glb;

/// Reads the square after a change to its JSON.
fn spoilt(change: impl FnOnce(&mut Value)) -> Result<crate::Scene, String> {
    let (mut json, buffer) = square();
    change(&mut json);
    read_parts(&json, &buffer).map_err(|error| error.to_string())
}

#[test]
fn each_fault_is_told_with_its_place() {
    type Change = fn(&mut Value);
    let faults: [(&str, Change); 16] = [
        ("accessor 9", |j| j["meshes"][0]["primitives"][0]["indices"] = 9.into()),
        ("accessor 9", |j| j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9.into()),
        ("accessor 1", |j| j["accessors"][0]["count"] = 3.into()),
        ("accessor 0", |j| j["accessors"][0]["count"] = json!(1u64 << 40)),
        ("accessor 0", |j| j["accessors"][0]["type"] = "VEC2".into()),
        ("accessor 0", |j| j["accessors"][0]["componentType"] = 7.into()),
        ("accessor 0", |j| drop(j["accessors"][0].as_object_mut().unwrap().remove("count"))),
        ("mesh 0, primitive 0", |j| j["meshes"][0]["primitives"][0]["attributes"] = json!({})),
        ("mesh 0", |j| j["meshes"][0] = json!({})),
        ("bufferView 0", |j| j["bufferViews"][0]["byteLength"] = json!(u64::MAX)),
        ("buffer 5", |j| j["bufferViews"][0]["buffer"] = 5.into()),
        ("buffer 0", |j| j["buffers"][0]["byteLength"] = 100.into()),
        ("buffer 0", |j| j["buffers"][0]["uri"] = "gone.bin".into()),
        ("material 3", |j| j["meshes"][0]["primitives"][0]["material"] = 3.into()),
        ("asset", |j| j["asset"]["version"] = "1.0".into()),
        ("nodes", |j| j["nodes"] = json!({ "not": "an array" })),
    ];
    assert!(spoilt(|_| {}).is_ok());
    for (place, change) in faults {
        let error = spoilt(change).unwrap_err();
        assert!(error.starts_with(&format!("{place}:")), "{place}: {error}");
        assert!(!error.contains('\n'), "{error}");
    }
}

#[test]
fn geometry_that_cannot_be_decoded_is_refused_by_the_extensions_name() {
    for name in ["KHR_unheard_of_draco", "EXT_unheard_of"] {
        let error = spoilt(|json| json["extensionsRequired"] = json!([name])).unwrap_err();
        assert!(error.contains(name), "{error}");
    }
    let draco = "KHR_draco_mesh_compression";
    let stream = json!({ draco: { "bufferView": 0, "attributes": { "POSITION": 0 } } });
    let in_place = spoilt(|json| {
        json["meshes"][0]["primitives"][0]["extensions"] = stream.clone();
        json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    });
    let error = in_place.unwrap_err();
    assert!(error.starts_with("mesh 0, primitive 0:"), "{error}");
    if cfg!(not(feature = "draco")) {
        assert!(error.contains(draco) && error.contains("feature `draco`"), "{error}");
        let required = spoilt(|json| json["extensionsRequired"] = json!([draco])).unwrap_err();
        assert!(required.contains("feature `draco`"), "{required}");
    }
    let quantized = spoilt(|json| json["extensionsRequired"] = json!(["KHR_mesh_quantization"]));
    assert!(quantized.is_ok());
}

#[test]
fn compressed_geometry_that_is_there_uncompressed_is_read_from_there() {
    let draco = "KHR_draco_mesh_compression";
    let scene = spoilt(|json| {
        json["extensionsUsed"] = json!([draco]);
        let view = json!({ "buffer": 0, "byteLength": 48 });
        json["bufferViews"].as_array_mut().unwrap().push(view);
        let stream = json!({ draco: { "bufferView": 2, "attributes": { "POSITION": 0 } } });
        json["meshes"][0]["primitives"][0]["extensions"] = stream;
    })
    .unwrap();
    assert_eq!(scene.meshes[0].mesh, spoilt(|_| {}).unwrap().meshes[0].mesh);
    let written = json_of(&write_glb(&scene, &[]).unwrap());
    assert!(!written.to_string().contains("draco"), "{written}");
    assert_eq!(written["bufferViews"][2]["byteLength"], 4, "the stream is not carried along");
}

#[test]
fn a_small_file_cannot_ask_for_much_memory() {
    let zeros = spoilt(|json| {
        json["accessors"][0] = json!({ "componentType": 5126, "count": u32::MAX, "type": "VEC3" });
    });
    assert!(zeros.unwrap_err().contains("far more than the file has data for"));
    let layers = spoilt(|json| {
        let primitive = |i| {
            json!({
                "attributes": { "POSITION": 0, format!("_A{i}"): 0 }, "indices": 1
            })
        };
        json["meshes"][0]["primitives"] = (0..5000).map(primitive).collect();
    });
    assert!(layers.unwrap_err().contains("far more"));
    let instances = spoilt(|json| {
        json["accessors"][1]["count"] = 6.into();
        json["nodes"] = (0..200_000).map(|_| json!({ "mesh": 0 })).collect();
    });
    assert!(instances.is_ok(), "honest instances are fine");
}

#[test]
fn the_shared_broken_files_say_what_is_wrong() {
    let cases = [
        ("recursive-nodes.gltf", Err("node 0")),
        ("box-with-infinites.glb", Err("not finite")),
        ("box-bad-normals.glb", Ok(12)),
        ("bad-array.gltf", Err("buffer 0")),
        ("empty-nodes.glb", Ok(0)),
        ("web-page.glb", Err("web page")),
    ];
    for (name, expected) in cases {
        let Some(path) = shared_mesh(&format!("broken/{name}")) else {
            println!("skipped: broken/{name} is not there");
            continue;
        };
        let found = crate::read(&path, &ReadOptions::default());
        match (found.map_err(|error| error.to_string()), expected) {
            (Ok(scene), Ok(faces)) => assert_eq!(scene.flatten().faces.len(), faces, "{name}"),
            (Err(error), Err(part)) => {
                assert!(error.contains(part) && error.contains(name), "{error}");
                assert!(!error.contains('\n'), "{error}");
            }
            (found, _) => panic!("{name}: {:?}", found.map(|_| "read")),
        }
    }
}
