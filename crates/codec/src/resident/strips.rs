//! Faces of parts as triangle strips, in indices that are drawn as they are.

use std::ops::Range;

use meshlod_mesh::strip_triangles;
use thiserror::Error;

use crate::bytes::{Malformed, Reader};
use crate::patch::Rows;

/// Triangle strips of parts, in indices that count the nodes of a part from 0.
///
/// An index takes as many bytes as the part needs, and its greatest value is a restart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PartStrips {
    /// Nodes of each part.
    rows: Rows,
    /// First byte of each part's indices, and the end of the last.
    starts: Vec<usize>,
    /// Number of faces of each part.
    faces: Vec<u32>,
    bytes: Vec<u8>,
}

/// Faces of parts as an `.mlq` file stores them: triangle strips over the nodes of each part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoredStrips<'a>(&'a PartStrips);

/// Reason why strips cannot take the place of a compressed mesh's faces.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum StripsError {
    /// The scheme has no parts, so faces have corners anywhere.
    #[error("strips need positions in parts")]
    NoParts,
    /// A strip has a node that does not exist, or nodes of several parts.
    #[error("strip {0} has a node outside the part of its first one")]
    Foreign(usize),
    /// The strips do not draw exactly the faces of a part.
    #[error("the strips do not draw the faces of part {0}")]
    OtherFaces(usize),
    /// The faces to compare with are damaged.
    #[error(transparent)]
    Malformed(#[from] Malformed),
}

/// Bytes of a part's number of indices.
const HEAD: usize = 4;

impl PartStrips {
    /// Sorts strips by part, keeping their order within a part.
    ///
    /// # Errors
    /// A strip that leaves the part of its first node.
    pub(super) fn new<S: IntoIterator<Item = u32>>(
        rows: Rows,
        strips: impl IntoIterator<Item = S>,
    ) -> Result<Self, StripsError> {
        let mut parts = vec![Vec::new(); rows.len()];
        for (number, strip) in strips.into_iter().enumerate() {
            let strip: Vec<u32> = strip.into_iter().collect();
            let Some(&first) = strip.first() else { continue };
            let is_node = (first as usize) < rows.nodes();
            let part = if is_node { rows.place(first).0 } else { 0 };
            let own = rows.range(part);
            if !strip.iter().all(|&node| own.contains(&(node as usize))) {
                return Err(StripsError::Foreign(number));
            }
            let indices: &mut Vec<Option<u32>> = &mut parts[part];
            indices.extend((!indices.is_empty()).then_some(None));
            indices.extend(strip.iter().map(|&node| Some(node - own.start as u32)));
        }
        let mut this = Self { rows, starts: vec![0], faces: Vec::new(), bytes: Vec::new() };
        for (part, indices) in parts.iter().enumerate() {
            let width = this.index_bytes(part);
            let of = |index: &Option<u32>| index.unwrap_or(u32::MAX).to_le_bytes();
            this.bytes.extend(indices.iter().flat_map(|index| of(index).into_iter().take(width)));
            this.starts.push(this.bytes.len());
            this.faces.push(this.local_faces(part).count() as u32);
        }
        Ok(this)
    }

    pub(super) fn rows(&self) -> &Rows {
        &self.rows
    }

    pub(super) fn face_counts(&self) -> impl Iterator<Item = usize> {
        self.faces.iter().map(|&faces| faces as usize)
    }

    /// Returns the faces of one part as nodes, in the order of its strips.
    pub(super) fn faces(&self, part: usize) -> Vec<[u32; 3]> {
        let first = self.rows.range(part).start as u32;
        self.local_faces(part).map(|face| face.map(|index| first + index)).collect()
    }

    fn local_faces(&self, part: usize) -> impl Iterator<Item = [u32; 3]> {
        let indices: Vec<_> = self.indices(part).collect();
        let strips = indices.split(Option::is_none);
        let faces = strips.flat_map(strip_triangles);
        faces.map(|face| face.map(Option::unwrap_or_default)).collect::<Vec<_>>().into_iter()
    }

    /// Iterates over the indices of a part; `None` is a restart.
    fn indices(&self, part: usize) -> impl Iterator<Item = Option<u32>> {
        let width = self.index_bytes(part);
        let restart = u32::MAX >> (u32::BITS - 8 * width as u32);
        self.bytes[self.byte_range(part)].chunks_exact(width).map(move |bytes| {
            let index = bytes.iter().rev().fold(0, |index, &byte| index << 8 | u32::from(byte));
            (index != restart).then_some(index)
        })
    }

    /// Returns the bytes per index of a part, whose greatest value must be left for restarts.
    fn index_bytes(&self, part: usize) -> usize {
        match self.rows.range(part).len() {
            ..0x100 => 1,
            0x100..0x1_0000 => 2,
            _ => 4,
        }
    }

    fn byte_range(&self, part: usize) -> Range<usize> {
        self.starts[part]..self.starts[part + 1]
    }

    pub(super) fn bytes(&self) -> usize {
        HEAD * self.rows.len() + self.bytes.len()
    }

