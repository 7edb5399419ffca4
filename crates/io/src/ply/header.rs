//! PLY header: the elements in the file, and the properties of their rows.

use std::collections::HashSet;

use super::scalar::Scalar;
use crate::error::ParseError;

/// Encoding of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Shape of a property: a single number or a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    One(Scalar),
    /// Length, followed by that many items.
    List {
        length: Scalar,
        item: Scalar,
    },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub name: String,
    pub shape: Shape,
}

/// Element: `count` rows of `properties`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Lines `comment` and `obj_info`, without those that name textures.
    pub remarks: Vec<String>,
    /// Names after `comment TextureFile`, in order: texture number 0, 1 and so on.
    pub textures: Vec<String>,
    /// First words of lines that are not part of the format, shortened.
    pub unknown: Vec<String>,
    /// Byte offset of the body.
    pub body: usize,
    /// Line of the body, counted from 1.
    pub body_line: usize,
}

impl Header {
    /// Parses a PLY header up to and including the line `end_header`.
    pub fn parse(bytes: &[u8]) -> Result<Self, ParseError> {
        if bytes.is_empty() {
            return Err(ParseError::byte(0, "the file is empty"));
        }
        let mut lines = HeaderLines { rest: bytes, number: 0 };
        if lines.next().is_none_or(|line| line.trim_ascii() != b"ply") {
            return Err(ParseError::line(1, "not a PLY file: its first line must be \"ply\""));
        }
        let mut draft = Draft::default();
        while let Some(line) = lines.next() {
            let line = String::from_utf8_lossy(line);
            let wrong = |reason: String| ParseError::line(lines.number, reason);
            let mut words = line.split_ascii_whitespace();
            match words.next() {
                Some("end_header") => {
                    let encoding = draft
                        .encoding
                        .ok_or_else(|| wrong("the header has no line \"format\"".into()))?;
                    let body = bytes.len() - lines.rest.len();
                    let body_line = lines.number + 1;
                    let Draft { elements, remarks, textures, unknown, .. } = draft;
                    return Ok(Self {
                        encoding,
                        elements,
                        remarks,
                        textures,
                        unknown,
                        body,
                        body_line,
                    });
                }
                Some("comment" | "obj_info") => draft.add_remark(&line),
                Some(keyword) => draft.add(keyword, &mut words).map_err(wrong)?,
                None => {}
            }
        }
        Err(ParseError::line(lines.number, "the file ends before \"end_header\""))
    }
}

/// Iterator over lines ending in LF, CR LF or CR, returned without the line end.
struct HeaderLines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Iterator for HeaderLines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let bytes = self.rest;
        let end = bytes.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(bytes.len());
        let ending = match bytes[end..] {
            [b'\r', b'\n', ..] => 2,
            [] => 0,
            _ => 1,
        };
        self.rest = &bytes[end + ending..];
        self.number += 1;
        Some(&bytes[..end])
    }
}

/// Header under construction.
#[derive(Default)]
struct Draft {
    encoding: Option<Encoding>,
    elements: Vec<Element>,
    remarks: Vec<String>,
    textures: Vec<String>,
    unknown: Vec<String>,
    /// Names of the preceding elements.
    element_names: HashSet<String>,
    /// Names of the properties of the last element.
    property_names: HashSet<String>,
}

