//! The body as a stream of numbers, whatever its encoding.

use std::fmt;

use meshlod_mesh::VertexId;

use super::header::{Element, Scalar, Shape, shown};
use crate::ParseError;

/// Which row is being read, for errors: prints as `vertex 12 of 2903`, counted from 0.
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

/// Numbers in the order of the file. A clone reads on from the same place.
pub(super) trait BodyReader: Clone {
    /// To be called before the first number of a row.
    fn begin_row(&mut self);

    /// To be called behind the last number of a row.
    fn end_row(&mut self, row: Row) -> Result<(), ParseError>;

    /// The next number; every type fits `f64` exactly.
    fn number(&mut self, kind: Scalar, row: Row) -> Result<f64, ParseError>;

    /// Passes over so many numbers.
    fn pass(&mut self, kind: Scalar, count: usize, row: Row) -> Result<(), ParseError>;

    /// The most items of a type, or rows of an element, that the rest of the file can hold.
    fn most_items(&self, kind: Scalar) -> usize;
    fn most_rows(&self, element: &Element) -> usize;

    /// An error about the row that was begun last.
    fn wrong(&self, reason: String) -> ParseError;

    /// Takes the first rows in one sweep, as long as they are plain, and gives their number; the
    /// others are left to the careful way, and so are all errors. See [`super::bulk`].
    fn bulk_positions(
        &mut self,
        _element: &Element,
        _xyz: [usize; 3],
        _positions: &mut Vec<[f64; 3]>,
    ) -> u64 {
        0
    }

    /// The same for faces.
    fn bulk_triangles(
        &mut self,
        _element: &Element,
        _vertices: usize,
        _triangles: &mut Vec<[VertexId; 3]>,
    ) -> u64 {
        0
    }

    /// The length of a list, which the rest of the file can hold.
    fn length(&mut self, length: Scalar, item: Scalar, row: Row) -> Result<usize, ParseError> {
        let claimed = self.number(length, row)?;
        if claimed < 0.0 {
            return Err(self.wrong(format!("{row} has a list of length {claimed}")));
        }
        if claimed > self.most_items(item) as f64 {
            return Err(self.wrong(format!(
                "{row} has a list of {claimed} values, but the file ends before that many"
            )));
        }
        Ok(claimed as usize)
    }

    /// Passes over one property of a row.
    fn pass_property(&mut self, shape: Shape, row: Row) -> Result<(), ParseError> {
        match shape {
            Shape::One(kind) => self.pass(kind, 1, row),
            Shape::List { length, item } => {
                let count = self.length(length, item, row)?;
                self.pass(item, count, row)
            }
        }
    }

    /// Passes over all rows of an element.
    fn skip(&mut self, element: &Element) -> Result<(), ParseError> {
        // Rows of nothing take no bytes: their count alone could keep us for ever.
        let count = if element.properties.is_empty() { 0 } else { element.count };
        for index in 0..count {
            let row = Row { element, index };
            self.begin_row();
            for property in &element.properties {
                self.pass_property(property.shape, row)?;
            }
            self.end_row(row)?;
        }
        Ok(())
    }
}
