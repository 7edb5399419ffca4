//! Places of vertices and faces in a binary file, for programs that do not hold it in memory.

use meshlod_mesh::{Layer, LayerKind};

use super::check_elements;
use super::face_rows::FaceRows;
use super::face_values::{colors_of, is_label};
use super::header::{Element, Encoding, Header, Shape};
use super::layers::{self, LayerColumns};
use super::scalar::Scalar;
use super::vertices::{coordinates, make_finite};
use crate::error::ParseError;
use crate::scene::normals::unit;

/// Places of the vertices and faces in a binary file.
#[derive(Clone, Debug)]
pub struct StreamLayout {
    /// Rows of the vertices.
    pub vertices: VertexRows,
    /// Rows of the faces.
    pub faces: FaceRows,
    /// Properties of faces that [`read`](super::read) has a use for and streams do not.
    pub left_out: Vec<String>,
}

/// Rows of vertices, all of one size.
#[derive(Clone, Debug)]
pub struct VertexRows {
    /// Byte of the file that the first row begins at.
    pub start: u64,
    /// Number of rows.
    pub count: u64,
    /// Size of a row, in bytes.
    pub size: usize,
    is_big: bool,
    /// Place in the row and type of each property.
    fields: Vec<(usize, Scalar)>,
    xyz: [usize; 3],
    layers: Vec<LayerColumns>,
}

/// Returns the places of vertices and faces in a file of a length in bytes, by its first bytes,
/// which hold the whole header; `None` for a file that can only be read as a whole: text, textures,
/// strips, and vertices behind faces or with lists.
///
/// The rows of vertices are inside the file.
/// # Errors
/// A header that is not one of a mesh, and a file that ends inside the vertices.
pub fn stream_layout(head: &[u8], length: u64) -> Result<Option<StreamLayout>, ParseError> {
    let header = Header::parse(head)?;
    check_elements(&header)?;
    let is_big = header.encoding == Encoding::BigEndian;
    let of_faces: Vec<&Element> = header.elements.iter().filter(|of| of.holds_faces()).collect();
    let is_plain = header.encoding != Encoding::Text && header.textures.is_empty();
    let ([element], true) = (&of_faces[..], is_plain) else { return Ok(None) };
    if element.name != "face" {
        return Ok(None);
    }
    let mut at = header.body as u64;
    let mut vertices = None;
    for before in header.elements.iter().take_while(|before| before.name != "face") {
        if !before.is_fixed() {
            return Ok(None);
        }
        if before.name == "vertex" {
            vertices = Some(VertexRows::new(before, at, is_big)?);
        }
        let size = before.least_row_size() as u64;
        let end = before.count.checked_mul(size).and_then(|size| at.checked_add(size));
        at = end.filter(|&end| end <= length).ok_or_else(|| ended(before, at, length))?;
    }
    let Some(vertices) = vertices else { return Ok(None) };
    let faces = FaceRows::new(element, at, is_big)?;
    let left_out = left_out(element, &vertices);
    Ok(Some(StreamLayout { vertices, faces, left_out }))
}

/// Creates the error for a file that ends inside the rows of an element.
fn ended(element: &Element, start: u64, length: u64) -> ParseError {
    let row = length.saturating_sub(start) / element.least_row_size().max(1) as u64;
    let place = usize::try_from(length).unwrap_or(usize::MAX);
    let (name, count) = (super::header::shown(&element.name), element.count);
    ParseError::byte(place, format!("the file ends inside {name} {row} of {count}"))
}

/// Names the properties of faces that would be texture coordinates, colours or objects.
fn left_out(element: &Element, vertices: &VertexRows) -> Vec<String> {
    let has_colors = vertices.layers.iter().any(|layer| layer.kind == LayerKind::Color(0));
    let colors = if has_colors { Vec::new() } else { colors_of(&element.properties) };
    let is_used = |(at, name): (usize, &str)| match element.properties[at].shape {
        Shape::One(kind) => {
            colors.contains(&Some(at)) || (is_label(name) && kind.whole_range().is_some())
        }
        Shape::List { .. } => matches!(name, "texcoord" | "texcoords"),
    };
    let names = element.properties.iter().map(|property| property.name.as_str()).enumerate();
    names.filter(|&named| is_used(named)).map(|(_, name)| name.to_owned()).collect()
}

impl VertexRows {
    fn new(element: &Element, start: u64, is_big: bool) -> Result<Self, ParseError> {
        let mut size = 0;
        let mut fields = Vec::with_capacity(element.properties.len());
        for property in &element.properties {
            let (Shape::One(kind) | Shape::List { length: kind, .. }) = property.shape;
            fields.push((size, kind));
            size += property.shape.least_size();
        }
        let xyz = coordinates(element)?;
        let layers = layers::columns(&element.properties);
        Ok(Self { start, count: element.count, size, is_big, fields, xyz, layers })
    }

    /// Drops the layers that are not to be read.
    pub fn keep_layers(&mut self, keep: impl Fn(&Layer) -> bool) {
        self.layers.retain(|layer| keep(&layer.layer(0)));
    }

    /// Returns the layers, without values.
    pub fn layers(&self) -> Vec<Layer> {
        self.layers.iter().map(|layer| layer.layer(0)).collect()
    }