    pub(super) fn store(&self, out: &mut Vec<u8>) {
        for part in 0..self.rows.len() {
            let count = self.byte_range(part).len() / self.index_bytes(part);
            out.extend((count as u32).to_le_bytes());
        }
        out.extend(&self.bytes);
    }

    pub(super) fn restore(rows: Rows, reader: &mut Reader) -> Result<Self, Malformed> {
        let mut this = Self { rows, starts: vec![0], faces: Vec::new(), bytes: Vec::new() };
        let mut end = 0usize;
        for part in 0..this.rows.len() {
            let size = (reader.u32()? as usize).saturating_mul(this.index_bytes(part));
            end = end.saturating_add(size);
            this.starts.push(end);
        }
        this.bytes = reader.take(end)?.to_vec();
        for part in 0..this.rows.len() {
            let nodes = this.rows.range(part).len() as u32;
            if this.indices(part).flatten().any(|index| index >= nodes) {
                return Err(reader.wrong(format!("part {part} has no node for one of its indices")));
            }
            this.faces.push(this.local_faces(part).count() as u32);
        }
        Ok(this)
    }
}

impl<'a> StoredStrips<'a> {
    pub(super) fn new(strips: &'a PartStrips) -> Self {
        Self(strips)
    }

    /// Iterates over the indices of a part, which count its nodes from 0; `None` is a restart
    /// between two strips.
    ///
    /// # Panics
    /// If there is no such part.
    pub fn indices(&self, part: usize) -> impl Iterator<Item = Option<u32>> + use<'a> {
        self.0.indices(part)
    }

    /// Returns the number of bytes that an index of a part takes: 1, 2 or 4.
    ///
    /// # Panics
    /// If there is no such part.
    pub fn index_bytes(&self, part: usize) -> usize {
        self.0.index_bytes(part)
    }

    /// Returns the indices of a part as they are stored: little-endian, with all bits set for a
    /// restart.
    ///
    /// # Panics
    /// If there is no such part.
    pub fn bytes(&self, part: usize) -> &'a [u8] {
        &self.0.bytes[self.0.byte_range(part)]
    }

    /// Returns the number of parts.
    pub fn parts(&self) -> usize {
        self.0.rows.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_as_wide_as_their_part_needs() {
        let rows = Rows::new([2, 300, 70_000]);
        let strips = [(0..2).collect(), (2..302).collect(), (302..70_302).collect::<Vec<u32>>()];
        let made = PartStrips::new(rows.clone(), strips.clone()).unwrap();
        let stored = StoredStrips::new(&made);
        assert_eq!([0, 1, 2].map(|part| stored.index_bytes(part)), [1, 2, 4]);
        assert_eq!(made.bytes(), 3 * 4 + 2 + 2 * 300 + 4 * 70_000);
        assert!(stored.indices(1).eq((0..300).map(Some)));
        assert_eq!((made.faces(0).len(), made.faces(2)[1]), (0, [304, 303, 305]));
        let mut bytes = Vec::new();
        made.store(&mut bytes);
        assert_eq!(bytes.len(), made.bytes());
        assert_eq!(PartStrips::restore(rows, &mut Reader::new(&bytes)), Ok(made));
    }

    #[test]
    fn restarts_stand_between_the_strips_of_a_part_only() {
        let strips = [vec![0, 1, 2], vec![4, 5, 6], vec![2, 1, 3]];
        let made = PartStrips::new(Rows::new([4, 3]), strips).unwrap();
        let indices = |part| StoredStrips::new(&made).indices(part).collect::<Vec<_>>();
        assert_eq!(indices(0), [Some(0), Some(1), Some(2), None, Some(2), Some(1), Some(3)]);
        assert_eq!(indices(1), [Some(0), Some(1), Some(2)]);
        assert_eq!(made.faces(1), [[4, 5, 6]]);
        assert_eq!(StoredStrips::new(&made).bytes(0)[3], 0xff);
    }

    #[test]
    fn a_strip_that_leaves_its_part_is_refused() {
        let strips = |second: [u32; 3]| PartStrips::new(Rows::new([4, 3]), [[0, 1, 2], second]);
        assert!(strips([6, 5, 4]).is_ok());
        assert_eq!(strips([3, 4, 5]), Err(StripsError::Foreign(1)));
        assert_eq!(strips([7, 7, 7]), Err(StripsError::Foreign(1)));
    }

    #[test]
    fn an_index_beyond_its_part_is_refused() {
        let rows = Rows::new([4]);
        let restore = |index: u8| {
            let bytes = [3, 0, 0, 0, 0, 1, index];
            PartStrips::restore(rows.clone(), &mut Reader::new(&bytes)).map(|made| made.faces(0))
        };
        assert_eq!(restore(3), Ok(vec![[0, 1, 3]]));
        assert!(restore(4).is_err());
        assert_eq!(restore(0xff), Ok(vec![]), "a restart after two corners");
        let bytes = u32::MAX.to_le_bytes();
        assert!(PartStrips::restore(rows, &mut Reader::new(&bytes)).is_err());
    }
}
