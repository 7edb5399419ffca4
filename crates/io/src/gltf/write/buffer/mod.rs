//! Builder of the accessors, buffer views and single buffer of a glTF document being written.

pub(crate) mod accessor_use;
pub(crate) mod extents;
pub(crate) mod gaps;
pub(crate) mod views;

use serde_json::{Map, Value, json};

use crate::gltf::document::extensions::MESHOPT;
use crate::gltf::document::{Document, component};
use crate::gltf::write::arrays::blob::{Blob, Part, Usage};
use crate::gltf::write::settings::Bytes;
use crate::meshopt::{Filter, encode_attributes, encode_triangles};
use extents::mend_extents;
use gaps::{close_accessors, close_views, knows_references};
use views::{copy_views, free_views};

/// Accessors, buffer views and buffer of a document being written.
///
/// Entries of a source document keep their indices, and free indices are reused. Those left over are
/// removed at the end, unless unknown extensions may refer to the entries behind them.
#[derive(Default)]
pub(crate) struct BufferBuilder {
    accessors: Vec<Value>,
    views: Vec<Value>,
    free_accessors: Vec<usize>,
    free_views: Vec<usize>,
    bytes: Vec<u8>,
    /// Size of the fallback buffer that the compressed views decode to; `None` without compression.
    fallback_size: Option<usize>,
    /// True once an array was added whose type needs `KHR_mesh_quantization`.
    quantized: bool,
    /// Bytes added so far, by [`Part`].
    pub added: [Bytes; 3],
}

impl BufferBuilder {
    /// Turns on meshopt compression for all arrays added from now on.
    pub fn compress(&mut self) {
        self.fallback_size = Some(0);
    }

    /// Creates a builder from an existing document, without the accessors flagged in
    /// `free_accessors` and the buffer views that only they use.
    pub fn of(document: &Document<'_>, free_accessors: &[bool]) -> Self {
        Self::without(document, free_accessors, &[])
    }

    /// Creates a builder like [`of`](Self::of), also without these views, if nothing uses them.
    pub fn without(document: &Document<'_>, free_accessors: &[bool], dropped: &[usize]) -> Self {
        let array = |key| document.json.get(key).and_then(Value::as_array).cloned();
        let mut builder = Self {
            accessors: array("accessors").unwrap_or_default(),
            views: array("bufferViews").unwrap_or_default(),
            ..Self::default()
        };
        mend_extents(document, free_accessors, &mut builder.accessors);
        let free_views = free_views(document, &builder.accessors, free_accessors, dropped);
        builder.free_accessors = indices_of(free_accessors);
        builder.free_views = indices_of(&free_views);
        builder.keep_bytes(document, &free_views);
        builder
    }

    pub fn is_quantized(&self) -> bool {
        self.quantized
    }

    pub fn is_compressed(&self) -> bool {
        self.fallback_size.is_some_and(|length| length > 0)
    }

    /// Adds an array as an accessor with its own buffer view, and returns the index of the
    /// accessor.
    pub fn add(&mut self, blob: Blob) -> usize {
        // Core glTF already allows normalised unsigned integers for colours and texture coordinates
        // and unsigned ones for joints; positions are never normalised.
        let signed = matches!(blob.component, component::I8 | component::I16);
        let position = blob.part == Part::Positions && blob.component != component::F32;
        self.quantized |= signed || position;
        self.align();
        let stored = self.bytes.len();
        let mut view = match self.fallback_size {
            None => self.view_of(&blob.bytes),
            Some(at) => self.compressed_view_of(&blob, at),
        };
        let added = &mut self.added[blob.part as usize];
        added.resident += blob.bytes.len();
        added.stored += self.bytes.len() - stored;
        view.insert("target".into(), (blob.usage as u32).into());
        if let Some(stride) = blob.stride {
            view.insert("byteStride".into(), stride.into());
        }
        let view = insert(&mut self.views, &mut self.free_views, view.into());
        let mut accessor = json!({
            "bufferView": view,
            "componentType": blob.component,
            "count": blob.count,
            "type": blob.shape,
        });
        if blob.normalized {
            accessor["normalized"] = true.into();
        }
        if let Some([min, max]) = blob.extent {
            accessor["min"] = json!(min);
            accessor["max"] = json!(max);
        }
        insert(&mut self.accessors, &mut self.free_accessors, accessor)
    }

