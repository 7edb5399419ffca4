//! Writing binary little-endian PLY files: vertices and faces with their attributes.

use std::io::{Error, ErrorKind, Result, Write};

use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, WedgeId};

use super::extras::PlyExtras;
use super::face_encoder::FaceEncoder;
use super::layers;
use super::plan::{Plan, is_color};
use super::scalar::Scalar;
use crate::obj::mtl::one_line;
use crate::precision::{Precision, Width};
use crate::scene::{Image, Scene};
use crate::vertex_attributes::{SplitMesh, SplitVertex, split_at_seams_of};

/// Bytes buffered before they are written.
pub(super) const BLOCK: usize = 1 << 16;

/// Writes a mesh as a binary little-endian PLY file, without its materials.
///
/// Coordinates are `float` or `double` by `precision`, colours `uchar`, other layers `float`, under
/// the names in the [module's tables](super). Texture coordinates with seams are written as lists
/// at faces, and colours with seams as properties of faces if each face has one colour. Seams of
/// other layers split vertices: each vertex comes first with its first wedge, the others follow.
/// # Errors
/// Errors of `out`. Before anything is written: a mesh that breaks [`Mesh::validate`], and a
/// coordinate that is not finite as a `float`.
pub fn write(mesh: &Mesh, precision: Precision, out: &mut dyn Write) -> Result<()> {
    mesh.validate().map_err(invalid)?;
    write_plan(&Plan::of_mesh(mesh), &PlyExtras::default(), precision, out)
}

/// Writes the shown meshes of a scene in world space like [`write()`], with texture names, the
/// texture and labels of each face, and the extras of a PLY file.
///
/// # Errors
/// Errors of [`write()`].
pub fn write_scene(scene: &Scene, precision: Precision, out: &mut dyn Write) -> Result<()> {
    write_named(scene, &scene.images, precision, out)
}

/// Writes a scene like [`write_scene`], with other names for its images.
pub(crate) fn write_named(
    scene: &Scene,
    images: &[Image],
    precision: Precision,
    out: &mut dyn Write,
) -> Result<()> {
    scene.meshes.iter().try_for_each(|mesh| mesh.mesh.validate()).map_err(invalid)?;
    write_plan(&Plan::of_scene(scene, images), &scene.ply, precision, out)
}

fn write_plan(
    plan: &Plan<'_>,
    extras: &PlyExtras,
    precision: Precision,
    out: &mut dyn Write,
) -> Result<()> {
    let mesh = &*plan.mesh;
    let width = precision.width(mesh);
    if width == Width::F32 {
        check_fits_f32(mesh)?;
    }
    let layers = plan.vertex_layers();
    let rows = Rows::of(mesh, &layers);
    let columns: Vec<LayerEncoder<'_>> = layers
        .iter()
        .zip(layers::names(layers.iter().copied()))
        .map(|(layer, names)| LayerEncoder::new(layer, names, extras, ""))
        .collect();
    let faces = FaceEncoder::new(plan, extras);
    out.write_all(header(plan, extras, width, &rows, &columns, &faces).as_bytes())?;

    let mut block = Vec::with_capacity(BLOCK + BLOCK / 4);
    for row in 0..rows.len(mesh) {
        let (vertex, wedge) = rows.at(row);
        append_position(mesh.positions[vertex], width, &mut block);
        columns.iter().for_each(|column| column.append(wedge, &mut block));
        flush_if_full(&mut block, out)?;
    }
    for face in 0..mesh.faces.len() {
        block.push(3);
        for index in rows.face(mesh, face) {
            block.extend_from_slice(&index.to_le_bytes());
        }
        faces.append(face, &mut block);
        flush_if_full(&mut block, out)?;
    }
    out.write_all(&block)
}

/// Vertex rows of the file.
enum Rows {
    /// Vertices of the mesh, each with the wedge of equal index.
    Vertices,
    /// Vertices, then one for every further set of attributes, and the faces over them.
    Split(SplitMesh),
}

impl Rows {
    fn of(mesh: &Mesh, layers: &[&Layer]) -> Self {
        match &mesh.attributes {
            Some(attributes) if !layers.is_empty() && !is_one_to_one(mesh, attributes) => {
                Self::Split(split_at_seams_of(mesh, layers))
            }
            _ => Self::Vertices,
        }
    }

    fn len(&self, mesh: &Mesh) -> usize {
        match self {
            Self::Vertices => mesh.positions.len(),
            Self::Split(split) => split.vertices.len(),
        }
    }

