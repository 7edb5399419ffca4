//! Faces of an OBJ file as numbers in a row, for files that are read part by part.

use std::collections::HashMap;
use std::num::NonZeroU32;

use super::read::{Corner, ValueCounts, check_range};
use crate::error::ParseError;
use crate::text::cursor::TextCursor;

/// Largest number of corners of a face.
const MOST_CORNERS: usize = (1 << 16) + 2;

/// Marks a row whose corners have texture coordinates.
const UVS: u32 = 1 << 30;

/// Marks a row whose corners have normals.
const NORMALS: u32 = 1 << 31;

/// Entry of a list of faces: see [`OutlineRow::read`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutlineRow<'a> {
    /// Faces from here on have the material of this number.
    Material(u32),
    /// Face: for each corner the index of its vertex, counted from 0, and of its texture coordinate
    /// and normal, counted from 1, or 0 for none; these lists are empty if no corner has one.
    Face {
        /// Vertices.
        vertices: &'a [u32],
        /// Texture coordinates.
        uvs: &'a [u32],
        /// Normals.
        normals: &'a [u32],
    },
}

impl<'a> OutlineRow<'a> {
    /// Greatest number of words of a row.
    pub const MOST_WORDS: usize = 1 + 3 * MOST_CORNERS;

    /// Reads the first row of a list, and returns the number of its words; `None` if the list ends
    /// before the row does.
    #[inline]
    pub fn read(words: &'a [u32]) -> Option<(Self, usize)> {
        let (&head, rest) = words.split_first()?;
        let count = (head & !(UVS | NORMALS)) as usize;
        if count == 0 {
            return Some((Self::Material(*rest.first()?), 2));
        }
        let lengths =
            [true, head & UVS != 0, head & NORMALS != 0].map(|has| count * usize::from(has));
        let (vertices, rest) = rest.split_at_checked(lengths[0])?;
        let (uvs, rest) = rest.split_at_checked(lengths[1])?;
        let normals = rest.get(..lengths[2])?;
        Some((Self::Face { vertices, uvs, normals }, 1 + lengths.iter().sum::<usize>()))
    }
}

/// Faces of the current part of a file, and what was seen so far.
#[derive(Default)]
pub(super) struct Outlines {
    /// Rows of the part.
    pub words: Vec<u32>,
    /// Number of faces of the whole file so far.
    pub faces: u64,
    pub has_uvs: bool,
    pub has_normals: bool,
    /// Number of faces with a corner that lacks a normal.
    pub bare: usize,
    pub names: UsedNames,
    /// Line and corner with the greatest index of a vertex, a texture coordinate and a normal, among
    /// those that were not in the file before the corner.
    forward: [Option<(usize, Corner)>; 3],
}

/// Names of materials, numbered as they come.
#[derive(Default)]
pub(super) struct UsedNames {
    numbers: HashMap<String, u32>,
    /// Number of the current name, once there is one.
    current: Option<u32>,
    /// Number that the last face has.
    last: Option<u32>,
    /// Numbers in use, in the order of first use.
    used: Vec<u32>,
    /// True for the numbers in use.
    is_used: Vec<bool>,
}

impl Outlines {
    pub fn set_material(&mut self, name: String) {
        self.names.current = Some(self.names.number(name));
    }

    /// Adds a face of three corners or more.
    pub fn add(
        &mut self,
        polygon: &[Corner],
        is_known: bool,
        text: &TextCursor<'_>,
    ) -> Result<(), ParseError> {
        if polygon.len() > MOST_CORNERS {
            let found = polygon.len();
            let reason = format!(
                "a face of {found} corners is too large to be read in passing; it may have \
                 {MOST_CORNERS}"
            );
            return Err(text.error(reason));
        }
        if let Some(number) = self.names.changed() {
            self.words.extend([0, number]);
        }
        self.faces += 1;
        let has_uvs = polygon.iter().any(|corner| corner.ids.uv.is_some());
        let has_normals = polygon.iter().any(|corner| corner.ids.normal.is_some());
        let mark = |has: bool, mark: u32| if has { mark } else { 0 };
        self.words.push(polygon.len() as u32 | mark(has_uvs, UVS) | mark(has_normals, NORMALS));
        self.words.extend(polygon.iter().map(|corner| corner.vertex.get() - 1));
        let or_none = |id: Option<NonZeroU32>| id.map_or(0, NonZeroU32::get);
        if has_uvs {
            self.words.extend(polygon.iter().map(|corner| or_none(corner.ids.uv)));
        }
        if has_normals {
            self.words.extend(polygon.iter().map(|corner| or_none(corner.ids.normal)));
        }
        self.has_uvs |= has_uvs;
        self.has_normals |= has_normals;
        self.bare += usize::from(polygon.iter().any(|corner| corner.ids.normal.is_none()));
        if !is_known {
            polygon.iter().for_each(|&corner| self.look_forward(text.line(), corner));
        }
        Ok(())
    }

    #[cold]
    fn look_forward(&mut self, line: usize, corner: Corner) {
        let indices = |corner: Corner| [Some(corner.vertex), corner.ids.uv, corner.ids.normal];
        for (kind, index) in indices(corner).into_iter().enumerate() {
            let known = self.forward[kind].and_then(|(_, known)| indices(known)[kind]);
            if index > known {
                self.forward[kind] = Some((line, corner));
            }
        }
    }

    /// Fails if a corner refers to what the file does not have.
    pub fn check(&self, counts: ValueCounts) -> Result<(), ParseError> {
        let mut forward: Vec<(usize, Corner)> = self.forward.into_iter().flatten().collect();
        forward.sort_by_key(|&(line, _)| line);
        forward.into_iter().try_for_each(|(line, corner)| check_range(line, corner, counts))
    }
}

impl UsedNames {
    fn number(&mut self, name: String) -> u32 {
        let next = self.numbers.len() as u32;
        let number = *self.numbers.entry(name).or_insert(next);
        self.is_used.resize(self.numbers.len(), false);
        number
    }

    /// Returns the number of the next face's name if the face before has another one.
    fn changed(&mut self) -> Option<u32> {
        let current = self.current.unwrap_or_else(|| self.number(String::new()));
        self.current = Some(current);
        if self.last == Some(current) {
            return None;
        }
        self.last = Some(current);
        if !std::mem::replace(&mut self.is_used[current as usize], true) {
            self.used.push(current);
        }
        Some(current)
    }

    /// Returns the names in use, in the order of first use, and for each number the label; no names
    /// if all are "".
    pub fn finish(self) -> (Vec<String>, Vec<Option<usize>>) {
        let mut label_of = vec![None; self.numbers.len()];
        self.used.iter().enumerate().for_each(|(label, &n)| label_of[n as usize] = Some(label));
        let mut names = vec![String::new(); self.used.len()];
        for (name, number) in self.numbers {
            if let Some(label) = label_of[number as usize] {
                names[label] = name;
            }
        }
        if names.iter().all(String::is_empty) {
            names.clear();
        }
        (names, label_of)
    }
}
