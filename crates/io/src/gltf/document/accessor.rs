//! Reading glTF accessors: typed arrays in the buffers of a document.

use std::borrow::Cow;

use super::buffers::Buffers;
use super::schema::{Accessor, Sparse};
use super::{Document, missing};
use crate::error::ParseError;
use crate::gltf::document::component;

/// Elements of an accessor, stored without gaps.
struct PackedElements<'a> {
    accessor: &'a Accessor,
    /// Components per element.
    width: usize,
    bytes: Cow<'a, [u8]>,
}

/// Place of the elements of an accessor in a buffer, all of which are there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub buffer: usize,
    /// Byte of the buffer that the first element begins at.
    pub start: usize,
    /// Bytes from one element to the next.
    pub stride: usize,
    /// Bytes of an element.
    pub element: usize,
    pub count: usize,
}

impl Span {
    /// Reads some of the elements, without the gaps between them; they must be there.
    pub fn read<'b>(
        &self,
        buffers: &'b Buffers,
        first: usize,
        count: usize,
    ) -> Result<Cow<'b, [u8]>, ParseError> {
        let Some(last) = count.checked_sub(1) else { return Ok(Cow::Borrowed(&[])) };
        let (at, length) = (self.start + first * self.stride, last * self.stride + self.element);
        let bytes = buffers.range(self.buffer, at, length)?.unwrap_or_default();
        if self.stride == self.element {
            return Ok(bytes);
        }
        let mut packed = Vec::with_capacity(count * self.element);
        for at in bytes.chunks(self.stride) {
            packed.extend_from_slice(&at[..self.element]);
        }
        Ok(Cow::Owned(packed))
    }
}

/// Elements of an accessor as floats, normalised if the accessor is.
#[derive(Debug, PartialEq)]
pub(crate) struct Values {
    /// Components per element.
    pub width: usize,
    /// Components of all elements, `width` for each.
    pub values: Vec<f32>,
}

impl Values {
    /// Returns the number of elements of the accessor.
    pub fn count(&self) -> usize {
        self.values.len() / self.width
    }
}

