//! Checked access to a glTF document: its JSON, buffers and accessors.
//!
//! Reading order: `container` splits the file, `extensions` checks what it requires, `buffers`
//! loads its bytes or leaves them in files (`stored`), `schema` types its JSON. [`Document`] holds these; `accessor` reads arrays from
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
pub mod stored;
pub(crate) mod uri;

use std::borrow::Cow;
use std::cell::Cell;

use serde_json::Value;

use crate::error::ParseError;
use crate::gltf::document::buffers::{BufferPart, Buffers};
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
    pub buffers: &'a Buffers,
    pub accessors: Vec<Accessor>,
    pub views: Vec<BufferView>,
    pub meshes: Vec<schema::GltfMesh>,
    /// Number of values that may still be read, see [`Document::spend`].
    budget: Cell<u64>,
}

impl<'a> Document<'a> {
    /// Parses the accessors, buffer views and meshes of a document and checks them.
    pub fn new(json: &'a Value, buffers: &'a Buffers) -> Result<Self, ParseError> {
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
        let decompressed = buffers.parts.iter().map(BufferPart::length).sum::<usize>() as u64;
        let values = (buffers.stored + 100 * entries) as u64 * MAX_EXPANSION;
        let budget = Cell::new((1 << 16) + values.max(4 * decompressed));
        Ok(Self { json, buffers, accessors, views, meshes, budget })
    }

    /// Returns a buffer view by index.
    pub fn view(&self, index: usize) -> Result<&BufferView, ParseError> {
        self.views.get(index).ok_or_else(|| missing("bufferView", index, self.views.len()))
    }

    /// Returns some bytes of a buffer view; `None` if they are not all in it.
    pub fn part_of_view(
        &self,
        index: usize,
        at: usize,
        length: usize,
    ) -> Result<Option<Cow<'a, [u8]>>, ParseError> {
        let view = self.view(index)?;
        match at.checked_add(length) {
            Some(end) if end <= view.byte_length => {
                self.buffers.range(view.buffer, view.byte_offset + at, length)
            }
            _ => Ok(None),
        }
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

fn check_view(index: usize, view: &BufferView, buffers: &Buffers) -> Result<(), ParseError> {
    let part = format!("bufferView {index}");
    if let Some(extension) = view.extensions.keys().find(|name| compresses(name)) {
        return Err(compressed(&part, extension));
    }
    let found = buffers.part(view.buffer)?.length();
    match view.byte_offset.checked_add(view.byte_length) {
        Some(end) if end <= found => Ok(()),
        _ => {
            let (offset, length) = (view.byte_offset, view.byte_length);
            let reason = format!(
                "{length} bytes at {offset} exceed buffer {}, which has {found} bytes",
                view.buffer
            );
            Err(ParseError::part(part, reason))
        }
    }
}
