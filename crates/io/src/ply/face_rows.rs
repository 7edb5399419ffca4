//! Rows of faces in a binary file, one at a time.

use super::header::{Element, Shape};
use super::scalar::Scalar;
use crate::error::ParseError;

/// Rows of faces, which differ in size.
#[derive(Clone, Debug)]
pub struct FaceRows {
    /// Byte of the file that the first row begins at.
    pub start: u64,
    /// Number of rows, as the header says: the file may hold fewer.
    pub count: u64,
    is_big: bool,
    /// Type of the indices.
    index: Scalar,
    /// Parts of a row, in order.
    parts: Vec<RowPart>,
}

/// Part of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
enum RowPart {
    /// Numbers that are skipped, by their bytes.
    Bytes(usize),
    /// List that is skipped.
    List { length: Scalar, item: Scalar },
    /// List of the vertices.
    Vertices { length: Scalar },
}

/// Row of a face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RowLayout {
    /// Size of the row, in bytes.
    pub size: usize,
    /// Number of corners.
    pub corners: usize,
    /// Byte of the row that the indices of the corners begin at.
    indices: usize,
}

/// Reason why a row cannot be read from the bytes that are there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RowFault {
    /// The row needs this many bytes, or more.
    Needs(u64),
    /// A list has a negative length.
    Negative(f64),
}

impl FaceRows {
    pub(super) fn new(element: &Element, start: u64, is_big: bool) -> Result<Self, ParseError> {
        let list = element.face_list().ok_or_else(|| no_list(element))?;
        let mut index = Scalar::U32;
        let mut parts: Vec<RowPart> = Vec::new();
        for (at, property) in element.properties.iter().enumerate() {
            let part = match property.shape {
                Shape::List { length, item } if at == list => {
                    index = item;
                    RowPart::Vertices { length }
                }
                Shape::List { length, item } => RowPart::List { length, item },
                Shape::One(kind) => RowPart::Bytes(kind.size()),
            };
            match (part, parts.last_mut()) {
                (RowPart::Bytes(more), Some(RowPart::Bytes(size))) => *size += more,
                _ => parts.push(part),
            }
        }
        Ok(Self { start, count: element.count, is_big, index, parts })
    }

    /// Measures the row that some bytes begin with.
    ///
    /// # Errors
    /// Bytes that end inside the row, and a list of negative length.
    #[inline]
    pub fn row(&self, bytes: &[u8]) -> Result<RowLayout, RowFault> {
        let mut row = RowLayout::default();
        for &part in &self.parts {
            let size = match part {
                RowPart::Bytes(size) => size as u64,
                RowPart::List { length, item } => {
                    let (size, count) = self.length(length, &bytes[row.size..], row.size)?;
                    size as u64 + count.saturating_mul(item.size() as u64)
                }
                RowPart::Vertices { length } => {
                    let (size, count) = self.length(length, &bytes[row.size..], row.size)?;
                    row.corners = usize::try_from(count).unwrap_or(usize::MAX);
                    row.indices = row.size + size;
                    (size as u64).saturating_add(count.saturating_mul(self.index.size() as u64))
                }
            };
            let end = (row.size as u64).saturating_add(size);
            if end > bytes.len() as u64 {
                return Err(RowFault::Needs(end));
            }
            row.size = end as usize;
        }
        Ok(row)
    }

    /// Reads the length of a list at the beginning of some bytes, which are at `at` in the row:
    /// the size of that number, and the number.
    #[inline]
    fn length(&self, kind: Scalar, bytes: &[u8], at: usize) -> Result<(usize, u64), RowFault> {
        let size = kind.size();
        if bytes.len() < size {
            return Err(RowFault::Needs((at + size) as u64));
        }
        match kind.index(bytes, self.is_big) {
            Some(length) => Ok((size, length)),
            None => Err(RowFault::Negative(kind.number(bytes, self.is_big))),
        }
    }

    /// Appends the vertices of a row, by its bytes.
    ///
    /// # Errors
    /// The first index that is not one of `vertices` vertices, counted from 0.
    #[inline]
    pub fn vertices(
        &self,
        row: RowLayout,
        bytes: &[u8],
        vertices: u64,
        corners: &mut Vec<u64>,
    ) -> Result<(), f64> {
        let size = self.index.size();
        for raw in bytes[row.indices..][..row.corners * size].chunks_exact(size) {
            let index = self.index.index(raw, self.is_big).filter(|&index| index < vertices);
            corners.push(index.ok_or_else(|| self.index.number(raw, self.is_big))?);
        }
        Ok(())
    }
}

/// Creates the error for faces without vertices.
pub(super) fn no_list(element: &Element) -> ParseError {
    ParseError::part("header", format!("element {} has no list vertex_indices", element.name))
}

#[cfg(test)]
mod tests {
    use super::super::header::Header;
    use super::*;

    fn rows(properties: &str, is_big: bool) -> FaceRows {
        let text = format!("ply\nformat ascii 1.0\nelement face 9\n{properties}end_header\n");
        let header = Header::parse(text.as_bytes()).unwrap();
        FaceRows::new(&header.elements[0], 0, is_big).unwrap()
    }

    #[test]
    fn lists_and_numbers_around_the_vertices_are_skipped() {
        let rows = rows(
            "property uchar a\nproperty list short uchar b\nproperty list uint ushort vertex_index\n\
             property float c\n",
            true,
        );
        let bytes = [9, 0, 2, 7, 7, 0, 0, 0, 3, 0, 1, 1, 0, 0, 2, 5, 5, 5, 5];
        let row = rows.row(&bytes).unwrap();
        assert_eq!((row.size, row.corners), (19, 3));
        let mut corners = Vec::new();
        assert_eq!(rows.vertices(row, &bytes, 257, &mut corners), Ok(()));
        assert_eq!(corners, [1, 256, 2]);
        assert_eq!(rows.vertices(row, &bytes, 256, &mut corners), Err(256.0));
        for end in 0..bytes.len() {
            let Err(RowFault::Needs(need)) = rows.row(&bytes[..end]) else { panic!("{end}") };
            assert!(end < need as usize && need as usize <= bytes.len());
        }
    }

    #[test]
    fn hostile_lengths_need_more_than_any_file_has() {
        let rows = rows("property list uint64 double vertex_indices\n", false);
        assert_eq!(rows.row(&[0xFF; 8]), Err(RowFault::Needs(u64::MAX)));
        let rows = self::rows("property list int64 double vertex_indices\n", false);
        assert_eq!(rows.row(&[0xFF; 8]), Err(RowFault::Negative(-1.0)));
    }
}
