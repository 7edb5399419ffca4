//! Reader and writers together, on documents built here and on the shared meshes.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `shared`, `carried`, `instances` | what stays |
//! | `broken`, `lacking`, `mutated` | bad documents |
//! | `packed`, `draco`, `small`, `posed`, `animated` | compressed ones |
//! | `animations`, `skeleton`, `levels` | poses and levels |

mod animated;
mod animations;
mod broken;
mod carried;
#[cfg(feature = "draco")]
mod draco;
mod instances;
mod lacking;
mod levels;
mod mutated;
mod packed;
mod posed;
mod shared;
mod skeleton;
mod small;

use serde_json::{Value, json};

use crate::gltf::document::container;
use crate::gltf::read;
use crate::gltf::write::write_glb;
use crate::{ParseError, Scene, Weld};

/// Reads bytes that refer to no other file.
fn read_alone(bytes: &[u8]) -> Result<Scene, ParseError> {
    read(bytes, &mut |_| None, Weld::Exact)
}

/// Reads a document built from JSON and a buffer.
fn read_parts(json: &Value, buffer: &[u8]) -> Result<Scene, ParseError> {
    read_alone(&container::join(json.to_string().as_bytes(), buffer).unwrap())
}

/// Writes a scene as GLB, checks that the crate `gltf` accepts it, and reads it again.
fn round_trip(scene: &Scene) -> Scene {
    let glb = write_glb(scene, &[]).unwrap();
    assert_valid(&glb);
    read_alone(&glb).unwrap()
}

/// Checks that another, validating reader accepts a file.
fn assert_valid(bytes: &[u8]) {
    if let Err(error) = gltf::Gltf::from_slice(bytes) {
        let (json, _) = container::split(bytes).unwrap();
        panic!("{error}\n{}", String::from_utf8_lossy(&json[..json.len().min(4000)]));
    }
}

/// Returns the JSON of a GLB.
fn json_of(glb: &[u8]) -> Value {
    serde_json::from_slice(container::split(glb).unwrap().0).unwrap()
}

/// Document of one square of two triangles, and its buffer: the corners
/// (0,0) (1,0) (0,1) (1,1) as floats, then the indices as shorts.
fn square() -> (Value, Vec<u8>) {
    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let mut buffer: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    buffer.extend([0u16, 1, 2, 2, 1, 3].iter().flat_map(|i| i.to_le_bytes()));
    let json = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "square" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
              "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 12 },
        ],
        "buffers": [{ "byteLength": 60 }],
    });
    (json, buffer)
}

#[test]
fn the_largest_scale_of_textures_is_known() {
    let (mut json, buffer) = square();
    let scale =
        |json: &Value| read_parts(json, &buffer).unwrap().source.unwrap().largest_texture_scale();
    assert_eq!(scale(&json), 1.0);
    let texture = |scale: [f64; 2]| json!({ "index": 0, "extensions": { "KHR_texture_transform": { "scale": scale } } });
    json["images"] = json!([{ "uri": "data:image/png;base64,iVBORw0KGgo=" }]);
    json["textures"] = json!([{ "source": 0 }]);
    json["materials"] = json!([
        { "normalTexture": texture([0.5, 3.0]) },
        { "pbrMetallicRoughness": { "baseColorTexture": texture([-200.0, 1.0]) } },
    ]);
    assert_eq!(scale(&json), 200.0);
}
