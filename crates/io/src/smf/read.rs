//! Reading SMF files.

use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, VertexId, WedgeId, merge_equal_wedges};

use super::scope::Scopes;
use crate::error::ParseError;
use crate::notes::Note;
use crate::polygon::triangulate;
use crate::scene::Scene;
use crate::text::cursor::{TextCursor, quoted};
use crate::vertex_attributes::{named_layer, normalize_colors, per_vertex};

/// Parses an SMF file, without its notes: see [`read_scene`].
///
/// # Errors
/// Those of [`read_scene`].
pub fn read(bytes: &[u8]) -> Result<Mesh, ParseError> {
    read_noted(bytes).map(|(mesh, _)| mesh)
}

/// Parses an SMF file, as one mesh under one node.
///
/// Supported are `v`, `f` and `t`, the properties `c`, `n` and `r` as bound by `bind`, and scopes
/// with `trans`, `scale`, `rot`, `t_trans`, `t_scale` and `set vertex_correction`.
///
/// Polygons are triangulated. Normals are normalised and transformed with their vertices.
/// Properties that are not finite become 0, and are counted; if a colour exceeds 1, all are divided
/// by 255. `#` and `$` begin comments. The image that `tex` names is left out with a note.
///
/// Cost: O(n log n), n = bytes, plus that of triangulating concave polygons.
/// # Errors
/// The line and the reason: an unknown command, an invalid number, a coordinate that is not finite,
/// a vertex that does not exist, a property that is not bound or not given for each vertex or face.
/// Also a file without faces.
/// # References
/// [Gar98] (the format's page in QSlim 2.0).
pub fn read_scene(bytes: &[u8]) -> Result<Scene, ParseError> {
    let (mesh, mut notes) = read_noted(bytes)?;
    notes.retain(|note| note.count > 0);
    Ok(Scene { notes, ..Scene::from_mesh("", mesh) })
}

fn read_noted(bytes: &[u8]) -> Result<(Mesh, Vec<Note>), ParseError> {
    let mut text = TextCursor::new(bytes)?;
    let mut reader = SmfReader::new();
    loop {
        reader.command(&mut text)?;
        if !text.next_line() {
            break;
        }
    }
    let images = Note::left_out(reader.images, "texture image", "texture images")
        .remedied("assign the image again, or convert the model to .obj where it is made");
    let notes = vec![Note::not_finite(text.not_finite()), images];
    Ok((reader.finish(&text)?, notes))
}

/// Element that the values of a property belong to.
#[derive(Clone, Copy, PartialEq)]
enum Binding {
    Vertex,
    Face,
}

/// Property with its binding and values.
struct BoundLayer {
    letter: &'static str,
    kind: LayerKind,
    width: usize,
    binding: Option<Binding>,
    values: Vec<f32>,
}

struct SmfReader {
    scopes: Scopes,
    positions: Vec<[f64; 3]>,
    faces: Vec<[VertexId; 3]>,
    /// Face of the file for each triangle in `faces`.
    origins: Vec<u32>,
    faces_in_file: u32,
    /// Number of statements that name an image.
    images: usize,
    properties: [BoundLayer; 3],
    polygon: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

const COLOR: usize = 0;
const NORMAL: usize = 1;
const UV: usize = 2;

impl SmfReader {
    fn new() -> Self {
        let property = |letter, kind, width| BoundLayer {
            letter,
            kind,
            width,
            binding: None,
            values: Vec::new(),
        };
        Self {
            scopes: Scopes::new(),
            positions: Vec::new(),
            faces: Vec::new(),
            origins: Vec::new(),
            faces_in_file: 0,
            images: 0,
            properties: [
                property("c", LayerKind::Color(0), 3),
                property("n", LayerKind::Normal, 3),
                property("r", LayerKind::Uv(0), 2),
            ],
            polygon: Vec::new(),
            triangles: Vec::new(),
        }
    }