impl Document<'_> {
    /// Reads an accessor of any type as floats, all of them finite.
    pub fn floats(&self, index: usize) -> Result<Values, ParseError> {
        let read = self.stored_floats(index)?;
        match not_finite(index, 0, read.width, &read.values) {
            None => Ok(read),
            Some(error) => Err(error),
        }
    }

    /// Reads an accessor of any type as floats, finite or not.
    pub fn stored_floats(&self, index: usize) -> Result<Values, ParseError> {
        let PackedElements { accessor, width, bytes } = self.packed(index)?;
        let values = numbers(&bytes, accessor.component_type, accessor.normalized);
        Ok(Values { width, values })
    }

    /// Reads the stored numbers of an accessor of any type, and the number of components per
    /// element.
    pub fn stored_numbers(&self, index: usize) -> Result<(usize, Vec<f32>), ParseError> {
        let PackedElements { accessor, width, bytes } = self.packed(index)?;
        Ok((width, numbers(&bytes, accessor.component_type, false)))
    }

    /// Reads an accessor of vertex indices, each of which must be below `limit`.
    pub fn indices(&self, index: usize, limit: usize) -> Result<Vec<u32>, ParseError> {
        self.check_indices(index)?;
        let PackedElements { accessor, bytes, .. } = self.packed(index)?;
        let indices = whole_numbers(&bytes, accessor.component_type);
        match beyond(index, 0, &indices, limit) {
            None => Ok(indices),
            Some(error) => Err(error),
        }
    }

    /// Checks that an accessor is one of indices.
    pub fn check_indices(&self, index: usize) -> Result<(), ParseError> {
        let (accessor, width, _) = self.typed(index)?;
        let kind = accessor.component_type;
        if width != 1 || !matches!(kind, component::U8 | component::U16 | component::U32) {
            let shape = &accessor.shape;
            let reason =
                format!("indices must be SCALAR of an unsigned type, not {shape} of type {kind}");
            return Err(wrong(index, reason));
        }
        Ok(())
    }

    /// Returns an accessor with its components per element and the bytes of one.
    pub fn typed(&self, index: usize) -> Result<(&Accessor, usize, usize), ParseError> {
        let Some(accessor) = self.accessors.get(index) else {
            return Err(missing("accessor", index, self.accessors.len()));
        };
        let width = component::width(&accessor.shape)
            .ok_or_else(|| wrong(index, format!("unknown type {:?}", accessor.shape)))?;
        let size = component::size(accessor.component_type).ok_or_else(|| {
            wrong(index, format!("unknown component type {}", accessor.component_type))
        })?;
        // Columns of small matrices are padded; no attribute in use has that type.
        if accessor.shape.starts_with("MAT") && size < 4 {
            return Err(wrong(
                index,
                "matrices of 8-bit or 16-bit integers are not supported".to_owned(),
            ));
        }
        Ok((accessor, width, size))
    }

    /// Returns where the elements of an accessor are that are stored as they are, one after the
    /// other; `None` of one that is sparse or has no buffer view.
    pub fn plain_span(&self, index: usize) -> Result<Option<Span>, ParseError> {
        let (accessor, width, size) = self.typed(index)?;
        match (accessor.buffer_view, &accessor.sparse) {
            (Some(view), None) => self.span(index, view, accessor, width * size).map(Some),
            _ => Ok(None),
        }
    }

    /// Reads all elements of an accessor as they are stored.
    pub fn stored_bytes(&self, index: usize) -> Result<Cow<'_, [u8]>, ParseError> {
        Ok(self.packed(index)?.bytes)
    }

    fn packed(&self, index: usize) -> Result<PackedElements<'_>, ParseError> {
        let (accessor, width, size) = self.typed(index)?;
        let values = accessor.count.saturating_mul(width);
        self.spend(&format!("accessor {index}"), values)?;
        let element = width * size;
        let mut bytes = match accessor.buffer_view {
            Some(view) => {
                let span = self.span(index, view, accessor, element)?;
                span.read(self.buffers, 0, span.count)?
            }
            None => Cow::Owned(vec![0; values * size]),
        };
        if let Some(sparse) = &accessor.sparse {
            self.replace_sparse(index, sparse, element, bytes.to_mut())?;
        }
        Ok(PackedElements { accessor, width, bytes })
    }

    fn span(
        &self,
        index: usize,
        view: usize,
        accessor: &Accessor,
        element: usize,
    ) -> Result<Span, ParseError> {
        let view = self.view(view)?;
        let stride = view.byte_stride.filter(|&stride| stride > 0).unwrap_or(element);
        if stride < element {
            let reason =
                format!("the stride of {stride} bytes is less than the element size of {element}");
            return Err(wrong(index, reason));
        }
        let start = accessor.byte_offset;
        let last = accessor.count.saturating_sub(1);
        let length = last.checked_mul(stride).and_then(|length| length.checked_add(element));
        let end = length.and_then(|length| start.checked_add(length));
        if accessor.count > 0 && end.is_none_or(|end| end > view.byte_length) {
            let (count, found) = (accessor.count, view.byte_length);
            let reason = format!("{count} elements do not fit in its buffer view of {found} bytes");
            return Err(wrong(index, reason));
        }
        let start = view.byte_offset.saturating_add(start);
        Ok(Span { buffer: view.buffer, start, stride, element, count: accessor.count })
    }

    fn replace_sparse(
        &self,
        index: usize,
        sparse: &Sparse,
        element: usize,
        into: &mut [u8],
    ) -> Result<(), ParseError> {
        let cut = |view: usize, offset: usize, size: usize| {
            let length = sparse.count.saturating_mul(size);
            self.part_of_view(view, offset, length)?.ok_or_else(|| {
                let count = sparse.count;
                wrong(index, format!("{count} sparse elements do not fit in bufferView {view}"))
            })
        };
        let kind = sparse.indices.component_type;
        let size = match kind {
            component::U8 => 1,
            component::U16 => 2,
            component::U32 => 4,
            _ => {
                return Err(wrong(
                    index,
                    format!("sparse indices must be unsigned, not of component type {kind}"),
                ));
            }
        };
        let indices = cut(sparse.indices.buffer_view, sparse.indices.byte_offset, size)?;
        let values = cut(sparse.values.buffer_view, sparse.values.byte_offset, element)?;
        for (at, value) in whole_numbers(&indices, kind).into_iter().zip(values.chunks(element)) {
            let start = (at as usize).saturating_mul(element);
            let Some(place) = into.get_mut(start..start.saturating_add(element)) else {
                let count = into.len() / element;
                let reason =
                    format!("sparse element {at} is out of range: there are only {count} elements");
                return Err(wrong(index, reason));
            };
            place.copy_from_slice(value);
        }
        Ok(())
    }
}

/// Returns the error of the first index, counted from `first`, that is not below `limit`.
pub(crate) fn beyond(
    accessor: usize,
    first: usize,
    indices: &[u32],
    limit: usize,
) -> Option<ParseError> {
    let at = indices.iter().position(|&i| i as usize >= limit)?;
    let (number, found) = (first + at, indices[at]);
    let reason = format!("index {number} is {found}, but there are only {limit} vertices");
    Some(wrong(accessor, reason))
}

/// Returns the error of the first element, counted from `first`, that is not finite.
pub(crate) fn not_finite(
    accessor: usize,
    first: usize,
    width: usize,
    values: &[f32],
) -> Option<ParseError> {
    let at = values.iter().position(|x| !x.is_finite())?;
    let (element, value) = (first + at / width, values[at]);
    Some(wrong(accessor, format!("element {element} is not finite: {value}")))
}

fn wrong(index: usize, reason: String) -> ParseError {
    ParseError::part(format!("accessor {index}"), reason)
}