    /// Adds 4×4 matrices, column by column, as an accessor for a skin, and returns its index.
    pub fn add_matrices(&mut self, matrices: &[[f32; 16]]) -> usize {
        let values = matrices.as_flattened().iter();
        let bytes = values.map(|x| x.to_le_bytes()).collect::<Vec<_>>().into_flattened();
        let view = self.add_view(&bytes);
        let accessor = json!({
            "bufferView": view, "componentType": component::F32, "count": matrices.len(),
            "type": "MAT4",
        });
        insert(&mut self.accessors, &mut self.free_accessors, accessor)
    }

    /// Adds an accessor and returns its index.
    pub fn add_accessor(&mut self, accessor: Value) -> usize {
        insert(&mut self.accessors, &mut self.free_accessors, accessor)
    }

    /// Adds a buffer view of elements that accessors share, encoded for the filter, and returns its
    /// index.
    pub fn add_keys(&mut self, bytes: &[u8], stride: usize, filter: Filter) -> usize {
        let blob = Blob {
            component: component::F32,
            shape: "SCALAR",
            normalized: false,
            count: bytes.len() / stride,
            bytes: bytes.to_vec(),
            stride: None,
            extent: None,
            usage: Usage::Vertices,
            part: Part::Attributes,
            filter,
        };
        self.align();
        let view = match self.fallback_size {
            None => self.view_of(bytes),
            Some(at) => self.compressed_view_of(&blob, at),
        };
        insert(&mut self.views, &mut self.free_views, view.into())
    }

    /// Adds a buffer view without an accessor, such as an image, and returns its index.
    pub fn add_view(&mut self, bytes: &[u8]) -> usize {
        let view = self.view_of(bytes);
        insert(&mut self.views, &mut self.free_views, view.into())
    }

    /// Returns the bytes of a buffer view that was added; `None` if there is none, or compressed.
    pub fn view_bytes(&self, view: usize) -> Option<&[u8]> {
        let view = self.views.get(view)?;
        let number = |key: &str| view.get(key).map_or(Some(0), Value::as_u64);
        let at = number("byteOffset").filter(|_| number("buffer") == Some(0))? as usize;
        self.bytes.get(at..at.checked_add(number("byteLength")? as usize)?)
    }

    /// Enters the accessors, buffer views and buffer length in the JSON document, and returns the
    /// contents of the buffer.
    pub fn finish(mut self, json: &mut Map<String, Value>) -> Vec<u8> {
        self.close_gaps(json);
        let mut buffer = json
            .remove("buffers")
            .and_then(|buffers| buffers.as_array()?.first()?.as_object().cloned())
            .unwrap_or_default();
        buffer.insert("byteLength".into(), self.bytes.len().into());
        let mut buffers = if self.bytes.is_empty() { vec![] } else { vec![buffer.into()] };
        if let Some(length) = self.fallback_size.filter(|&length| length > 0) {
            let fallback = json!({ MESHOPT[0]: { "fallback": true } });
            buffers.push(json!({ "byteLength": length, "extensions": fallback }));
        }
        for (key, values) in
            [("accessors", self.accessors), ("bufferViews", self.views), ("buffers", buffers)]
        {
            if values.is_empty() {
                json.shift_remove(key);
            } else {
                json.insert(key.into(), values.into());
            }
        }
        self.bytes
    }

    /// Removes the entries that are still free, or fills them where others must keep their indices.
    fn close_gaps(&mut self, json: &mut Map<String, Value>) {
        drop_last(&mut self.accessors, &mut self.free_accessors);
        drop_last(&mut self.views, &mut self.free_views);
        if knows_references(json) {
            close_accessors(json, &mut self.accessors, &std::mem::take(&mut self.free_accessors));
            let free = std::mem::take(&mut self.free_views);
            return close_views(json, &mut self.accessors, &mut self.views, &free);
        }
        self.fill_gaps();
    }

    /// Makes entries that are still free valid: a single zero.
    fn fill_gaps(&mut self) {
        for at in std::mem::take(&mut self.free_accessors) {
            let view = self.add_view(&[0; 4]);
            self.accessors[at] = json!({
                "bufferView": view, "componentType": component::F32, "count": 1, "type": "SCALAR",
            });
        }
        drop_last(&mut self.views, &mut self.free_views);
        for at in std::mem::take(&mut self.free_views) {
            self.views[at] = self.view_of(&[0; 4]).into();
        }
    }

    /// Appends bytes to the buffer and returns the view that describes them.
    fn view_of(&mut self, bytes: &[u8]) -> Map<String, Value> {
        self.align();
        let view = json!({
            "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len(),
        });
        self.bytes.extend_from_slice(bytes);
        match view {
            Value::Object(view) => view,
            _ => unreachable!("made as an object just above"),
        }
    }

