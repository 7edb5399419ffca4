//! Checked access to a glTF document: its JSON, buffers and accessors.
//!
//! Reading order: `container` splits the file, `extensions` checks what it requires, `buffers`
//! loads its bytes, `schema` types its JSON. [`Document`] holds these; `accessor` reads arrays from
//! it.

pub(crate) mod accessor;
pub(crate) mod buffers;
pub(crate) mod component;
pub(crate) mod container;
pub(crate) mod entries;
pub(crate) mod extensions;
pub(crate) mod facts;
pub(crate) mod primitive_kind;
pub(crate) mod schema;
pub(crate) mod source;
pub(crate) mod uri;

use std::cell::Cell;

use serde_json::Value;

use crate::error::ParseError;
use crate::gltf::document::buffers::Buffers;
use crate::gltf::document::extensions::{compressed, compresses};
use schema::{Accessor, BufferView};

/// Largest number of values that a file may expand to per byte.
///
/// A plain file needs one. Accessors shared by many primitives, strips and accessors without data
/// take more; instanced test scenes stay below 4.
const MAX_EXPANSION: u64 = 64;

/// JSON document with its typed entries and its buffers.
pub(crate) struct Document<'a> {
    pub json: &'a Value,
    pub buffers: &'a [Vec<u8>],
    pub accessors: Vec<Accessor>,
    pub views: Vec<BufferView>,
    pub meshes: Vec<schema::GltfMesh>,
    /// Number of values that may still be read, see [`Document::spend`].
    budget: Cell<u64>,
}

impl<'a> Document<'a> {
    /// Parses the accessors, buffer views and meshes of a document and checks them.
    pub fn new(json: &'a Value, buffers: &'a Buffers) -> Result<Self, ParseError> {
        let Buffers { bytes: buffers, stored } = buffers;
        let views: Vec<BufferView> = schema::array(json, "bufferViews", "bufferView")?;
        for (i, view) in views.iter().enumerate() {
            check_view(i, view, buffers)?;
        }
        let accessors: Vec<Accessor> = schema::array(json, "accessors", "accessor")?;
        let meshes: Vec<schema::GltfMesh> = schema::array(json, "meshes", "mesh")?;
        for (i, mesh) in json["meshes"].as_array().into_iter().flatten().enumerate() {
            // Deserializing the struct would accept arrays as well.
            if !mesh["primitives"].as_array().is_some_and(|p| p.iter().all(Value::is_object)) {
                return Err(ParseError::part(
                    format!("mesh {i}"),
                    "has a primitive that is not an object",
                ));
            }
        }
        // An entry of the document takes about a hundred bytes of JSON.
        let entries = accessors.len() + meshes.iter().map(|m| m.primitives.len()).sum::<usize>();
        // Decompression has used part of the allowance, but each byte it made may be a value.
        let decompressed = buffers.iter().map(Vec::len).sum::<usize>() as u64;
        let values = (stored + 100 * entries) as u64 * MAX_EXPANSION;
        let budget = Cell::new((1 << 16) + values.max(4 * decompressed));
        Ok(Self { json, buffers, accessors, views, meshes, budget })
    }

    /// Returns a buffer view by index, with its bytes.
    pub fn view(&self, index: usize) -> Result<(&BufferView, &'a [u8]), ParseError> {
        let Some(view) = self.views.get(index) else {
            return Err(missing("bufferView", index, self.views.len()));
        };
        Ok((view, &self.buffers[view.buffer][view.byte_offset..][..view.byte_length]))
    }

    /// Counts numbers about to be read against a limit that grows with the file size, so that a
    /// small file cannot exhaust memory.
    pub fn spend(&self, part: &str, values: usize) -> Result<(), ParseError> {
        let left = self.budget.get().checked_sub(values as u64).ok_or_else(|| {
            let reason = format!("{values} values here are far more than the file has data for");
            ParseError::part(part, reason)
        })?;
        self.budget.set(left);
        Ok(())
    }
}

/// Error for an index without an entry.
pub(crate) fn missing(entry: &str, index: usize, count: usize) -> ParseError {
    ParseError::part(format!("{entry} {index}"), format!("does not exist: there are only {count}"))
}

fn check_view(index: usize, view: &BufferView, buffers: &[Vec<u8>]) -> Result<(), ParseError> {
    let part = format!("bufferView {index}");
    if let Some(extension) = view.extensions.keys().find(|name| compresses(name)) {
        return Err(compressed(&part, extension));
    }
    let Some(buffer) = buffers.get(view.buffer) else {
        return Err(missing("buffer", view.buffer, buffers.len()));
    };
    match view.byte_offset.checked_add(view.byte_length) {
        Some(end) if end <= buffer.len() => Ok(()),
        _ => {
            let (offset, length, found) = (view.byte_offset, view.byte_length, buffer.len());
            let reason = format!(
                "{length} bytes at {offset} exceed buffer {}, which has {found} bytes",
                view.buffer
            );
            Err(ParseError::part(part, reason))
        }
    }
}
