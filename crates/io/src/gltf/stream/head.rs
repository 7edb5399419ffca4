//! JSON and buffers of a document whose buffers stay in files.

use std::sync::Arc;

use serde_json::Value;

use crate::error::ParseError;
use crate::gltf::document::buffers::{self, BufferPart};
use crate::gltf::document::component;
use crate::gltf::document::container::{self, Chunks};
use crate::gltf::document::entries::entries;
use crate::gltf::document::stored::{Store, StoreFiles, StoredBytes};
use crate::gltf::read::tiles::Tile;
use crate::gltf::read::{Prepared, parse, prepare};

/// JSON of a file, and the place of its binary chunk.
pub(crate) struct StreamHead {
    json: Value,
    chunk: Option<StoredBytes>,
    /// Bytes of the file itself.
    own: u64,
}

impl StreamHead {
    /// Reads the JSON of a file; `None` if it is a tile with something around its GLB.
    pub fn read(file: Arc<dyn Store>) -> Result<Option<Self>, ParseError> {
        let own = file.length();
        let length = usize::try_from(own).unwrap_or(usize::MAX);
        let whole = StoredBytes::new(file.clone(), 0..own);
        let read = |at: usize, count: usize| {
            let failed = |error: std::io::Error| ParseError::byte(at, error.to_string());
            whole.read(at, count).map_err(failed)
        };
        let begins = read(0, length.min(4))?;
        if [b"b3dm", b"i3dm", b"pnts", b"cmpt"].iter().any(|kind| begins == **kind) {
            return Ok(None);
        }
        if !container::is_glb(&begins) {
            let text = read(0, length)?;
            let json = parse(container::plain_json(&text)?)?;
            return Ok(Some(Self { json, chunk: None, own }));
        }
        let word = |at: usize| Ok(read(at, 4)?.first_chunk().copied().unwrap_or_default());
        let Chunks { json, bin } = container::chunks(length, &word)?;
        let json = parse(container::unpadded(&read(json.start, json.len())?))?;
        let chunk = bin.map(|bin| StoredBytes::new(file, bin.start as u64..bin.end as u64));
        Ok(Some(Self { json, chunk, own }))
    }

    /// Returns the number of bytes of the file and of the files of its buffers, or of its accessors
    /// when nothing is compressed, if that is more.
    pub fn bytes(&self) -> u64 {
        let size = |accessor: &Value| {
            let width = component::width(accessor["type"].as_str()?)?;
            let size = component::size(u32::try_from(accessor["componentType"].as_u64()?).ok()?)?;
            Some(accessor["count"].as_u64()?.saturating_mul((width * size) as u64))
        };
        let expanded = entries(&self.json, "accessors").filter_map(size);
        self.stored_bytes().max(expanded.fold(0, u64::saturating_add))
    }

    fn stored_bytes(&self) -> u64 {
        let is_beside =
            |buffer: &&Value| buffer["uri"].as_str().is_some_and(|uri| !uri.starts_with("data:"));
        let beside = entries(&self.json, "buffers").filter(is_beside);
        let bytes = beside.filter_map(|buffer| buffer["byteLength"].as_u64());
        bytes.fold(self.own, u64::saturating_add)
    }

    /// Finds the buffers, of which `open` opens those in other files, and decompresses what is
    /// compressed into files of its own.
    pub fn load(
        self,
        files: &Arc<dyn StoreFiles>,
        mut open: impl FnMut(&str) -> Option<Arc<dyn Store>>,
    ) -> Result<Prepared, ParseError> {
        let Self { json, chunk, .. } = self;
        let chunk = chunk.map(BufferPart::Stored);
        let mut buffers = buffers::load(&json, chunk, &mut |name| {
            let file = open(name)?;
            let length = file.length();
            Some(BufferPart::Stored(StoredBytes::new(file, 0..length)))
        })?;
        buffers.files = Some(files.clone());
        prepare(json, buffers, &Tile::plain(&[]))
    }
}