    fn align(&mut self) {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }

    /// Appends an array as a meshopt stream and returns the view that describes it and its target.
    fn compressed_view_of(&mut self, blob: &Blob, at: usize) -> Map<String, Value> {
        let stride = blob.bytes.len() / blob.count.max(1);
        let (mode, stream) = match blob.usage {
            Usage::Vertices => ("ATTRIBUTES", encode_attributes(&blob.bytes, stride)),
            Usage::Indices => ("TRIANGLES", encode_triangles(&triangles(&blob.bytes, stride))),
        };
        let mut packed = self.view_of(&stream);
        for (key, value) in [("byteStride", stride.into()), ("count", blob.count.into())] {
            packed.insert(key.into(), value);
        }
        packed.insert("mode".into(), mode.into());
        match blob.filter {
            Filter::Octahedral => drop(packed.insert("filter".into(), "OCTAHEDRAL".into())),
            Filter::Quaternion => drop(packed.insert("filter".into(), "QUATERNION".into())),
            Filter::Exponential => drop(packed.insert("filter".into(), "EXPONENTIAL".into())),
            _ => {}
        }
        self.fallback_size = Some((at + blob.bytes.len()).next_multiple_of(4));
        let view = json!({
            "buffer": 1, "byteOffset": at, "byteLength": blob.bytes.len(),
            "extensions": { MESHOPT[0]: packed },
        });
        match view {
            Value::Object(view) => view,
            _ => unreachable!("made as an object just above"),
        }
    }

    /// Copies the bytes of the kept views and points the views at the copies.
    fn keep_bytes(&mut self, document: &Document<'_>, free: &[bool]) {
        let kept = (0..free.len()).filter(|&view| !free[view]).collect();
        copy_views(document, kept, &mut self.views, (0, &mut self.bytes));
    }
}

/// Decodes indices of two or four bytes into triangles.
fn triangles(bytes: &[u8], size: usize) -> Vec<[u32; 3]> {
    let indices: Vec<u32> = match size {
        2 => bytes.as_chunks().0.iter().map(|&b| u32::from(u16::from_le_bytes(b))).collect(),
        _ => bytes.as_chunks().0.iter().map(|&b| u32::from_le_bytes(b)).collect(),
    };
    indices.as_chunks().0.to_vec()
}

fn indices_of(flags: &[bool]) -> Vec<usize> {
    // Reversed, so that popping yields the lowest index first.
    (0..flags.len()).rev().filter(|&index| flags[index]).collect()
}

fn insert(values: &mut Vec<Value>, free: &mut Vec<usize>, value: Value) -> usize {
    match free.pop() {
        Some(at) => {
            values[at] = value;
            at
        }
        None => {
            values.push(value);
            values.len() - 1
        }
    }
}

/// Removes free entries at the end.
fn drop_last(values: &mut Vec<Value>, free: &mut Vec<usize>) {
    while free.first().is_some_and(|&at| at + 1 == values.len()) {
        values.pop();
        free.remove(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::document::buffers::Buffers;

    #[test]
    fn free_entries_go_unless_an_unknown_extension_may_count_on_their_number() {
        let accessor = |view| {
            let kind = component::F32;
            json!({ "bufferView": view, "componentType": kind, "count": 1, "type": "SCALAR" })
        };
        let view = |at| json!({ "buffer": 0, "byteOffset": at, "byteLength": 4 });
        for (name, left) in [("KHR_lights_punctual", 1), ("UNKNOWN_one", 2)] {
            let mut json = json!({
                "accessors": [accessor(0), accessor(1)], "bufferViews": [view(0), view(4)],
                "skins": [{ "inverseBindMatrices": 1 }], "extensions": { name: {} },
            });
            let buffers = Buffers::new(vec![vec![1; 8]]);
            let source = json.clone();
            let document = Document::new(&source, &buffers).unwrap();
            let builder = BufferBuilder::of(&document, &[true, false]);
            let bytes = builder.finish(json.as_object_mut().unwrap());
            let count = |key: &str| json[key].as_array().unwrap().len();
            assert_eq!([count("accessors"), count("bufferViews")], [left; 2], "{name}");
            assert_eq!(json["skins"][0]["inverseBindMatrices"], left - 1, "{name}");
            let view = json["accessors"][left - 1]["bufferView"].as_u64().unwrap() as usize;
            let start = json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize;
            assert_eq!(bytes[start..][..4], [1; 4], "{name}");
        }
    }
}
