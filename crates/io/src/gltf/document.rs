//! Checked access to a glTF document: its JSON, buffers and accessors.

use std::cell::Cell;

use serde_json::Value;

use super::decompress::{self, MESHOPT};
use super::draco::DRACO;
use super::instancing::INSTANCING;
use super::schema::{self, Accessor, Buffer, BufferView};
use super::uri::{self, Uri};
use crate::{ParseError, Resolve};

/// Largest number of values that a file may expand to per byte.
///
/// A plain file needs one. Accessors shared by many primitives, strips and accessors without data
/// take more; instanced test scenes stay below 4.
const MAX_EXPANSION: u64 = 64;

/// Buffers of a document.
#[derive(Debug)]
pub(super) struct Buffers {
    pub bytes: Vec<Vec<u8>>,
    /// Bytes in the file, before decompression.
    pub stored: usize,
}

impl Buffers {
    pub fn new(bytes: Vec<Vec<u8>>) -> Self {
        Self { stored: bytes.iter().map(Vec::len).sum(), bytes }
    }
}

/// JSON document with its typed entries and its buffers.
pub(super) struct Document<'a> {
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

    /// Counts `values` numbers about to be read towards a limit that grows with the file size, so
    /// that a small file cannot exhaust memory.
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
pub(super) fn missing(entry: &str, index: usize, count: usize) -> ParseError {
    ParseError::part(format!("{entry} {index}"), format!("does not exist: there are only {count}"))
}

/// Rejects other versions of glTF and unknown required extensions.
pub(super) fn check_head(json: &Value) -> Result<(), ParseError> {
    let version = json.pointer("/asset/version").and_then(Value::as_str).unwrap_or("");
    if !version.starts_with("2.") {
        let reason = format!("glTF version {version:?}; only 2.0 is supported");
        return Err(ParseError::part("asset", reason));
    }
    let required: Vec<String> = schema::array(json, "extensionsRequired", "extensionsRequired")?;
    match required.iter().find(|name| !is_understood(name)) {
        None => Ok(()),
        Some(name) if compresses(name) => Err(compressed("extensionsRequired", name)),
        Some(name) => {
            let reason = format!("the file requires the extension {name}, which is not supported");
            Err(ParseError::part("extensionsRequired", reason))
        }
    }
}

/// Reports whether an extension is supported or leaves the geometry alone.
fn is_understood(name: &str) -> bool {
    const GEOMETRY: [&str; 5] =
        ["KHR_mesh_quantization", "MSFT_lod", INSTANCING, MESHOPT[0], MESHOPT[1]];
    const OTHERS: [&str; 12] = [
        "KHR_materials_",
        "KHR_texture_",
        "KHR_lights_",
        "KHR_animation_",
        "KHR_xmp",
        "KHR_audio",
        "EXT_texture_",
        "EXT_lights_",
        "MSFT_texture_",
        "MSFT_packing_",
        "MSFT_screencoverage",
        "EXT_materials_",
    ];
    let is_draco = cfg!(feature = "draco") && name == DRACO;
    is_draco || GEOMETRY.contains(&name) || OTHERS.iter().any(|prefix| name.starts_with(prefix))
}

fn compresses(name: &str) -> bool {
    name.contains("draco") || name.contains("meshopt")
}

/// Error for geometry in an unsupported compressed form.
pub(super) fn compressed(part: &str, extension: &str) -> ParseError {
    let reason = match extension {
        DRACO => format!(
            "compressed with {DRACO}, which needs a build with the feature `draco`; build with \
             `--features draco`, or export the file without Draco"
        ),
        _ => format!("compressed with {extension}, which is not supported; decompress it first"),
    };
    ParseError::part(part, reason)
}

/// Loads the buffers of a document from the GLB chunk, data URIs and files. Fallback buffers are
/// left empty.
pub(super) fn buffers(
    json: &Value,
    chunk: Option<&[u8]>,
    resolve: Resolve<'_>,
) -> Result<Buffers, ParseError> {
    let declared: Vec<Buffer> = schema::array(json, "buffers", "buffer")?;
    let load = |(i, buffer): (usize, &Buffer)| {
        let named = buffer.uri.is_some() || (i == 0 && chunk.is_some());
        if decompress::is_fallback(&json["buffers"][i])
            || !named && decompress::is_decompression_target(json, i)
        {
            return Ok(Vec::new());
        }
        let wrong = |reason| ParseError::part(format!("buffer {i}"), reason);
        let bytes = match (&buffer.uri, chunk) {
            (None, Some(chunk)) if i == 0 => chunk.to_vec(),
            (None, _) => return Err(wrong("has neither a URI nor a GLB chunk".to_owned())),
            (Some(uri), _) => match uri::parse(uri).map_err(wrong)? {
                Uri::Data(bytes) => bytes,
                Uri::File(name) => resolve(&name).ok_or_else(|| {
                    wrong(format!("refers to the file {name:?}, which cannot be read"))
                })?,
            },
        };
        if bytes.len() < buffer.byte_length {
            let (found, expected) = (bytes.len(), buffer.byte_length);
            return Err(wrong(format!("has {found} bytes, but {expected} are declared")));
        }
        Ok(bytes)
    };
    let bytes = declared.iter().enumerate().map(load).collect::<Result<_, _>>()?;
    Ok(Buffers::new(bytes))
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
