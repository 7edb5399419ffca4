//! glTF files of a mesh split into parts with 8-bit positions; each part has a node that scales it
//! back to model space.

use serde_json::{Value, json};

use crate::error::Unsupported;
use crate::gltf::document::{component, container};

/// Part of a mesh with 8-bit positions on its own grid of 256 cells per axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QuantizedPart {
    /// Rows of the 3×4 matrix that maps grid cells to model space.
    ///
    /// As glTF requires of nodes, it is made of scale, rotation and translation, without shear.
    pub matrix: [[f32; 4]; 3],
    /// Grid cell of each vertex, as an index per axis.
    pub positions: Vec<[u8; 3]>,
    /// Triangles, as indices into `positions`.
    pub faces: Vec<[u32; 3]>,
}

/// Writes mesh parts as a GLB file with `KHR_mesh_quantization`, each as a node and a mesh with one
/// primitive.
///
/// A position takes four bytes; an index takes two, or four if a part has more than 65535 vertices.
/// Parts without faces are left out. The matrices are applied in 32 bits, so vertices of two parts
/// coincide only if their matrices give the same bits.
///
/// # Errors
/// If a matrix is not finite or a face refers to a vertex that does not exist; above 4 GB.
/// # References
/// [Kap20]
pub fn write_parts_glb(parts: &[QuantizedPart]) -> Result<Vec<u8>, Unsupported> {
    parts.iter().enumerate().try_for_each(|(i, part)| check(i, part))?;
    let shown: Vec<&QuantizedPart> = parts.iter().filter(|part| !part.faces.is_empty()).collect();
    let mut buffer: Vec<u8> = (shown.iter().flat_map(|part| &part.positions))
        .flat_map(|&[x, y, z]| [x, y, z, 0])
        .collect();
    let positions = buffer.len();
    let (component, size) = index_type(&shown);
    for part in &shown {
        let indices = part.faces.as_flattened().iter();
        buffer.extend(indices.flat_map(|index| index.to_le_bytes().into_iter().take(size)));
    }
    let json = if shown.is_empty() {
        json!({ "asset": asset(), "scene": 0, "scenes": [{}] })
    } else {
        json!({
            "asset": asset(),
            "extensionsUsed": ["KHR_mesh_quantization"],
            "extensionsRequired": ["KHR_mesh_quantization"],
            "scene": 0,
            "scenes": [{ "nodes": (0..shown.len()).collect::<Vec<_>>() }],
            "nodes": shown.iter().enumerate().map(node).collect::<Vec<_>>(),
            "meshes": (0..shown.len()).map(mesh).collect::<Vec<_>>(),
            "accessors": accessors(&shown, component, size),
            "bufferViews": [
                { "buffer": 0, "byteLength": positions, "byteStride": 4, "target": 34962 },
                { "buffer": 0, "byteOffset": positions, "byteLength": buffer.len() - positions,
                  "target": 34963 },
            ],
            "buffers": [{ "byteLength": buffer.len() }],
        })
    };
    container::join(json.to_string().as_bytes(), &buffer)
}

fn asset() -> Value {
    json!({ "version": "2.0", "generator": concat!("meshlod ", env!("CARGO_PKG_VERSION")) })
}

fn check(index: usize, part: &QuantizedPart) -> Result<(), Unsupported> {
    let wrong = |reason| Err(Unsupported::new(format!("part {index}"), reason));
    if !part.matrix.as_flattened().iter().all(|x| x.is_finite()) {
        return wrong("its matrix is not finite".to_owned());
    }
    let count = part.positions.len();
    match part.faces.iter().flatten().find(|&&v| v as usize >= count) {
        Some(vertex) => {
            wrong(format!("a face refers to vertex {vertex}, but there are only {count}"))
        }
        None => Ok(()),
    }
}

/// Returns the smallest usable index type; the largest value of a type is reserved for restart.
fn index_type(parts: &[&QuantizedPart]) -> (u32, usize) {
    // One byte would do for small parts, but modern GPU APIs have no 8-bit indices.
    match parts.iter().map(|part| part.positions.len()).max().unwrap_or(0) {
        ..=65535 => (component::U16, 2),
        _ => (component::U32, 4),
    }
}

fn node((index, part): (usize, &&QuantizedPart)) -> Value {
    let [x, y, z] = part.matrix;
    let column = |k: usize, last: f32| [x[k], y[k], z[k], last];
    let columns = [column(0, 0.0), column(1, 0.0), column(2, 0.0), column(3, 1.0)];
    json!({ "mesh": index, "matrix": columns.as_flattened() })
}

fn mesh(index: usize) -> Value {
    let primitive = json!({ "attributes": { "POSITION": 2 * index }, "indices": 2 * index + 1 });
    json!({ "primitives": [primitive] })
}

/// Builds the accessors: positions and indices of each part in turn.
fn accessors(parts: &[&QuantizedPart], component: u32, size: usize) -> Vec<Value> {
    let (mut vertices, mut indices) = (0, 0);
    let mut accessors = Vec::with_capacity(2 * parts.len());
    for part in parts {
        let least = |axis: usize| part.positions.iter().map(|p| p[axis]).min().unwrap_or(0);
        let most = |axis: usize| part.positions.iter().map(|p| p[axis]).max().unwrap_or(0);
        accessors.push(json!({
            "bufferView": 0, "byteOffset": 4 * vertices, "componentType": component::U8,
            "count": part.positions.len(), "type": "VEC3",
            "min": [least(0), least(1), least(2)], "max": [most(0), most(1), most(2)],
        }));
        accessors.push(json!({
            "bufferView": 1, "byteOffset": size * indices, "componentType": component,
            "count": 3 * part.faces.len(), "type": "SCALAR",
        }));
        vertices += part.positions.len();
        indices += 3 * part.faces.len();
    }
    accessors
}
