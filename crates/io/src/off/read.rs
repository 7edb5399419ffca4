//! Reading OFF files.

use meshlod_mesh::{Attributes, LayerKind, Mesh, VertexId};

use super::vertex_format::VertexFormat;
use crate::error::ParseError;
use crate::notes::Note;
use crate::polygon::triangulate;
use crate::scene::Scene;
use crate::text::cursor::TextCursor;
use crate::vertex_attributes::{named_layer, normalize_colors, per_vertex};

/// Parses an OFF file in text form, without its notes: see [`read_scene`].
///
/// # Errors
/// Those of [`read_scene`].
pub fn read(bytes: &[u8]) -> Result<Mesh, ParseError> {
    read_noted(bytes).map(|(mesh, _)| mesh)
}

/// Parses an OFF file in text form, as one mesh under one node.
///
/// The header may be missing or run into the counts without a blank; comments may appear anywhere.
/// Polygons are triangulated; faces of one or two corners and face colours are left out with a
/// note. If the header names no attributes, but all vertices have three or four more numbers, those
/// are colours or unit normals. Vertex colours have three or four components; if any exceeds 1, all
/// are divided by 255. Normals, colours and texture coordinates that are not finite become 0, and
/// are counted.
///
/// Cost: O(n), n = bytes, plus that of triangulating concave polygons.
/// # Errors
/// The line and the reason: counts that exceed the file, an invalid number, a coordinate that is
/// not finite, an index out of range, a face without corners. Also files without faces, binary
/// files, and dimensions other than three.
/// # References
/// [PLM93], section OFF of its manual.
pub fn read_scene(bytes: &[u8]) -> Result<Scene, ParseError> {
    let (mesh, mut notes) = read_noted(bytes)?;
    notes.retain(|note| note.count > 0);
    Ok(Scene { has_split_seams: true, notes, ..Scene::from_mesh("", mesh) })
}

/// Parses a file and notes the faces and face colours that are left out.
fn read_noted(bytes: &[u8]) -> Result<(Mesh, Vec<Note>), ParseError> {
    let mut text = TextCursor::new(bytes)?;
    if !text.more_anywhere() {
        return Err(text.error("the file is empty"));
    }
    let mut layout = header(&mut text)?;
    let [vertices, faces] = counts(&mut text)?;
    if layout.is_plain() {
        layout = VertexFormat::of_lines(&text, vertices, faces)?;
    }
    let mut columns = Columns::default();
    for v in 0..vertices {
        need(&mut text, v, vertices, "vertices")?;
        if v == 0 {
            layout.measure_color(&text)?;
        }
        columns.read(layout, &mut text)?;
    }
    let mut triangles = Vec::with_capacity(faces);
    let mut scratch = Scratch::default();
    for f in 0..faces {
        need(&mut text, f, faces, "faces")?;
        scratch.face(&columns.positions, &mut text, &mut triangles)?;
    }
    if triangles.is_empty() {
        return Err(text.error("the file has no faces of three corners or more"));
    }
    let attributes = columns.attributes(layout, &triangles);
    let notes = vec![
        Note::not_finite(text.not_finite()),
        Note::left_out(scratch.colored, "colour of a face", "colours of faces")
            .remedied("colours of vertices (COFF) stay, and those of faces in .ply"),
        Note::thin_faces(scratch.thin),
    ];
    Ok((Mesh { attributes, ..Mesh::new(columns.positions, triangles) }, notes))
}

/// Reads the header word, if there is one, up to the first count.
fn header(text: &mut TextCursor) -> Result<VertexFormat, ParseError> {
    if text.comes_digit() {
        return if text.take_word(b"4OFF") || text.take_word(b"4nOFF") {
            Err(text.error("only three-dimensional OFF is supported"))
        } else {
            Ok(VertexFormat::default())
        };
    }
    let start = text.clone();
    let has_uv = text.take_word(b"ST");
    // Some programs write NC, with the same order of the values.
    let is_first = text.take(b'N');
    let color_width = if text.take(b'C') { 3 } else { 0 };
    let has_normal = is_first || text.take(b'N');
    if text.comes(b'4') || text.comes(b'n') {
        return Err(text.error("only three-dimensional OFF is supported"));
    }
    if !text.take_word(b"OFF") {
        return Err(start.refuse("an OFF header or a count"));
    }
    if text.more() && text.take_word(b"BINARY") {
        return Err(text.error("binary OFF is not supported; convert the file to text or to PLY"));
    }
    Ok(VertexFormat { has_normal, color_width, has_uv })
}

/// Reads the numbers of vertices and faces; the number of edges is ignored.
fn counts(text: &mut TextCursor) -> Result<[usize; 2], ParseError> {
    const NEED: &str = "the counts of vertices and faces are missing";
    let mut counts = [0; 2];
    for count in &mut counts {
        text.more_anywhere();
        let number = text.integer(NEED)?;
        *count = usize::try_from(number).map_err(|_| text.error("a count is negative"))?;
    }
    let line = text.line();
    text.words_left();
    // A vertex has at least 3 numbers and a face 4, each of at least 2 bytes with its blank.
    let [vertices, faces] = counts;
    if vertices.saturating_mul(6).saturating_add(faces.saturating_mul(8)) > text.left() + 1 {
        let reason = format!(
            "the header declares {vertices} vertices and {faces} faces, but only {} bytes follow",
            text.left()
        );
        return Err(ParseError::line(line, reason));
    }
    if vertices > u32::MAX as usize {
        return Err(ParseError::line(line, "more than 2^32 vertices are not supported"));
    }
    Ok(counts)
}