    fn command(&mut self, text: &mut TextCursor) -> Result<(), ParseError> {
        if !text.more() {
            return Ok(());
        }
        let command = text.word();
        match command {
            b"v" => self.vertex(text),
            b"f" | b"t" => self.face(text),
            b"bind" => self.bind(text),
            b"c" => {
                let [r, g, b] = self.attribute(COLOR, text)?;
                self.properties[COLOR].values.extend([r, g, b]);
                Ok(())
            }
            b"n" => {
                let normal = self.attribute(NORMAL, text)?;
                self.properties[NORMAL].values.extend(self.scopes.normal(normal));
                Ok(())
            }
            b"r" => {
                let uv = self.attribute(UV, text)?;
                self.properties[UV].values.extend(self.scopes.uv(uv));
                Ok(())
            }
            b"tex" => {
                self.images += 1;
                Ok(())
            }
            _ if command.starts_with(b"$") => Ok(()),
            _ if self.scopes.run(command, self.positions.len(), text)? => Ok(()),
            _ => Err(text.error(format!("{} is not an SMF command", quoted(command)))),
        }
    }

    fn vertex(&mut self, text: &mut TextCursor) -> Result<(), ParseError> {
        const NEED: &str = "a vertex needs three coordinates";
        let position = [text.number(NEED)?, text.number(NEED)?, text.number(NEED)?];
        let position = self.scopes.position(position);
        if !position.iter().all(|x| x.is_finite()) {
            return Err(
                text.error("the transformation moves the vertex out of the range of numbers")
            );
        }
        if self.positions.len() == u32::MAX as usize {
            return Err(text.error("more than 2^32 vertices are not supported"));
        }
        self.positions.push(position);
        Ok(())
    }

    fn face(&mut self, text: &mut TextCursor) -> Result<(), ParseError> {
        self.polygon.clear();
        while text.more() {
            let index = text.integer("")?;
            let Some(v) = self.scopes.vertex(index, self.positions.len()) else {
                let count = self.positions.len();
                let reason =
                    format!("a face refers to vertex {index}, but there are {count} so far");
                return Err(text.error(reason));
            };
            self.polygon.push(v);
        }
        if self.polygon.len() < 3 {
            let found = self.polygon.len();
            return Err(text
                .error(format!("a face needs at least three corners, but this one has {found}")));
        }
        if self.faces.len() + self.polygon.len() > u32::MAX as usize / 3 {
            return Err(text.error("more than 2^32 corners are not supported"));
        }
        self.triangles.clear();
        triangulate(&self.positions, &self.polygon, &mut self.triangles);
        for triangle in &self.triangles {
            self.faces.push(triangle.map(|i| VertexId(self.polygon[i as usize])));
            self.origins.push(self.faces_in_file);
        }
        self.faces_in_file += 1;
        Ok(())
    }

    /// Runs `bind c|n|r vertex|face`.
    fn bind(&mut self, text: &mut TextCursor) -> Result<(), ParseError> {
        let letter = text.word();
        let Some(property) =
            self.properties.iter_mut().find(|property| property.letter.as_bytes() == letter)
        else {
            return Err(text.error(format!("{} is not c, n or r", quoted(letter))));
        };
        let binding = match text.word() {
            b"vertex" => Binding::Vertex,
            b"face" => Binding::Face,
            other => return Err(text.error(format!("{} is not vertex or face", quoted(other)))),
        };
        if !property.values.is_empty() && property.binding != Some(binding) {
            let letter = property.letter;
            return Err(text.error(format!("{letter} is bound to both vertices and faces")));
        }
        property.binding = Some(binding);
        Ok(())
    }

    fn attribute<const N: usize>(
        &self,
        property: usize,
        text: &mut TextCursor,
    ) -> Result<[f32; N], ParseError> {
        let BoundLayer { letter, binding, .. } = &self.properties[property];
        if binding.is_none() {
            return Err(text.error(format!("{letter} is used before \"bind {letter}\"")));
        }
        let mut values = [0.0; N];
        for value in &mut values {
            *value = text.attribute("the property needs more numbers")?;
        }
        Ok(values)
    }

