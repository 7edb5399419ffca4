//! PLY, the usual file format of 3D scans, as text and as binary of either byte order.
//!
//! The elements `vertex`, `face` and `tristrips` are read, in any order and with any scalar types;
//! others are skipped and noted. Polygons are triangulated and strips expanded. Other vertex
//! properties become layers, with one wedge per vertex:
//!
//! | properties | layer |
//! |---|---|
//! | `nx ny nz` | normal |
//! | `s t`, `u v`, `texture_u texture_v`, `texture_s texture_t` | uv 0; `s1 t1` … further sets |
//! | `red green blue`, with `alpha` if present | colour 0; `red1` … further sets |
//! | `diffuse_red` …, `r g b` | colour 0, in files without `red` |
//! | `tx ty tz tw` | tangent |
//! | `joint0_0` … `joint0_3`, `weight0_0` … `weight0_3` | joints, weights 0, and so on |
//! | consecutive `name_0 name_1` … | another layer `name` of that width |
//! | any other scalar | another layer of its name, 1 wide |
//! | an integer `label`, `class`, `instance_id` and the like | a layer of labels, never averaged |
//!
//! Integer colours are divided by the maximum of their type. Properties of faces are:
//!
//! | property | becomes |
//! |---|---|
//! | list `texcoord` of u v for each corner | uv 0, with wedges of their own at seams |
//! | `texnumber`, with lines `comment TextureFile` | materials, one for each texture |
//! | `red green blue`, with `alpha` if present | colour 0, unless vertices have colours |
//! | an integer `label`, `segment`, `class`, `object_id` and the like | objects, as `label 3` |
//! | any other scalar | a layer of faces of its name |
//!
//! Face colours keep their borders if there are at most 256; more of them are averaged at vertices.
//! Comments, lines `obj_info` and the types of properties are kept for [`write_scene`]. Written
//! files read back by the same tables.
//!
//! Reading order: `header`; `body` with `text_body`, `binary_body` and the fast path `bulk`;
//! `vertices` with `layers`; `faces` with `face_values` and `face_scalars`; `assemble`, which makes
//! the scene. Writing: `plan`, then `write` with `face_encoder`. Programs that do not hold a file in
//! memory find its vertices and faces by [`stream_layout`].
//!
//! The parser is our own: the crate `ply-rs-bw` 4.0 reads the 871,414 faces of the Stanford dragon
//! in 32 ms with an allocation for each, `serde-ply` 0.2 in 64 ms, and neither reports the byte or
//! line of an error. This one takes 4 ms (one core of a virtual machine, best of 25).

mod assemble;
mod binary_body;
mod body;
mod bulk;
mod extras;
mod face_encoder;
mod face_rows;
mod face_scalars;
#[cfg(test)]
mod face_tests;
mod face_values;
mod faces;
mod header;
mod layers;
mod plan;
mod scalar;
mod stream;
mod stream_writer;
#[cfg(test)]
mod tests;
mod text_body;
mod vertices;
mod write;

use meshlod_mesh::Mesh;

use crate::error::ParseError;
use crate::grouped;
use crate::options::Resolve;
use crate::scene::Scene;
use assemble::Body;
use binary_body::BinaryBody;
use body::BodyReader;
use faces::Faces;
use header::{Element, Encoding, Header};
use text_body::TextBody;
use vertices::Vertices;

pub use extras::PlyExtras;
pub use face_rows::{FaceRows, RowFault, RowLayout};
pub(crate) use plan::limits;
pub use stream::{StreamLayout, VertexRows, stream_layout};
pub use stream_writer::{StreamShape, StreamWriter};
pub(crate) use write::write_named;
pub use write::{write, write_scene};

/// Parses a PLY file, text or binary, without its textures: see [`read_scene`].
///
/// # Errors
/// Those of [`read_scene`].
pub fn read(bytes: &[u8]) -> Result<Mesh, ParseError> {
    Ok(read_scene(bytes, &mut |_| None)?.meshes.swap_remove(0).mesh)
}