/// Moves to the next vertex or face.
fn need(text: &mut TextCursor, done: usize, all: usize, what: &str) -> Result<(), ParseError> {
    if text.more_anywhere() {
        return Ok(());
    }
    Err(text.error(format!("the file ends after {done} of {all} {what}")))
}

/// Values of the vertices.
#[derive(Default)]
struct Columns {
    positions: Vec<[f64; 3]>,
    normals: Vec<f32>,
    colors: Vec<f32>,
    uvs: Vec<f32>,
}

impl Columns {
    fn read(&mut self, layout: VertexFormat, text: &mut TextCursor) -> Result<(), ParseError> {
        let mut position = [0.0; 3];
        for x in &mut position {
            text.more_anywhere();
            *x = text.number("the file ends inside a vertex")?;
        }
        self.positions.push(position);
        let normal_width = if layout.has_normal { 3 } else { 0 };
        let uv_width = if layout.has_uv { 2 } else { 0 };
        for (values, width) in [
            (&mut self.normals, normal_width),
            (&mut self.colors, layout.color_width),
            (&mut self.uvs, uv_width),
        ] {
            for _ in 0..width {
                text.more_anywhere();
                values.push(text.attribute("the file ends inside a vertex")?);
            }
        }
        Ok(())
    }

    fn attributes(&mut self, layout: VertexFormat, faces: &[[VertexId; 3]]) -> Option<Attributes> {
        normalize_colors(&mut self.colors);
        let layers = [
            (LayerKind::Normal, 3, std::mem::take(&mut self.normals)),
            (LayerKind::Color(0), layout.color_width, std::mem::take(&mut self.colors)),
            (LayerKind::Uv(0), 2, std::mem::take(&mut self.uvs)),
        ];
        let present = layers.into_iter().filter(|(_, _, values)| !values.is_empty());
        let layers =
            present.map(|(kind, width, values)| named_layer(kind, width, values)).collect();
        per_vertex(self.positions.len(), faces, layers)
    }
}

/// Buffers for the current polygon and its triangles.
#[derive(Default)]
struct Scratch {
    polygon: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    /// Number of faces with numbers after their corners.
    colored: usize,
    /// Number of faces with one or two corners.
    thin: usize,
}

impl Scratch {
    /// Reads one face: the number of corners, then the corners; the rest of the line is a colour.
    fn face(
        &mut self,
        positions: &[[f64; 3]],
        text: &mut TextCursor,
        out: &mut Vec<[VertexId; 3]>,
    ) -> Result<(), ParseError> {
        let corners = text.integer("a face is missing")?;
        if corners < 1 {
            return Err(text.error(format!(
                "a face begins with the number of its corners, not {corners}; check the counts in \
                 the header, and that each vertex has the numbers that the header calls for"
            )));
        }
        self.polygon.clear();
        for _ in 0..corners {
            text.more_anywhere();
            let index = text.integer("the file ends inside a face")?;
            if index < 0 || index >= positions.len() as i64 {
                let count = positions.len();
                let reason = format!("a face refers to vertex {index}, but there are only {count}");
                return Err(text.error(reason));
            }
            self.polygon.push(index as u32);
        }
        self.colored += usize::from(text.words_left() > 0);
        self.thin += usize::from(corners < 3);
        self.triangles.clear();
        triangulate(positions, &self.polygon, &mut self.triangles);
        let corner = |i: u32| VertexId(self.polygon[i as usize]);
        out.extend(self.triangles.iter().map(|triangle| triangle.map(corner)));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        read(text.as_bytes()).unwrap_err().to_string()
    }

    const TETRAHEDRON: &str = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

    #[test]
    fn colours_of_faces_are_noted() {
        let notes = |text: String| read_scene(text.as_bytes()).unwrap().notes;
        assert!(notes(format!("OFF\n4 4 6\n{TETRAHEDRON}")).is_empty());
        let colored = TETRAHEDRON.replace("3 0 2 1\n", "3 0 2 1 255 0 0\n");
        let found = notes(format!("OFF\n4 4 6\n{}", colored.replace("1 2 3\n", "1 2 3 7 # map\n")));
        assert_eq!(found[0].to_string(), "2 colours of faces");
    }

    #[test]
    fn faces_of_two_corners_are_noted() {
        let text = TETRAHEDRON.replace("3 0 2 1\n", "2 0 1\n3 0 2 1\n");
        let scene = read_scene(format!("OFF\n4 5 6\n{text}").as_bytes()).unwrap();
        assert_eq!(scene.notes[0].to_string(), "1 face of fewer than three corners");
        assert_eq!(scene.meshes[0].mesh.faces.len(), 4);
        let none = error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n0 1 2\n");
        assert!(none.contains("a face begins with the number of its corners, not 0"), "{none}");
    }

