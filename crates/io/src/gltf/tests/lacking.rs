//! Primitives that lack what others of their mesh have, and values that are not finite.

use meshlod_mesh::LayerKind;
use serde_json::{Value, json};

use super::{json_of, read_parts, round_trip, square};
use crate::gltf::write_glb;
use crate::{Format, ReadOptions, Scene, read_bytes};

/// Adds an accessor of four vectors of floats to the square, and returns its index.
fn add(json: &mut Value, buffer: &mut Vec<u8>, shape: &str, values: &[f32]) -> usize {
    let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
    let [views, accessors] =
        ["bufferViews", "accessors"].map(|key| json[key].as_array().unwrap().len());
    let view = json!({ "buffer": 0, "byteOffset": buffer.len(), "byteLength": bytes.len() });
    let accessor = json!({ "bufferView": views, "componentType": 5126, "count": 4, "type": shape });
    for (key, entry) in [("bufferViews", view), ("accessors", accessor)] {
        json[key].as_array_mut().unwrap().push(entry);
    }
    buffer.extend(bytes);
    json["buffers"][0]["byteLength"] = buffer.len().into();
    accessors
}

/// Returns the values of a layer at the corners of a face.
fn at_face(scene: &Scene, kind: LayerKind, face: usize) -> Vec<f32> {
    let attributes = scene.meshes[0].mesh.attributes.as_ref().unwrap();
    let layer = attributes.layer(kind).unwrap();
    attributes.corners[face].iter().flat_map(|&wedge| layer.of(wedge)).copied().collect()
}

#[test]
fn primitives_without_colours_are_white() {
    for is_first in [true, false] {
        let (mut json, mut buffer) = square();
        let red = add(&mut json, &mut buffer, "VEC4", &[1.0, 0.0, 0.0, 1.0].repeat(4));
        let plain = json["meshes"][0]["primitives"][0].clone();
        let mut colored = plain.clone();
        colored["attributes"]["COLOR_0"] = red.into();
        json["meshes"][0]["primitives"] =
            if is_first { json!([plain, colored]) } else { json!([colored, plain]) };
        let scene = read_parts(&json, &buffer).unwrap();
        let (plain, colored) = if is_first { (0, 2) } else { (2, 0) };
        assert_eq!(at_face(&scene, LayerKind::Color(0), plain), [1.0; 12]);
        assert_eq!(at_face(&scene, LayerKind::Color(0), colored), [1.0, 0.0, 0.0, 1.0].repeat(3));
    }
}

#[test]
fn attributes_that_are_not_finite_are_replaced_also_in_files_written_again() {
    let (mut json, mut buffer) = square();
    let mut uvs = [0.5f32; 8];
    uvs[3] = f32::NAN;
    let mut normals = [0.0f32, 0.0, 1.0].repeat(4);
    normals[1] = f32::INFINITY;
    let uvs = add(&mut json, &mut buffer, "VEC2", &uvs);
    let normals = add(&mut json, &mut buffer, "VEC3", &normals);
    let attributes = &mut json["meshes"][0]["primitives"][0]["attributes"];
    attributes["TEXCOORD_0"] = uvs.into();
    attributes["NORMAL"] = normals.into();
    let glb = super::container::join(json.to_string().as_bytes(), &buffer).unwrap();
    let scene = read_bytes(&glb, Format::Glb, &mut |_| None, &ReadOptions::default()).unwrap();
    let notes: Vec<String> = scene.notes.iter().map(|note| note.to_string()).collect();
    assert_eq!(
        notes,
        [
            "1 value of an attribute that is not finite read as 0",
            "1 normal without a length computed from the faces around it",
        ]
    );
    assert_eq!(at_face(&scene, LayerKind::Normal, 0), [0.0, 0.0, 1.0].repeat(3));
    let back = round_trip(&scene);
    assert!(back.notes.is_empty(), "what is written is finite");
    assert_eq!(back.meshes[0].mesh.faces.len(), 2);
    // What is finite stays bit for bit.
    let same = read_parts(&square().0, &square().1).unwrap();
    let count = |glb: &[u8]| json_of(glb)["accessors"].as_array().unwrap().len();
    assert_eq!(count(&write_glb(&same, &[]).unwrap()), 2);
}

#[test]
fn positions_that_are_not_finite_are_refused() {
    let (json, mut buffer) = square();
    buffer[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = read_parts(&json, &buffer).unwrap_err().to_string();
    assert!(error.contains("accessor 0: element 0 is not finite"), "{error}");
}
