//! Text STL: keywords and numbers separated by white space.

use std::io::{Result as IoResult, Write};

use meshlod_mesh::{Labels, Mesh};

use super::weld::Welder;
use super::{invalid, normal, write_blocks};
use crate::ParseError;

/// Reads all solids; those without facets are dropped.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, ParseError> {
    let mut words = Words { rest: bytes, line: 1 };
    let mut welder = Welder::with_facets(0);
    let mut faces = Vec::new();
    let mut solids = Labels::default();
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
        }
    }
    if let Some(word) = words.next() {
        return Err(words.unexpected(word, "solid"));
    }
    if faces.is_empty() {
        return Err(ParseError::line(words.line, "no faces: no solid has a facet"));
    }
    let objects = (solids.names.len() > 1).then_some(solids);
    Ok(Mesh { objects, ..Mesh::new(welder.positions, faces) })
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

/// Writes a mesh as a text STL file: exact coordinates and computed facet normals, with one `solid`
/// for each object that has faces.
///
/// # Errors
/// Errors of `out`. Before anything is written: a mesh that breaks [`Mesh::validate`].
pub fn write(mesh: &Mesh, out: &mut dyn Write) -> IoResult<()> {
    mesh.validate().map_err(invalid)?;
    let label = |face: u32| mesh.objects.as_ref().map_or(0, |objects| objects.of(face as usize));
    let mut order: Vec<u32> = (0..mesh.faces.len() as u32).collect();
    order.sort_by_key(|&face| label(face));
    for solid in order.chunk_by(|&a, &b| label(a) == label(b)) {
        let name = mesh.objects.as_ref().map_or("meshlod", |o| &o.names[label(solid[0]) as usize]);
        let name = name.replace(char::is_control, " ");
        writeln!(out, "solid {name}")?;
        let faces = solid.iter().map(|&face| face as usize);
        write_blocks(faces, |face, block| append_facet(mesh, face, block), out)?;
        writeln!(out, "endsolid {name}")?;
    }
    Ok(())
}

fn append_facet(mesh: &Mesh, face: usize, block: &mut Vec<u8>) {
    let corners = mesh.triangle(mesh.faces[face]);
    let [x, y, z] = normal(corners).to_array();
    let mut text = format!("facet normal {x:e} {y:e} {z:e}\n outer loop\n");
    for corner in corners {
        let [x, y, z] = corner.to_array();
        text += &format!("  vertex {x:e} {y:e} {z:e}\n");
    }
    text += " endloop\nendfacet\n";
    block.extend_from_slice(text.as_bytes());
}