    #[test]
    fn headers_come_in_many_forms() {
        let expected = read(format!("OFF\n4 4 6\n{TETRAHEDRON}").as_bytes()).unwrap();
        assert_eq!((expected.positions.len(), expected.faces.len()), (4, 4));
        for header in [
            "OFF 4 4 6\n",
            "\t OFF4 4 6 # or so\n",
            "4 4 6\n",
            "# first\r\nOFF # second\r\n\r\n# third\r\n4 4 6\r\n\r\n",
            "OFF\n4 4\n",
            "OFF\r4\r4 0\r",
        ] {
            let mesh = read(format!("{header}{TETRAHEDRON}").as_bytes());
            assert_eq!(mesh.as_ref(), Ok(&expected), "{header:?}");
        }
    }

    #[test]
    fn numbers_may_stand_on_any_lines() {
        let text = "OFF 3 1 0 0 0\n0 1 # x\n 0 0 0 1\n0 3 0\n1 2";
        let mesh = read(text.as_bytes());
        assert!(mesh.is_err(), "what is behind the counts on their line is no vertex");
        let text = "OFF 3 1 0\n0 0\n0 1 # x\n 0 0 0 1\n0 3 0\n1 2";
        let mesh = read(text.as_bytes()).unwrap();
        assert_eq!(mesh.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(mesh.faces, [[0, 1, 2].map(VertexId)]);
    }

    #[test]
    fn attributes_come_in_the_order_of_geomview() {
        let text = "STCNOFF\n3 1 0\n\
                    0 0 0  0 0 1  255 0 0 51  0.5 0.25\n\
                    1 0 0  0 nan 1  0 255 0 51  1 0\n\
                    0 1 0  0 0 1  0 0 255 51  0 1\n3 0 1 2 0.5 0.5 0.5\n";
        assert_eq!(read(text.replace("CN", "NC").as_bytes()), read(text.as_bytes()));
        let attributes = read(text.as_bytes()).unwrap().attributes.unwrap();
        let values = |kind| attributes.layer(kind).unwrap().values.clone();
        assert_eq!(values(LayerKind::Normal), [0., 0., 1., 0., 0., 1., 0., 0., 1.]);
        assert_eq!(values(LayerKind::Color(0))[..5], [1.0, 0.0, 0.0, 0.2, 0.0]);
        assert_eq!(values(LayerKind::Uv(0)), [0.5, 0.25, 1.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn colours_have_three_or_four_components() {
        for (color, width) in [("1 0.5 0", 3), ("1 0.5 0 1", 4)] {
            let vertex = |p: &str| format!("{p} {color} # red\n");
            let vertices: String = ["0 0 0", "1 0 0", "0 1 0"].map(vertex).concat();
            let text = format!("COFF\n3 1 0\n{vertices}3 0 1 2\n");
            let attributes = read(text.as_bytes()).unwrap().attributes.unwrap();
            assert_eq!(attributes.layers[0].width, width);
            assert_eq!(attributes.layers[0].values[..3], [1.0, 0.5, 0.0]);
        }
        assert_eq!(
            error("COFF\n3 1 0\n0 0 0 7\n1 0 0 7\n0 1 0 7\n3 0 1 2\n"),
            "line 3: this header calls for 6 or 7 numbers per vertex, but this line has 4"
        );
    }

    #[test]
    fn polygons_are_triangulated() {
        let text = "OFF\n5 2 0\n0 0 0\n2 0 0\n2 2 0\n1 0.5 0\n0 2 0\n5 0 1 2 3 4 1 0 0\n3 0 1 2\n";
        assert_eq!(read(text.as_bytes()).unwrap().faces.len(), 4);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, message) in [
            ("", "byte 0: the file is empty"),
            ("# only\n", "line 1: the file is empty"),
            ("ply\n", "line 1: \"ply\" is not an OFF header or a count"),
            ("OFF\n3", "line 2: the counts of vertices and faces are missing"),
            (
                "OFF\n353535235358 6 0\n0 0 0\n",
                "line 2: the header declares 353535235358 vertices and 6 faces, but only 7 bytes \
                 follow",
            ),
            ("4OFF\n3 1 0\n", "line 1: only three-dimensional OFF is supported"),
            ("nOFF\n3\n", "line 1: only three-dimensional OFF is supported"),
            (
                "OFF BINARY\n",
                "line 1: binary OFF is not supported; convert the file to text or to PLY",
            ),
            (
                "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n",
                "line 5: the file has no faces of three corners or more",
            ),
            (
                "OFF\n3 1 0\n0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n",
                "line 4: \"inf\" is not a finite number",
            ),
            (
                "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
                "line 6: a face refers to vertex 3, but there are only 3",
            ),
            (
                "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1   \n",
                "line 6: the file has no faces of three corners or more",
            ),
            (
                "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 0 0 0 0 0",
                "line 6: the file ends after 1 of 2 faces",
            ),
        ] {
            assert_eq!(error(text), message);
        }
    }
}