    fn finish(mut self, text: &TextCursor) -> Result<Mesh, ParseError> {
        if self.faces.is_empty() {
            let points = self.positions.len();
            return Err(text.error(format!("the file ends without faces ({points} vertices)")));
        }
        for property in &mut self.properties {
            let Some(binding) = property.binding.filter(|_| !property.values.is_empty()) else {
                continue;
            };
            let (all, what) = match binding {
                Binding::Vertex => (self.positions.len(), "vertices"),
                Binding::Face => (self.faces_in_file as usize, "faces"),
            };
            let (letter, given) = (property.letter, property.values.len() / property.width);
            if given != all {
                let reason = format!("the file has {given} values of {letter} for {all} {what}");
                return Err(text.error(reason));
            }
        }
        normalize_colors(&mut self.properties[COLOR].values);
        let attributes = self.attributes();
        let mut mesh = Mesh { attributes, ..Mesh::new(self.positions, self.faces) };
        merge_equal_wedges(&mut mesh);
        Ok(mesh)
    }

    /// Builds the attributes: one wedge per vertex, or per corner if a property is bound to faces.
    fn attributes(&self) -> Option<Attributes> {
        let given = || self.properties.iter().filter(|property| !property.values.is_empty());
        if given().all(|property| property.binding == Some(Binding::Vertex)) {
            let layers = given().map(|p| named_layer(p.kind, p.width, p.values.clone()));
            return per_vertex(self.positions.len(), &self.faces, layers.collect());
        }
        let corners = (0..self.faces.len()).map(|f| [0, 1, 2].map(|i| WedgeId::new(3 * f + i)));
        Some(Attributes {
            corners: corners.collect(),
            wedge_count: 3 * self.faces.len(),
            layers: given().map(|property| self.spread(property)).collect(),
        })
    }