impl Draft {
    /// Processes one line.
    fn add<'a>(
        &mut self,
        keyword: &str,
        words: &mut impl Iterator<Item = &'a str>,
    ) -> Result<(), String> {
        match keyword {
            "format" => self.add_format(words.next()),
            "element" => self.add_element(words.next(), words.next()),
            "property" => self.add_property(words),
            _ => {
                self.unknown.push(shown(keyword));
                Ok(())
            }
        }
    }

    /// Keeps a comment, or the texture name in it.
    fn add_remark(&mut self, line: &str) {
        let line = line.trim();
        let name = line.strip_prefix("comment").map(str::trim_start);
        let name = name.and_then(|text| text.strip_prefix("TextureFile"));
        match name.filter(|name| name.starts_with(|c: char| c.is_ascii_whitespace())) {
            Some(name) => self.textures.push(name.trim().to_owned()),
            None => self.remarks.push(line.to_owned()),
        }
    }

    fn add_format(&mut self, name: Option<&str>) -> Result<(), String> {
        self.encoding = Some(match name {
            Some("ascii") => Encoding::Text,
            Some("binary_little_endian") => Encoding::LittleEndian,
            Some("binary_big_endian") => Encoding::BigEndian,
            other => {
                return Err(format!(
                    "unknown format \"{}\"; expected ascii, binary_little_endian or \
                     binary_big_endian",
                    shown(other.unwrap_or_default())
                ));
            }
        });
        Ok(())
    }

    fn add_element(&mut self, name: Option<&str>, count: Option<&str>) -> Result<(), String> {
        let (Some(name), Some(count)) = (name, count) else {
            return Err("an element needs a name and a count".into());
        };
        let count = count
            .parse()
            .map_err(|_| format!("element {}: \"{}\" is not a count", shown(name), shown(count)))?;
        if !self.element_names.insert(name.to_owned()) {
            return Err(format!("the element {} is declared twice", shown(name)));
        }
        self.property_names.clear();
        self.elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
        Ok(())
    }

    fn add_property<'a>(
        &mut self,
        words: &mut impl Iterator<Item = &'a str>,
    ) -> Result<(), String> {
        let element = self.elements.last_mut().ok_or("a property before the first element")?;
        let shape = match words.next() {
            Some("list") => {
                let length = scalar(words.next())?;
                if matches!(length, Scalar::F32 | Scalar::F64) {
                    return Err("the length of a list must have an integer type".into());
                }
                Shape::List { length, item: scalar(words.next())? }
            }
            one => Shape::One(scalar(one)?),
        };
        let name = words.next().ok_or("a property needs a type and a name")?.to_owned();
        if !self.property_names.insert(name.clone()) {
            return Err(format!(
                "element {}: the property {} is declared twice",
                shown(&element.name),
                shown(&name)
            ));
        }
        element.properties.push(Property { name, shape });
        Ok(())
    }
}

/// Parses a scalar type, in the original or the sized spelling.
fn scalar(name: Option<&str>) -> Result<Scalar, String> {
    let name = name.ok_or("a property needs a type and a name")?;
    Ok(match name {
        "char" | "int8" => Scalar::I8,
        "uchar" | "uint8" => Scalar::U8,
        "short" | "int16" => Scalar::I16,
        "ushort" | "uint16" => Scalar::U16,
        "int" | "int32" => Scalar::I32,
        "uint" | "uint32" => Scalar::U32,
        "int64" => Scalar::I64,
        "uint64" => Scalar::U64,
        "float" | "float32" => Scalar::F32,
        "double" | "float64" => Scalar::F64,
        _ => return Err(format!("unknown type \"{}\"", shown(name))),
    })
}

/// Formats a word of the file for an error: shortened, and on one line.
pub(super) fn shown(word: &str) -> String {
    const MOST: usize = 40;
    let mut text: String = word.chars().take(MOST).flat_map(char::escape_debug).collect();
    if word.chars().nth(MOST).is_some() {
        text.push('…');
    }
    text
}

impl Shape {
    /// Returns the minimum size of the property in binary PLY, in bytes; a list may be empty.
    pub fn least_size(self) -> usize {
        match self {
            Self::One(scalar) => scalar.size(),
            Self::List { length, .. } => length.size(),
        }
    }
}

impl Element {
    /// Returns the minimum size of a row in binary PLY, in bytes; it is exact if there are no
    /// lists.
    pub fn least_row_size(&self) -> usize {
        self.properties.iter().map(|property| property.shape.least_size()).sum()
    }