    /// Returns the vertex of a row, and its wedge unless no face uses it.
    fn at(&self, row: usize) -> (usize, Option<WedgeId>) {
        match self {
            Self::Vertices => (row, Some(WedgeId::new(row))),
            Self::Split(split) => {
                let SplitVertex { vertex, wedge } = split.vertices[row];
                (vertex.index(), wedge)
            }
        }
    }

    fn face(&self, mesh: &Mesh, face: usize) -> [u32; 3] {
        match self {
            Self::Vertices => mesh.faces[face].map(|v| v.0),
            Self::Split(split) => split.faces[face],
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

fn header(
    plan: &Plan<'_>,
    extras: &PlyExtras,
    width: Width,
    rows: &Rows,
    columns: &[LayerEncoder<'_>],
    faces: &FaceEncoder<'_>,
) -> String {
    let remarks = extras.remarks.iter().map(|line| one_line(line, str::trim));
    let textures = plan.textures.iter().map(|name| format!("comment TextureFile {name}"));
    let vertices = rows.len(&plan.mesh) as u64;
    let of_vertex = columns.iter().flat_map(LayerEncoder::properties).collect();
    let of_face = faces.properties().into_iter().collect();
    header_text(
        remarks.chain(textures).collect(),
        width,
        (vertices, of_vertex),
        (plan.mesh.faces.len() as u64, of_face),
    )
}

/// Returns the text of a header: remarks, and the number and properties of vertices and faces,
/// beside their coordinates and indices.
pub(super) fn header_text(
    remarks: Vec<String>,
    width: Width,
    (vertices, of_vertex): (u64, Vec<String>),
    (faces, of_face): (u64, Vec<String>),
) -> String {
    let mut lines = vec!["ply".to_owned(), "format binary_little_endian 1.0".to_owned()];
    lines.extend(remarks);
    lines.push(format!("element vertex {vertices}"));
    let coordinate = match width {
        Width::F32 => "float",
        Width::F64 => "double",
    };
    lines.extend(["x", "y", "z"].map(|name| format!("property {coordinate} {name}")));
    lines.extend(of_vertex);
    lines.push(format!("element face {faces}"));
    let index = if i32::try_from(vertices).is_ok() { "int" } else { "uint" };
    lines.push(format!("property list uchar {index} vertex_indices"));
    lines.extend(of_face);
    lines.push("end_header\n".to_owned());
    lines.join("\n")
}

/// Encoder for the values of a layer.
pub(super) struct LayerEncoder<'a> {
    layer: &'a Layer,
    /// Name, type and factor of each component.
    components: Vec<(String, Scalar, f64)>,
}

impl<'a> LayerEncoder<'a> {
    /// Chooses the types of the properties, which are looked up with `prefix` before their names.
    pub fn new(layer: &'a Layer, names: Vec<String>, extras: &PlyExtras, prefix: &str) -> Self {
        let component = |name: String| {
            let known = |usual| extras.kind(&format!("{prefix}{name}"), usual);
            let (kind, unit) = match layer.kind {
                LayerKind::Color(_) if is_color(layer) => {
                    let kind = known(Scalar::U8);
                    (kind, kind.whole_range().map_or(1.0, |(_, most)| most as f64))
                }
                LayerKind::Other => (known(Scalar::F32), 1.0),
                LayerKind::Label => (known(Scalar::I32), 1.0),
                _ => (Scalar::F32, 1.0),
            };
            (name, kind, unit)
        };
        Self { layer, components: names.into_iter().map(component).collect() }
    }

    pub fn properties(&self) -> impl Iterator<Item = String> {
        self.components.iter().map(|(name, kind, _)| format!("property {} {name}", kind.name()))
    }

    /// Appends the values of a wedge, or zeros.
    pub fn append(&self, wedge: Option<WedgeId>, block: &mut Vec<u8>) {
        for (i, &(_, kind, unit)) in self.components.iter().enumerate() {
            let value = wedge.map_or(0.0, |wedge| f64::from(self.layer.of(wedge)[i]));
            let is_fraction = unit != 1.0;
            kind.append(if is_fraction { value.clamp(0.0, 1.0) * unit } else { value }, block);
        }
    }
}

pub(super) fn append_position(position: [f64; 3], width: Width, block: &mut Vec<u8>) {
    for x in position {
        match width {
            Width::F32 => block.extend_from_slice(&(x as f32).to_le_bytes()),
            Width::F64 => block.extend_from_slice(&x.to_le_bytes()),
        }
    }
}

pub(super) fn flush_if_full(block: &mut Vec<u8>, out: &mut dyn Write) -> Result<()> {
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

pub(super) fn invalid(reason: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Error {
    Error::new(ErrorKind::InvalidInput, reason)
}