    /// Expands the values of a property to corners.
    fn spread(&self, property: &BoundLayer) -> Layer {
        let of = |i: u32| property.values[i as usize * property.width..][..property.width].iter();
        let values = self.faces.iter().zip(&self.origins).flat_map(|(face, &origin)| {
            face.map(|v| if property.binding == Some(Binding::Face) { origin } else { v.0 })
        });
        named_layer(property.kind, property.width, values.flat_map(of).copied().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        read(text.as_bytes()).unwrap_err().to_string()
    }

    const SQUARE: &str = "#$SMF 1.0\n#$vertices 4\nv 0 0 0\nv 1 0 0\n\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn faces_are_f_or_t_and_may_have_four_corners() {
        for faces in ["f 1 2 3\nt 1 3 4\n", "f 1 2 3 4\n", "f -4 -3 -2\nf -4 -2 -1\n"] {
            let mesh = read(format!("{SQUARE}{faces}").as_bytes()).unwrap();
            assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]].map(|face| face.map(VertexId)));
            assert_eq!(mesh.attributes, None);
        }
    }

    #[test]
    fn properties_of_vertices_make_no_seams() {
        let properties = "bind c vertex\nc 1 0 0\nc 0 255 0\nc 0 0 255\nc 51 0 0\n\
                          bind r vertex\nr 0 0\nr 1 0\nt_scale 0.5 2\nt_trans 1 0\nr 1 1\nr 0 nan\n";
        let mesh = read(format!("{SQUARE}f 1 2 3 4\n{properties}").as_bytes()).unwrap();
        let attributes = mesh.attributes.unwrap();
        assert_eq!(attributes.wedge_count, 4);
        assert_eq!(attributes.layers[0].values[3..6], [0.0, 1.0, 0.0]);
        assert_eq!(attributes.layers[1].values, [0.0, 0.0, 1.0, 0.0, 1.0, 2.0, 0.5, 0.0]);
    }

    #[test]
    fn values_that_are_not_finite_and_images_are_noted() {
        let text = format!("{SQUARE}f 1 2 3 4\ntex -i wood.png\nbind n face\nn nan 0 inf\n");
        let notes: Vec<String> =
            read_scene(text.as_bytes()).unwrap().notes.iter().map(Note::to_string).collect();
        let expected = ["2 values of attributes that are not finite read as 0", "1 texture image"];
        assert_eq!(notes, expected);
    }

    #[test]
    fn properties_of_faces_make_seams_only_between_faces() {
        let text = format!("{SQUARE}f 1 2 3 4\nf 4 3 2\nbind n face\nn 0 0 2\nn 0 0 0\n");
        let attributes = read(text.as_bytes()).unwrap().attributes.unwrap();
        assert_eq!(attributes.wedge_count, 7);
        let normals: Vec<&[f32]> =
            attributes.corners.iter().map(|c| attributes.layers[0].of(c[0])).collect();
        assert_eq!(normals, [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]);
    }

    #[test]
    fn scopes_move_vertices_and_count_them_anew() {
        let text = "begin\ntrans 10 0 0\nscale 2 1 1\nrot z 90\nbind n vertex\n\
                    v 0 0 0\nv 0 -1 0\nv 1 0 0\nf 1 2 3\nn 1 0 0\nn 1 1 0\nn 0 0 1\nend\n\
                    begin\nset vertex_correction = 1\nv 5 6 7\nv 1 1 1\nv 0 0 1\n\
                    f 0 1 2\nn 1 0 0\nn 1 0 0\nn 1 0 0\nend\n";
        let mesh = read(text.as_bytes()).unwrap();
        let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-12);
        let expected = [[10.0, 0.0, 0.0], [12.0, 0.0, 0.0], [10.0, 1.0, 0.0]];
        assert!(expected.iter().zip(&mesh.positions).all(|(&a, &b)| near(a, b)));
        assert_eq!(mesh.positions[3], [5.0, 6.0, 7.0]);
        assert_eq!(mesh.faces[1], [3, 4, 5].map(VertexId));
        let attributes = mesh.attributes.unwrap();
        let second = attributes.layers[0].of(attributes.corners[0][1]);
        // Turned to (-1, 1), then by the inverse of the scale to (-1/2, 1).
        let expected = [-1.0 / 5f32.sqrt(), 2.0 / 5f32.sqrt(), 0.0];
        assert!(expected.iter().zip(second).all(|(a, b)| (a - b).abs() < 1e-6), "{second:?}");
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (commands, message) in [
            ("f 1 2 5\n", "line 8: a face refers to vertex 5, but there are 4 so far"),
            ("f 0 1 2\n", "line 8: a face refers to vertex 0, but there are 4 so far"),
            ("f 1 2/2 3\n", "line 8: \"/2\" is not an integer"),
            ("f 1 2\n", "line 8: a face needs at least three corners, but this one has 2"),
            ("v 1 2\n", "line 8: a vertex needs three coordinates"),
            ("3vv\n", "line 8: \"3vv\" is not an SMF command"),
            ("c 1 0 0\n", "line 8: c is used before \"bind c\""),
            ("bind c corner\n", "line 8: \"corner\" is not vertex or face"),
            ("bind q face\n", "line 8: \"q\" is not c, n or r"),
            ("end\n", "line 8: end without begin"),
            ("rot w 90\n", "line 8: \"w\" is not an axis"),
            (
                "scale 1e300 1 1\nscale 1e300 1 1\nv 1 1 1\n",
                "line 10: the transformation moves the vertex out of the range of numbers",
            ),
            ("", "line 7: the file ends without faces (4 vertices)"),
            (
                "f 1 2 3\nbind c face\nc 1 1 1\nc 1 1 1\n",
                "line 11: the file has 2 values of c for 1 faces",
            ),
        ] {
            assert_eq!(error(&format!("{SQUARE}{commands}")), message);
        }
        assert!(
            error(&"begin\n".repeat(2000)).starts_with("line 1001: more than 1000 nested scopes")
        );
    }
}
