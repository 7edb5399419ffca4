//! Binary PLY data, in either byte order.

use meshlod_mesh::VertexId;

use super::body::{BodyReader, Row};
use super::bulk;
use super::header::{Element, Header};
use super::scalar::Scalar;
use crate::error::ParseError;

/// Reader of a binary body; big-endian if `BIG`.
#[derive(Clone)]
pub(super) struct BinaryBody<'a, const BIG: bool> {
    rest: &'a [u8],
    /// Length of the whole file in bytes.
    total: usize,
    /// Byte offset of the current row.
    row_at: usize,
}

impl<'a, const BIG: bool> BinaryBody<'a, BIG> {
    pub fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self { rest: &bytes[header.body..], total: bytes.len(), row_at: header.body }
    }

    /// Creates the error for a file that ends inside a row.
    fn ended(&self, row: Row) -> ParseError {
        ParseError::byte(self.total, format!("the file ends inside {row}"))
    }

    #[inline]
    fn take<const N: usize>(&mut self, row: Row) -> Result<[u8; N], ParseError> {
        let Some((&raw, rest)) = self.rest.split_first_chunk::<N>() else {
            return Err(self.ended(row));
        };
        self.rest = rest;
        Ok(little::<N, BIG>(raw))
    }
}

/// Brings the bytes of a number into little-endian order.
#[inline]
pub(super) fn little<const N: usize, const BIG: bool>(mut raw: [u8; N]) -> [u8; N] {
    if BIG {
        raw.reverse();
    }
    raw
}

impl<const BIG: bool> BodyReader for BinaryBody<'_, BIG> {
    #[inline]
    fn begin_row(&mut self) {
        self.row_at = self.total - self.rest.len();
    }

    #[inline]
    fn end_row(&mut self, _row: Row) -> Result<(), ParseError> {
        Ok(())
    }

    #[inline]
    fn number(&mut self, kind: Scalar, row: Row) -> Result<f64, ParseError> {
        Ok(match kind {
            Scalar::I8 => i8::from_le_bytes(self.take(row)?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take(row)?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take(row)?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take(row)?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take(row)?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take(row)?).into(),
            Scalar::I64 => i64::from_le_bytes(self.take(row)?) as f64,
            Scalar::U64 => u64::from_le_bytes(self.take(row)?) as f64,
            Scalar::F32 => f32::from_le_bytes(self.take(row)?).into(),
            Scalar::F64 => f64::from_le_bytes(self.take(row)?),
        })
    }

    fn skip_numbers(&mut self, kind: Scalar, count: usize, row: Row) -> Result<(), ParseError> {
        let bytes = count.checked_mul(kind.size()).filter(|&bytes| bytes <= self.rest.len());
        self.rest = &self.rest[bytes.ok_or_else(|| self.ended(row))?..];
        Ok(())
    }

    fn most_items(&self, kind: Scalar) -> usize {
        self.rest.len() / kind.size()
    }

    fn most_rows(&self, element: &Element) -> usize {
        self.rest.len() / element.least_row_size().max(1)
    }

    fn bytes_left(&self) -> usize {
        self.rest.trim_ascii().len()
    }

    fn wrong(&self, reason: String) -> ParseError {
        ParseError::byte(self.row_at, reason)
    }

    fn bulk_positions(
        &mut self,
        element: &Element,
        xyz: [usize; 3],
        positions: &mut Vec<[f64; 3]>,
    ) -> u64 {
        let rows = bulk::positions::<BIG>(self.rest, element, xyz, positions);
        self.rest = &self.rest[rows * element.least_row_size()..];
        rows as u64
    }

    fn bulk_triangles(
        &mut self,
        element: &Element,
        vertices: usize,
        triangles: &mut Vec<[VertexId; 3]>,
    ) -> u64 {
        let rows = bulk::triangles::<BIG>(self.rest, element, vertices, triangles);
        self.rest = &self.rest[rows * bulk::TRIANGLE_ROW..];
        rows as u64
    }
}
