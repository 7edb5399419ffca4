//! Text STL: keywords and numbers separated by white space.

use std::io::{Result as IoResult, Write};

use meshlod_mesh::{Labels, Mesh};

use super::weld::Welder;
use super::{invalid, normal};
use crate::error::ParseError;
use crate::notes::Note;
use crate::precision::Precision;
use crate::scene::Scene;
use crate::text::line_writer::LineWriter;

/// Reads all solids as one mesh: several become objects, a single one names the mesh. Solids
/// without facets are noted.
pub(super) fn read(bytes: &[u8]) -> Result<Scene, ParseError> {
    let mut words = Words { rest: bytes, line: 1 };
    let mut welder = Welder::with_facets(0);
    let mut faces = Vec::new();
    let mut solids = Labels::default();
    let mut empty = Vec::new();
    while words.peek_is("solid") {
        words.expect("solid")?;
        let name = words.rest_of_line();
        let before = faces.len();
        while words.peek_is("facet") {
            let corners = words.facet()?;
            faces.push(corners.map(|corner| welder.vertex(corner)));
        }
        words.expect("endsolid")?;
        words.rest_of_line();
        if faces.len() > before {
            solids.of_face.resize(faces.len(), solids.names.len() as u32);
            solids.names.push(name);
        } else {
            empty.push(name);
        }
    }
    if let Some(word) = words.next() {
        return Err(words.unexpected(word, "solid"));
    }
    if faces.is_empty() {
        return Err(ParseError::line(words.line, "no faces: no solid has a facet"));
    }
    Ok(scene(Mesh::new(welder.positions, faces), solids, &empty))
}

fn scene(mut mesh: Mesh, mut solids: Labels, empty: &[String]) -> Scene {
    let has_solids = solids.names.len() > 1;
    let name = if has_solids { String::new() } else { solids.names.swap_remove(0) };
    mesh.objects = has_solids.then_some(solids);
    let note = Note::left_out(empty.len(), "solid without facets", "solids without facets")
        .named(empty.iter().filter(|name| !name.is_empty()));
    let notes = Some(note).filter(|note| note.count > 0).into_iter().collect();
    Scene { has_solids, notes, ..Scene::from_mesh(name, mesh) }
}

/// Iterator over words that keeps the line of the last one, counted from 1.
struct Words<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Words<'a> {
    fn skip_space(&mut self) {
        let after = self.rest.trim_ascii_start();
        let space = &self.rest[..self.rest.len() - after.len()];
        self.line += space.iter().filter(|&&b| b == b'\n').count();
        self.rest = after;
    }

    fn next(&mut self) -> Option<&'a [u8]> {
        self.skip_space();
        let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    fn peek_is(&self, keyword: &str) -> bool {
        Words { ..*self }.next().is_some_and(|word| word.eq_ignore_ascii_case(keyword.as_bytes()))
    }

    fn expect(&mut self, keyword: &str) -> Result<(), ParseError> {
        match self.next() {
            Some(word) if word.eq_ignore_ascii_case(keyword.as_bytes()) => Ok(()),
            Some(word) => Err(self.unexpected(word, keyword)),
            None => Err(self.ended(keyword)),
        }
    }

    /// Reads the rest of the line after a keyword.
    fn rest_of_line(&mut self) -> String {
        let end = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r'));
        let (name, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.rest = rest;
        String::from_utf8_lossy(name.trim_ascii()).into_owned()
    }

    /// Reads the corners of a facet; its normal may be any three words.
    fn facet(&mut self) -> Result<[[f64; 3]; 3], ParseError> {
        self.expect("facet")?;
        self.expect("normal")?;
        for _ in 0..3 {
            self.next().ok_or_else(|| self.ended("a normal"))?;
        }
        self.expect("outer")?;
        self.expect("loop")?;
        let mut corners = [[0.0; 3]; 3];
        for corner in &mut corners {
            self.expect("vertex")?;
            for x in corner {
                *x = self.number()?;
            }
        }
        self.expect("endloop")?;
        self.expect("endfacet")?;
        Ok(corners)
    }

    fn number(&mut self) -> Result<f64, ParseError> {
        let word = self.next().ok_or_else(|| self.ended("a coordinate"))?;
        let number: Option<f64> = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        match number {
            None => Err(self.unexpected(word, "a coordinate")),
            Some(x) if x.is_finite() => Ok(x),
            Some(_) => {
                let reason = format!("the coordinate {} is not finite", shown(word));
                Err(ParseError::line(self.line, reason))
            }
        }
    }

    fn unexpected(&self, word: &[u8], expected: &str) -> ParseError {
        ParseError::line(self.line, format!("expected {expected}, found {}", shown(word)))
    }

    fn ended(&self, expected: &str) -> ParseError {
        ParseError::line(self.line, format!("the file ends where {expected} is expected"))
    }
}

/// Formats a word of the file for an error: quoted, shortened, and on one line.
fn shown(word: &[u8]) -> String {
    let short = &word[..word.len().min(40)];
    format!("\"{}\"", String::from_utf8_lossy(short).escape_debug())
}

/// Writes a mesh as a text STL file: positions, computed facet normals, and one `solid` for each
/// object that has faces.
///
/// # Errors
/// Errors of `out`, and a position that `precision` cannot hold. Before anything is written: a mesh
/// that breaks [`Mesh::validate`].
pub fn write(mesh: &Mesh, precision: Precision, out: &mut dyn Write) -> IoResult<()> {
    mesh.validate().map_err(invalid)?;
    let label = |face: u32| mesh.objects.as_ref().map_or(0, |objects| objects.of(face as usize));
    let mut order: Vec<u32> = (0..mesh.faces.len() as u32).collect();
    order.sort_by_key(|&face| label(face));
    let mut lines = LineWriter::new(out, precision.width(mesh));
    for solid in order.chunk_by(|&a, &b| label(a) == label(b)) {
        let name = mesh.objects.as_ref().map_or("meshlod", |o| &o.names[label(solid[0]) as usize]);
        let name = name.replace(char::is_control, " ");
        lines.word(format!("solid {name}").trim_end());
        lines.end()?;
        for &face in solid {
            write_facet(mesh, face as usize, &mut lines)?;
        }
        lines.word(format!("endsolid {name}").trim_end());
        lines.end()?;
    }
    lines.finish()
}

fn write_facet(mesh: &Mesh, face: usize, lines: &mut LineWriter<'_>) -> IoResult<()> {
    let corners = mesh.faces[face];
    lines.word("facet normal");
    lines.attributes(&normal(mesh.triangle(corners)).as_vec3().to_array());
    lines.end()?;
    lines.word("outer loop");
    lines.end()?;
    for corner in corners {
        lines.word("vertex");
        lines.position(corner.index(), mesh.positions[corner.index()])?;
        lines.end()?;
    }
    lines.word("endloop");
    lines.end()?;
    lines.word("endfacet");
    lines.end()
}