/// Converts components to floats; `normalized` integers become [-1, 1] or [0, 1].
pub(crate) fn numbers(bytes: &[u8], kind: u32, normalized: bool) -> Vec<f32> {
    let scaled = |greatest: f32| if normalized { greatest } else { 1.0 };
    match kind {
        component::I8 => map(bytes, |[b]| f32::from(b as i8) / scaled(127.0), normalized),
        component::U8 => map(bytes, |[b]| f32::from(b) / scaled(255.0), false),
        component::I16 => {
            map(bytes, |b| f32::from(i16::from_le_bytes(b)) / scaled(32767.0), normalized)
        }
        component::U16 => map(bytes, |b| f32::from(u16::from_le_bytes(b)) / scaled(65535.0), false),
        component::U32 => map(bytes, |b| u32::from_le_bytes(b) as f32, false),
        _ => map(bytes, f32::from_le_bytes, false),
    }
}

/// Maps components to floats. `clamped` is for normalised signed integers, whose minimum is
/// slightly below -1.
fn map<const N: usize>(bytes: &[u8], number: impl Fn([u8; N]) -> f32, clamped: bool) -> Vec<f32> {
    let (components, _) = bytes.as_chunks::<N>();
    if clamped {
        components.iter().map(|&c| number(c).max(-1.0)).collect()
    } else {
        components.iter().map(|&c| number(c)).collect()
    }
}

pub(crate) fn whole_numbers(bytes: &[u8], kind: u32) -> Vec<u32> {
    match kind {
        component::U8 => bytes.iter().map(|&b| u32::from(b)).collect(),
        component::U16 => {
            bytes.as_chunks().0.iter().map(|&b| u32::from(u16::from_le_bytes(b))).collect()
        }
        _ => bytes.as_chunks().0.iter().map(|&b| u32::from_le_bytes(b)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// The floats of accessor 0 over a buffer of 16 bytes: 0, 1, 2 …
    fn floats(accessor: serde_json::Value) -> Result<Values, String> {
        let buffers = Buffers::new(vec![(0..16).collect()]);
        let json = json!({
            "accessors": [accessor],
            "bufferViews": [
                { "buffer": 0, "byteLength": 16 },
                { "buffer": 0, "byteOffset": 1, "byteLength": 12, "byteStride": 4 },
            ],
        });
        let document = Document::new(&json, &buffers).map_err(|error| error.to_string())?;
        document.floats(0).map_err(|error| error.to_string())
    }

    #[test]
    fn strides_skip_what_lies_between() {
        let accessor = json!({"bufferView": 1, "componentType": 5121, "count": 3, "type": "VEC2"});
        let values = vec![1.0, 2.0, 5.0, 6.0, 9.0, 10.0];
        assert_eq!(floats(accessor), Ok(Values { width: 2, values }));
    }

    #[test]
    fn normalized_integers_reach_one() {
        assert_eq!(numbers(&[255, 0], component::U8, true), [1.0, 0.0]);
        assert_eq!(numbers(&[128, 129, 127], component::I8, true), [-1.0, -1.0, 1.0]);
        assert_eq!(numbers(&[128], component::I8, false), [-128.0]);
        assert_eq!(numbers(&[0, 0x80, 0xff, 0x7f], component::I16, true), [-1.0, 1.0]);
        assert_eq!(numbers(&[0xff, 0xff], component::U16, true), [1.0]);
    }

    #[test]
    fn sparse_elements_replace_those_that_are_named() {
        let sparse = |at: usize| {
            json!({
                "componentType": 5121, "count": 4, "type": "SCALAR",
                "sparse": {
                    "count": 2,
                    "indices": { "bufferView": 0, "byteOffset": at, "componentType": 5121 },
                    "values": { "bufferView": 0, "byteOffset": 8 },
                },
            })
        };
        assert_eq!(floats(sparse(1)).unwrap().values, [0.0, 8.0, 9.0, 0.0]);
        let error = floats(sparse(3)).unwrap_err();
        assert!(error.contains("sparse element 4"), "{error}");
    }

    #[test]
    fn what_does_not_fit_is_an_error_that_names_the_accessor() {
        for accessor in [
            json!({"bufferView": 0, "componentType": 5126, "count": 5, "type": "SCALAR"}),
            json!({"bufferView": 0, "componentType": 5126, "count": 1u64 << 62, "type": "VEC4"}),
            json!({"bufferView": 0, "byteOffset": u64::MAX, "componentType": 5121, "count": 1,
                   "type": "SCALAR"}),
            json!({"bufferView": 1, "componentType": 5126, "count": 1, "type": "VEC4"}),
            json!({"bufferView": 9, "componentType": 5126, "count": 1, "type": "SCALAR"}),
            json!({"componentType": 5126, "count": u32::MAX, "type": "SCALAR"}),
            json!({"componentType": 1, "count": 1, "type": "SCALAR"}),
            json!({"componentType": 5126, "count": 1, "type": "VEC5"}),
            json!({"componentType": 5126, "count": -1, "type": "SCALAR"}),
        ] {
            let error = floats(accessor).unwrap_err();
            assert!(error.contains("accessor 0") || error.contains("bufferView 9"), "{error}");
        }
    }
}
