//! Elements of accessors, some at a time.

use rustc_hash::FxHashMap;

use crate::error::ParseError;
use crate::gltf::document::Document;
use crate::gltf::document::accessor::{Span, beyond, not_finite, numbers, whole_numbers};
use crate::gltf::document::buffers::{Buffers, Growing};

/// Accessor whose elements are all stored one after the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct AccessorRows {
    accessor: usize,
    span: Span,
    component: u32,
    is_normalized: bool,
    /// Components per element.
    pub width: usize,
}

impl AccessorRows {
    /// Reads elements as floats.
    pub fn floats(
        &self,
        buffers: &Buffers,
        first: usize,
        count: usize,
    ) -> Result<Vec<f32>, ParseError> {
        let bytes = self.span.read(buffers, first, count)?;
        Ok(numbers(&bytes, self.component, self.is_normalized))
    }

    /// Reads points, which must be finite.
    pub fn points(
        &self,
        buffers: &Buffers,
        first: usize,
        count: usize,
    ) -> Result<Vec<f32>, ParseError> {
        let values = self.floats(buffers, first, count)?;
        match not_finite(self.accessor, first, self.width, &values) {
            None => Ok(values),
            Some(error) => Err(error),
        }
    }

    /// Reads indices, which must be below `limit`.
    pub fn indices(
        &self,
        buffers: &Buffers,
        first: usize,
        count: usize,
        limit: usize,
    ) -> Result<Vec<u32>, ParseError> {
        let bytes = self.span.read(buffers, first, count)?;
        let indices = whole_numbers(&bytes, self.component);
        match beyond(self.accessor, first, &indices, limit) {
            None => Ok(indices),
            Some(error) => Err(error),
        }
    }
}

/// Accessors that were found, and a buffer for those that are not stored as they are.
pub(super) struct RowsOfAccessors {
    known: FxHashMap<usize, AccessorRows>,
    /// Elements of sparse accessors, and of those without data.
    pub expanded: Growing,
    /// Index that its buffer will have.
    buffer: usize,
}

impl RowsOfAccessors {
    pub fn new(buffers: &Buffers) -> Self {
        let (known, buffer) = (FxHashMap::default(), buffers.parts.len());
        Self { known, expanded: buffers.grow(), buffer }
    }

    /// Finds the elements of an accessor.
    pub fn find(
        &mut self,
        document: &Document<'_>,
        index: usize,
    ) -> Result<AccessorRows, ParseError> {
        if let Some(&known) = self.known.get(&index) {
            return Ok(known);
        }
        let (accessor, width, size) = document.typed(index)?;
        let element = width * size;
        let span = match document.plain_span(index)? {
            Some(span) => span,
            None => {
                let start = self.expanded.add(&document.stored_bytes(index)?)?;
                let (buffer, count) = (self.buffer, accessor.count);
                Span { buffer, start, stride: element, element, count }
            }
        };
        let (component, is_normalized) = (accessor.component_type, accessor.normalized);
        let rows = AccessorRows { accessor: index, span, component, is_normalized, width };
        self.known.insert(index, rows);
        Ok(rows)
    }
}
