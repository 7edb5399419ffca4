//! Writes triangle strips to files: glTF, or lists of vertices in JSON.

use std::cmp::Reverse;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use meshlod::io::write_file;
use meshlod::mesh::Bounds;
use serde_json::{Value, json};

use super::StrippedLevel;
use crate::failure::Failure;
use crate::files;

/// glTF constants: component types, primitive modes and buffer targets.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const TRIANGLE_STRIP: u32 = 5;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Fails if the triangle strips cannot be written to the output path.
pub(super) fn check(out: &Path, input: &Path) -> Result<(), Failure> {
    if files::is_pipe(out) {
        return Err(Failure::usage("-: strips cannot go to standard output; name a file"));
    }
    if !is_gltf(out) && !has_suffix(out, "json") {
        let name = files::name(out);
        return Err(Failure::usage(format_args!(
            "{name}: a file of strips must end in .gltf or .json"
        )));
    }
    files::check_place(out)?;
    files::check_apart(out, &[input])
}

pub(super) fn write(
    out: &Path,
    positions: &[[f64; 3]],
    levels: &[StrippedLevel],
) -> Result<(), Failure> {
    let json = if is_gltf(out) { gltf(positions, levels) } else { lists(levels) };
    Ok(write_file(out, format!("{json:#}\n").as_bytes())?)
}

fn is_gltf(out: &Path) -> bool {
    has_suffix(out, "gltf")
}

fn has_suffix(path: &Path, suffix: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(suffix))
}

/// Builds JSON lists of the vertices of each strip, numbered as in the input.
fn lists(levels: &[StrippedLevel]) -> Value {
    let strips = |level: &StrippedLevel| {
        let lists = level.strips.iter().map(|strip| strip.iter().map(|v| v.0).collect::<Vec<_>>());
        json!({
            "size": level.size.to_string(),
            "triangles": level.triangles,
            "strips": lists.collect::<Vec<_>>(),
        })
    };
    json!({ "levels": levels.iter().map(strips).collect::<Vec<_>>() })
}

/// Builds a glTF document with an embedded buffer: shared vertices, and each level as a mesh with
/// one primitive. The strips of a level are joined by degenerate triangles, since glTF has no
/// restart.
fn gltf(positions: &[[f64; 3]], levels: &[StrippedLevel]) -> Value {
    let mut drawn: Vec<_> = levels.iter().filter(|level| !level.strips.is_empty()).collect();
    drawn.sort_by_key(|level| Reverse(level.triangles));
    let asset = json!({ "version": "2.0", "generator": "meshlod" });
    if drawn.is_empty() {
        return json!({ "asset": asset, "scene": 0, "scenes": [{}] });
    }
    let mut document = GltfBuffers::default();
    let places: Vec<[f32; 3]> = positions.iter().map(|p| p.map(|x| x as f32)).collect();
    let shown: Vec<_> = places.iter().map(|p| p.map(f64::from)).collect();
    let Bounds { min, max } = Bounds::of(&shown);
    let bytes = places.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let vertices = document.accessor(
        bytes,
        ARRAY_BUFFER,
        json!({
            "componentType": FLOAT, "count": places.len(), "type": "VEC3", "min": min, "max": max,
        }),
    );
    let mut meshes = Vec::new();
    for level in &drawn {
        let stitched = level.strips.stitched();
        let bytes = stitched.iter().flat_map(|v| v.0.to_le_bytes()).collect();
        let indices = document.accessor(
            bytes,
            ELEMENT_ARRAY_BUFFER,
            json!({
                "componentType": UNSIGNED_INT, "count": stitched.len(), "type": "SCALAR",
            }),
        );
        let primitive = json!({
            "attributes": { "POSITION": vertices }, "indices": indices, "mode": TRIANGLE_STRIP,
        });
        meshes.push(json!({ "name": level.size.to_string(), "primitives": [primitive] }));
    }
    let node = |mesh: usize| json!({ "name": format!("strips_LOD{mesh}"), "mesh": mesh });
    let mut nodes: Vec<_> = (0..meshes.len()).map(node).collect();
    let mut json = json!({ "asset": asset, "scene": 0, "scenes": [{ "nodes": [0] }] });
    if nodes.len() > 1 {
        let coarser: Vec<usize> = (1..nodes.len()).collect();
        nodes[0]["extensions"] = json!({ "MSFT_lod": { "ids": coarser } });
        json["extensionsUsed"] = json!(["MSFT_lod"]);
    }
    json["nodes"] = nodes.into();
    json["meshes"] = meshes.into();
    document.finish(json)
}

/// Buffer of a glTF document with its views and accessors.
#[derive(Default)]
struct GltfBuffers {
    buffer: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl GltfBuffers {
    /// Appends an array of four-byte words and returns the index of its accessor.
    fn accessor(&mut self, bytes: Vec<u8>, target: u32, mut accessor: Value) -> usize {
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len(),
            "target": target,
        }));
        self.buffer.extend(bytes);
        accessor["bufferView"] = (self.views.len() - 1).into();
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn finish(self, mut json: Value) -> Value {
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.buffer));
        json["accessors"] = self.accessors.into();
        json["bufferViews"] = self.views.into();
        json["buffers"] = json!([{ "byteLength": self.buffer.len(), "uri": uri }]);
        json
    }
}
