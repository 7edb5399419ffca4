//! Writing binary little-endian PLY files: vertices with their attributes, then triangles.

use std::io::{Error, ErrorKind, Result, Write};

use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh};

use super::layers;
use crate::Precision;

/// Bytes buffered before they are written.
const BLOCK: usize = 1 << 16;

/// Writes a mesh as a binary little-endian PLY file, without its material and object labels.
///
/// Coordinates are `float` or `double` as `precision` says, colours `uchar`, other layers `float`,
/// under the names in the [module's table](super). PLY has values at vertices only: unless wedges
/// and vertices correspond one to one, every wedge in use becomes a vertex of its own, which splits
/// seams and drops unused vertices.
/// # Errors
/// Errors of `out`. Before anything is written: a mesh that breaks [`Mesh::validate`], and a
/// coordinate that is not finite as a `float`.
pub fn write(mesh: &Mesh, precision: Precision, out: &mut dyn Write) -> Result<()> {
    mesh.validate().map_err(invalid)?;
    if precision == Precision::F32 {
        check_fits_f32(mesh)?;
    }
    let rows = Rows::of(mesh)?;
    let layers = mesh.attributes.as_ref().map_or(&[][..], |attributes| &attributes.layers);
    let columns: Vec<_> = layers.iter().map(LayerEncoder::of).collect();
    out.write_all(header(mesh.faces.len(), precision, rows.len(mesh), layers).as_bytes())?;

    let mut block = Vec::with_capacity(BLOCK + BLOCK / 4);
    for row in 0..rows.len(mesh) {
        let (vertex, wedge) = rows.at(row);
        append_position(mesh.positions[vertex], precision, &mut block);
        columns.iter().for_each(|column| column.append(wedge, &mut block));
        flush_if_full(&mut block, out)?;
    }
    for face in 0..mesh.faces.len() {
        block.push(3);
        for index in rows.face(mesh, face) {
            block.extend_from_slice(&index.to_le_bytes());
        }
        flush_if_full(&mut block, out)?;
    }
    out.write_all(&block)
}

/// Vertex rows of the file.
enum Rows {
    /// Vertices of the mesh, each with the wedge of equal index.
    Vertices,
    /// Wedges in use, each with its vertex, and the faces over them.
    Wedges { rows: Vec<(u32, u32)>, faces: Vec<[u32; 3]> },
}

impl Rows {
    fn of(mesh: &Mesh) -> Result<Self> {
        match &mesh.attributes {
            Some(attributes)
                if !attributes.layers.is_empty() && !is_one_to_one(mesh, attributes) =>
            {
                Ok(Self::of_wedges(mesh, attributes))
            }
            _ => Ok(Self::Vertices),
        }
    }

    /// Numbers the wedges in use, in order.
    fn of_wedges(mesh: &Mesh, attributes: &Attributes) -> Self {
        let mut owner = vec![None; attributes.wedge_count];
        for (face, corners) in mesh.faces.iter().zip(&attributes.corners) {
            for (&v, &w) in face.iter().zip(corners) {
                owner[w.index()] = Some(v);
            }
        }
        let mut rows = Vec::new();
        let mut row_of = vec![0; owner.len()];
        for (wedge, owner) in owner.iter().enumerate() {
            if let Some(vertex) = owner {
                row_of[wedge] = rows.len() as u32;
                rows.push((vertex.0, wedge as u32));
            }
        }
        let faces = attributes.corners.iter().map(|face| face.map(|w| row_of[w.index()]));
        Self::Wedges { rows, faces: faces.collect() }
    }

    fn len(&self, mesh: &Mesh) -> usize {
        match self {
            Self::Vertices => mesh.positions.len(),
            Self::Wedges { rows, .. } => rows.len(),
        }
    }

    /// Returns the vertex and the wedge of a row.
    fn at(&self, row: usize) -> (usize, usize) {
        match self {
            Self::Vertices => (row, row),
            Self::Wedges { rows, .. } => (rows[row].0 as usize, rows[row].1 as usize),
        }
    }

    fn face(&self, mesh: &Mesh, face: usize) -> [u32; 3] {
        match self {
            Self::Vertices => mesh.faces[face].map(|v| v.0),
            Self::Wedges { faces, .. } => faces[face],
        }
    }
}

fn is_one_to_one(mesh: &Mesh, attributes: &Attributes) -> bool {
    attributes.wedge_count == mesh.positions.len()
        && mesh
            .faces
            .iter()
            .flatten()
            .zip(attributes.corners.iter().flatten())
            .all(|(v, w)| v.0 == w.0)
}

fn header(faces: usize, precision: Precision, vertices: usize, layers: &[Layer]) -> String {
    let mut lines = vec!["ply".to_owned(), "format binary_little_endian 1.0".to_owned()];
    lines.push(format!("element vertex {vertices}"));
    let coordinate = match precision {
        Precision::F32 => "float",
        Precision::F64 => "double",
    };
    lines.extend(["x", "y", "z"].map(|name| format!("property {coordinate} {name}")));
    for (layer, names) in layers.iter().zip(layers::names(layers)) {
        let kind = if is_bytes(layer) { "uchar" } else { "float" };
        lines.extend(names.iter().map(|name| format!("property {kind} {name}")));
    }
    lines.push(format!("element face {faces}"));
    let index = if i32::try_from(vertices).is_ok() { "int" } else { "uint" };
    lines.push(format!("property list uchar {index} vertex_indices"));
    lines.push("end_header\n".to_owned());
    lines.join("\n")
}

/// Reports whether a layer is written as bytes, as is customary for colours.
fn is_bytes(layer: &Layer) -> bool {
    matches!((layer.kind, layer.width), (LayerKind::Color(_), 3 | 4))
}

/// Encoder for the values of a layer.
struct LayerEncoder<'a> {
    layer: &'a Layer,
    bytes: bool,
}

impl<'a> LayerEncoder<'a> {
    fn of(layer: &'a Layer) -> Self {
        Self { layer, bytes: is_bytes(layer) }
    }

    fn append(&self, wedge: usize, block: &mut Vec<u8>) {
        let values = &self.layer.values[wedge * self.layer.width..][..self.layer.width];
        for &value in values {
            if self.bytes {
                block.push((value.clamp(0.0, 1.0) * 255.0).round() as u8);
            } else {
                block.extend_from_slice(&value.to_le_bytes());
            }
        }
    }
}

fn append_position(position: [f64; 3], precision: Precision, block: &mut Vec<u8>) {
    for x in position {
        match precision {
            Precision::F32 => block.extend_from_slice(&(x as f32).to_le_bytes()),
            Precision::F64 => block.extend_from_slice(&x.to_le_bytes()),
        }
    }
}

fn flush_if_full(block: &mut Vec<u8>, out: &mut dyn Write) -> Result<()> {
    if block.len() >= BLOCK {
        out.write_all(block)?;
        block.clear();
    }
    Ok(())
}

/// Checks that every coordinate fits in `f32`; larger ones would silently become infinite.
fn check_fits_f32(mesh: &Mesh) -> Result<()> {
    let large = |position: &[f64; 3]| position.iter().any(|&x| !(x as f32).is_finite());
    match mesh.positions.iter().position(large) {
        None => Ok(()),
        Some(vertex) => Err(invalid(format!(
            "vertex {vertex} at {:?} does not fit in 32-bit floats; write with 64 bits",
            mesh.positions[vertex]
        ))),
    }
}

fn invalid(reason: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Error {
    Error::new(ErrorKind::InvalidInput, reason)
}
