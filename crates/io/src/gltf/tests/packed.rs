//! Compressed buffer views: decompressed on reading, or rejected with their location.

use serde_json::{Value, json};

use super::{json_of, read_parts, round_trip, square};
use crate::Scene;
use crate::gltf::write_glb;
use crate::meshopt::{encode_attributes, encode_triangles};

/// The square with both its views compressed by the named extension, into a fallback buffer.
fn packed_square(name: &str) -> (Value, Vec<u8>) {
    let (mut json, plain) = square();
    let positions = encode_attributes(&plain[..48], 12);
    let indices = encode_triangles(&[[0, 1, 2], [2, 1, 3]]);
    json["buffers"] = json!([
        { "byteLength": positions.len() + indices.len() },
        { "byteLength": 60, "extensions": { name: { "fallback": true } } },
    ]);
    json["bufferViews"] = json!([
        { "buffer": 1, "byteLength": 48, "byteStride": 12, "extensions": { name: {
            "buffer": 0, "byteLength": positions.len(), "byteStride": 12, "count": 4,
            "mode": "ATTRIBUTES" } } },
        { "buffer": 1, "byteOffset": 48, "byteLength": 12, "extensions": { name: {
            "buffer": 0, "byteOffset": positions.len(), "byteLength": indices.len(),
            "byteStride": 2, "count": 6, "mode": "TRIANGLES", "filter": "NONE" } } },
    ]);
    json["extensionsUsed"] = json!([name]);
    json["extensionsRequired"] = json!([name]);
    (json, [positions, indices].concat())
}

fn spoilt(change: impl FnOnce(&mut Value)) -> Result<Scene, String> {
    let (mut json, buffer) = packed_square("EXT_meshopt_compression");
    change(&mut json);
    read_parts(&json, &buffer).map_err(|error| error.to_string())
}

#[test]
fn a_compressed_document_is_the_plain_one() {
    let (json, buffer) = square();
    let plain = read_parts(&json, &buffer).unwrap();
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let (json, buffer) = packed_square(name);
        let scene = read_parts(&json, &buffer).unwrap();
        assert_eq!(scene.meshes[0].mesh, plain.meshes[0].mesh);
        assert_eq!(round_trip(&scene).meshes[0].mesh, plain.meshes[0].mesh);
        let written = json_of(&write_glb(&scene, &[]).unwrap());
        assert!(!written.to_string().contains("meshopt"), "{written}");
        assert!(written.get("extensionsRequired").is_none());
    }
}

#[test]
fn a_placeholder_need_not_be_called_one_but_nothing_else_may_lie_in_it() {
    assert!(
        spoilt(|j| drop(j["buffers"][1].as_object_mut().unwrap().shift_remove("extensions")))
            .is_ok()
    );
    let error =
        spoilt(|j| drop(j["bufferViews"][0].as_object_mut().unwrap().shift_remove("extensions")));
    assert!(error.unwrap_err().starts_with("bufferView 0: 48 bytes at 0 exceed buffer 1"));
}

#[test]
fn each_fault_of_compression_is_located() {
    type Change = fn(&mut Value);
    let faults: [(&str, &str, Change); 11] = [
        ("bufferView 0", "mode \"DRACO\"", |e| e["mode"] = "DRACO".into()),
        ("bufferView 0", "filter \"ZIP\"", |e| e["filter"] = "ZIP".into()),
        ("bufferView 0", "byteLength", |e| e["count"] = 5.into()),
        ("bufferView 0", "byteLength", |e| e["count"] = json!(u64::MAX)),
        ("bufferView 0", "header", |e| e["byteOffset"] = 1.into()),
        ("bufferView 0", "byte ", |e| e["byteLength"] = 40.into()),
        ("bufferView 0", "filter", |e| e["filter"] = "QUATERNION".into()),
        ("bufferView 0", "missing field", |e| drop(e.as_object_mut().unwrap().remove("count"))),
        ("bufferView 0", "not an object", |e| *e = json!([0])),
        ("buffer 7", "only 2", |e| e["buffer"] = 7.into()),
        ("buffer 0", "compressed range", |e| e["byteLength"] = json!(1u64 << 40)),
    ];
    assert!(spoilt(|_| {}).is_ok());
    for (place, reason, change) in faults {
        let error = spoilt(|json| {
            change(&mut json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]);
        })
        .unwrap_err();
        assert!(error.starts_with(&format!("{place}: ")) && error.contains(reason), "{error}");
        assert!(!error.contains('\n'), "{error}");
    }
}

#[test]
fn views_that_unfold_the_same_bytes_again_and_again_are_refused() {
    let error = spoilt(|json| {
        let stream = encode_attributes(&[0; 48], 12).len();
        assert!(stream < 100);
        let view = json["bufferViews"][0].clone();
        let views = std::iter::repeat_n(view, 100_000);
        json["bufferViews"].as_array_mut().unwrap().extend(views);
    });
    assert!(error.unwrap_err().contains("far more than the file has data for"));
}
