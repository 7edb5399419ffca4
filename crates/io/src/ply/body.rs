//! Common interface of text and binary PLY data: a stream of numbers.

use std::fmt;

use meshlod_mesh::VertexId;

use super::header::{Element, Shape, shown};
use super::scalar::Scalar;
use crate::error::ParseError;

/// Row being read; displayed in errors as `vertex 12 of 2903`, counted from 0.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    pub element: &'a Element,
    pub index: u64,
}

impl fmt::Display for Row<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} of {}", shown(&self.element.name), self.index, self.element.count)
    }
}

/// Reader of the numbers of a body, in the order of the file. A clone continues from the same
/// place.
pub(super) trait BodyReader: Clone {
    /// Must be called before the first number of a row.
    fn begin_row(&mut self);

    /// Must be called after the last number of a row.
    fn end_row(&mut self, row: Row) -> Result<(), ParseError>;

    /// Reads the next number; 64-bit integers from 2^53 are rounded, all others exact.
    fn number(&mut self, kind: Scalar, row: Row) -> Result<f64, ParseError>;

    /// Skips `count` numbers of a type.
    fn skip_numbers(&mut self, kind: Scalar, count: usize, row: Row) -> Result<(), ParseError>;

    /// Returns an upper bound for the number of items of a type in the rest of the file.
    fn most_items(&self, kind: Scalar) -> usize;
    /// Returns an upper bound for the number of rows of an element in the rest of the file.
    fn most_rows(&self, element: &Element) -> usize;

    /// Returns the number of bytes after the last row that are not white space.
    fn bytes_left(&self) -> usize;

    /// Creates an error located at the current row.
    fn wrong(&self, reason: String) -> ParseError;

    /// Reads leading rows in bulk as long as they have the common layout, and returns their number.
    /// The remaining rows, and all errors, are left to the general path. See [`super::bulk`].
    fn bulk_positions(
        &mut self,
        _element: &Element,
        _xyz: [usize; 3],
        _positions: &mut Vec<[f64; 3]>,
    ) -> u64 {
        0
    }

    /// Reads leading triangles in bulk, see [`BodyReader::bulk_positions`].
    fn bulk_triangles(
        &mut self,
        _element: &Element,
        _vertices: usize,
        _triangles: &mut Vec<[VertexId; 3]>,
    ) -> u64 {
        0
    }

    /// Reads the length of a list, checked against the rest of the file.
    fn length(&mut self, length: Scalar, item: Scalar, row: Row) -> Result<usize, ParseError> {
        let claimed = self.number(length, row)?;
        if claimed < 0.0 {
            return Err(self.wrong(format!("{row} has a list of negative length {claimed}")));
        }
        if claimed > self.most_items(item) as f64 {
            return Err(self.wrong(format!(
                "{row} has a list of {claimed} values, but the file ends before that"
            )));
        }
        Ok(claimed as usize)
    }

    /// Skips one property of a row.
    fn skip_property(&mut self, shape: Shape, row: Row) -> Result<(), ParseError> {
        match shape {
            Shape::One(kind) => self.skip_numbers(kind, 1, row),
            Shape::List { length, item } => {
                let count = self.length(length, item, row)?;
                self.skip_numbers(item, count, row)
            }
        }
    }

    /// Skips all rows of an element.
    fn skip(&mut self, element: &Element) -> Result<(), ParseError> {
        // Rows without properties take no bytes: a huge count alone could keep us busy forever.
        let count = if element.properties.is_empty() { 0 } else { element.count };
        for index in 0..count {
            let row = Row { element, index };
            self.begin_row();
            for property in &element.properties {
                self.skip_property(property.shape, row)?;
            }
            self.end_row(row)?;
        }
        Ok(())
    }
}