/// Parses a PLY file, text or binary, as one mesh under one node; `resolve` loads the textures.
///
/// Attributes are `None` if vertices and faces have none. Faces with fewer than three corners
/// are dropped, with a note, as are the degenerate triangles that join parts of a strip; a face
/// that repeats a vertex is kept. Numbers in text are rounded to the type that the header declares,
/// so that both encodings of a mesh read the same. What is skipped is in the notes of the scene.
/// Memory: at most a small multiple of `bytes`, whatever the header claims, beside the textures.
/// # Errors
/// Anything that is not a mesh of at least one face, with the line of text or byte of binary data.
pub fn read_scene(bytes: &[u8], resolve: Resolve<'_>) -> Result<Scene, ParseError> {
    let header = Header::parse(bytes)?;
    check_elements(&header)?;
    let body = match header.encoding {
        Encoding::Text => read_body(&header, TextBody::new(bytes, &header)),
        Encoding::LittleEndian => read_body(&header, BinaryBody::<false>::new(bytes, &header)),
        Encoding::BigEndian => read_body(&header, BinaryBody::<true>::new(bytes, &header)),
    }?;
    Ok(assemble::scene(header, body, resolve))
}

/// Checks that the header declares the elements that a mesh needs.
fn check_elements(header: &Header) -> Result<(), ParseError> {
    let wrong = |reason: &str| Err(ParseError::part("header", reason));
    let Some(vertex) = header.elements.iter().find(|element| element.name == "vertex") else {
        return wrong("the file declares no element vertex");
    };
    if header.elements.iter().any(Element::holds_faces) {
        return Ok(());
    }
    if vertex.face_list().is_some() {
        return wrong(
            "no faces: the list vertex_indices belongs to the element vertex; \
             a line \"element face\" with the number of faces is missing before it",
        );
    }
    wrong(&format!("no faces: the file is {}", points(vertex)))
}

/// Returns what a file of points is, with a way to a surface.
fn points(vertex: &Element) -> String {
    let has = |name: &str| vertex.properties.iter().any(|property| property.name == name);
    if ["f_dc_0", "scale_0", "rot_0"].iter().all(|name| has(name)) {
        return "a set of Gaussian splats, which have no surface; extract a mesh where they were \
                trained"
            .to_owned();
    }
    let count = grouped(vertex.count as usize);
    format!("a cloud of {count} points; reconstruct a surface first, as MeshLab does")
}

/// Reads the elements in order. Faces that precede the vertices are read again once those are
/// known.
fn read_body<B: BodyReader>(header: &Header, mut body: B) -> Result<Body, ParseError> {
    let mut vertices: Option<Vertices> = None;
    let mut faces = Faces::default();
    let mut waiting: Vec<(B, &Element)> = Vec::new();
    for element in &header.elements {
        if element.name == "vertex" {
            vertices = Some(vertices::read(&mut body, element)?);
        } else if !element.holds_faces() {
            body.skip(element)?;
        } else if let Some(vertices) = &vertices {
            faces.read(&mut body, element, &vertices.positions)?;
        } else {
            waiting.push((body.clone(), element));
            body.skip(element)?;
        }
    }
    let vertices = vertices.unwrap_or_default();
    let bytes_left = body.bytes_left();
    for (mut body, element) in waiting {
        faces.read(&mut body, element, &vertices.positions)?;
    }
    if faces.triangles.is_empty() {
        return Err(ParseError::part("header", "no faces: no face has three corners"));
    }
    if u32::try_from(faces.triangles.len()).is_err() {
        return Err(ParseError::part(
            "header",
            "more than 4,294,967,295 triangles are not supported",
        ));
    }
    let Faces { triangles, values, thin: thin_faces, .. } = faces;
    Ok(Body { vertices, faces: triangles, values, thin_faces, bytes_left })
}