    /// Reports whether all rows of the element have the same size, because no property is a list.
    pub fn is_fixed(&self) -> bool {
        self.properties.iter().all(|property| matches!(property.shape, Shape::One(_)))
    }

    /// Reports whether the element contains faces or triangle strips.
    pub fn holds_faces(&self) -> bool {
        matches!(self.name.as_str(), "face" | "tristrips")
    }

    /// Returns the index of the property that lists the vertices of a face.
    pub fn face_list(&self) -> Option<usize> {
        self.properties.iter().position(|property| {
            matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
                && matches!(property.shape, Shape::List { .. })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Header, String> {
        Header::parse(text.as_bytes()).map_err(|e| e.to_string())
    }

    #[test]
    fn body_begins_behind_any_kind_of_line_end() {
        for (end, data) in [("\n", "\n\n"), ("\r\n", "\n"), ("\r", "x")] {
            let head = ["ply", "format ascii 1.0", "end_header", ""].join(end);
            let header = parse(&(head.clone() + data)).unwrap();
            assert_eq!((header.body, header.body_line), (head.len(), 4), "{end:?}");
        }
    }

    #[test]
    fn both_spellings_name_the_same_type() {
        let header = |kind: &str, list: &str| {
            let text = format!(
                "ply\nformat ascii 1.0\nelement a 1\nproperty {kind} p\nproperty list {list} {kind} q\nend_header\n"
            );
            parse(&text).unwrap().elements
        };
        assert_eq!(header("double", "uchar"), header("float64", "uint8"));
        assert_ne!(header("float", "uchar"), header("float64", "uint8"));
    }

    #[test]
    fn errors_name_the_line() {
        let cases = [
            ("", "byte 0: the file is empty"),
            ("solid x\n", "line 1: not a PLY file: its first line must be \"ply\""),
            ("ply\nformat ascii 1.0\n", "line 2: the file ends before \"end_header\""),
            ("ply\nend_header\n", "line 2: the header has no line \"format\""),
            ("ply\nelement vertex -3\n", "line 2: element vertex: \"-3\" is not a count"),
            ("ply\nproperty int x\n", "line 2: a property before the first element"),
            ("ply\nelement e 1\nproperty real x\n", "line 3: unknown type \"real\""),
            ("ply\nelement e 1\nproperty int\n", "line 3: a property needs a type and a name"),
            ("ply\nelement e 1\nelement e 1\n", "line 3: the element e is declared twice"),
            (
                "ply\nelement e 1\nproperty int x\nproperty int x\n",
                "line 4: element e: the property x is declared twice",
            ),
            (
                "ply\nelement e 1\nproperty list float int x\n",
                "line 3: the length of a list must have an integer type",
            ),
        ];
        for (text, message) in cases {
            assert_eq!(parse(text).unwrap_err(), message);
        }
    }

    #[test]
    fn textures_comments_and_unknown_lines_are_separated() {
        let text = "ply\nformat ascii 1.0\ncomment made  by hand\ncomment TextureFile a b.png\n\
                    obj_info num_cols 512\nvendor 7\ncomment TextureFiles are below\n\
                    comment\tTextureFile c.jpg\r\nend_header\n";
        let header = parse(text).unwrap();
        let remarks =
            ["comment made  by hand", "obj_info num_cols 512", "comment TextureFiles are below"];
        assert_eq!(header.remarks, remarks);
        assert_eq!(header.textures, ["a b.png", "c.jpg"]);
        assert_eq!(header.unknown, ["vendor"]);
    }

    #[test]
    fn long_and_odd_words_are_shown_short_and_on_one_line() {
        let word = format!("\u{1b}[2J{}", "x".repeat(1000));
        let message = parse(&format!("ply\nformat {word}\n")).unwrap_err();
        assert!(message.len() < 200 && !message.contains('\u{1b}'), "{message}");
    }
}