    /// Reads whole rows, of which `first` is the first one: a place each, and the values of all
    /// layers, one row after the other. Values that are not finite become 0, and normals have unit
    /// length or none.
    ///
    /// # Errors
    /// A coordinate that is not finite.
    pub fn read(
        &self,
        first: u64,
        rows: &[u8],
        places: &mut Vec<[f64; 3]>,
        values: &mut Vec<f32>,
    ) -> Result<(), ParseError> {
        let count = rows.len() / self.size;
        let before = places.len();
        places.resize(before + count, [0.0; 3]);
        for (axis, &property) in self.xyz.iter().enumerate() {
            self.column(property, rows, |row, x| places[before + row][axis] = x);
        }
        let odd = places[before..].iter().position(|place| !place.iter().all(|x| x.is_finite()));
        if let Some(row) = odd {
            return Err(self.not_finite(first + row as u64, places[before + row]));
        }
        self.read_layers(rows, count, values);
        Ok(())
    }

    fn read_layers(&self, rows: &[u8], count: usize, values: &mut Vec<f32>) {
        let width: usize = self.layers.iter().map(|layer| layer.columns.len()).sum();
        if width == 0 {
            return;
        }
        let before = values.len();
        values.resize(before + count * width, 0.0);
        let own = &mut values[before..];
        let mut at = 0;
        for layer in &self.layers {
            for (i, column) in layer.columns.iter().enumerate() {
                let put = |row: usize, x: f64| own[row * width + at + i] = (x / column.unit) as f32;
                self.column(column.property, rows, put);
            }
            for row in own.chunks_exact_mut(width) {
                make_usable(layer.kind, &mut row[at..at + layer.columns.len()]);
            }
            at += layer.columns.len();
        }
    }

    /// Hands on the numbers of a property, with the number of the row that each is in.
    fn column(&self, property: usize, rows: &[u8], put: impl FnMut(usize, f64)) {
        let (at, kind) = self.fields[property];
        kind.column(self.is_big, rows.chunks_exact(self.size).map(|row| &row[at..]), put);
    }

    fn not_finite(&self, vertex: u64, place: [f64; 3]) -> ParseError {
        let byte = self.start + vertex * self.size as u64;
        let reason = format!("vertex {vertex} has a coordinate that is not finite: {place:?}");
        ParseError::byte(byte as usize, reason)
    }
}

/// Makes the values of a row finite, and a normal a unit vector.
fn make_usable(kind: LayerKind, values: &mut [f32]) {
    make_finite(kind, values);
    if kind == LayerKind::Normal
        && let [x, y, z] = values[..]
    {
        values.copy_from_slice(&unit([x, y, z]).unwrap_or_default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(header: &str, length: u64) -> Result<Option<StreamLayout>, String> {
        let text = format!("ply\nformat binary_little_endian 1.0\n{header}end_header\n");
        stream_layout(text.as_bytes(), length).map_err(|error| error.to_string())
    }

    const POINT: &str = "property float x\nproperty float y\nproperty float z\n";
    const FACES: &str = "element face 1\nproperty list uchar int vertex_indices\n";

    #[test]
    fn rows_are_found_behind_others() {
        let header = format!(
            "element camera 2\nproperty double f\nelement vertex 3\nproperty uchar flag\n{POINT}{FACES}"
        );
        let found = layout(&header, 1000).unwrap().unwrap();
        let head = "ply\nformat binary_little_endian 1.0\nend_header\n".len() + header.len();
        assert_eq!((found.vertices.start, found.vertices.size), (head as u64 + 16, 13));
        assert_eq!(found.faces.start, head as u64 + 16 + 39);
    }

    #[test]
    fn counts_beyond_the_file_are_errors() {
        for count in ["4", "1000000000", "18446744073709551615"] {
            let header = format!("element vertex {count}\n{POINT}{FACES}");
            let error = layout(&header, 180).unwrap_err();
            assert!(error.starts_with("byte 180: the file ends inside vertex"), "{error}");
        }
    }

    #[test]
    fn other_files_are_read_as_a_whole() {
        let vertices = format!("element vertex 1\n{POINT}");
        let strips = FACES.replace("face", "tristrips");
        let cases = [
            format!("comment TextureFile a.png\n{vertices}{FACES}"),
            format!("{vertices}{strips}"),
            format!("{FACES}{vertices}"),
            format!("{vertices}property list uchar int near\n{FACES}"),
        ];
        for header in cases {
            assert!(layout(&header, 1000).unwrap().is_none(), "{header}");
        }
    }

    #[test]
    fn what_scenes_would_keep_is_named() {
        let faces = format!(
            "{FACES}property uchar red\nproperty uchar green\nproperty uchar blue\n\
             property int label\nproperty float quality\nproperty list uchar float texcoord\n"
        );
        let named = |vertex: &str| {
            layout(&format!("element vertex 1\n{POINT}{vertex}{faces}"), 1000)
                .unwrap()
                .unwrap()
                .left_out
        };
        assert_eq!(named(""), ["red", "green", "blue", "label", "texcoord"]);
        let colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
        assert_eq!(named(colors), ["label", "texcoord"]);
    }
}
