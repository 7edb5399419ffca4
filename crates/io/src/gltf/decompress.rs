//! Buffer views that are compressed by `EXT_meshopt_compression` or `KHR_meshopt_compression`,
//! unfolded at the door: behind it the document is as if it had never been compressed.

use serde::Deserialize;
use serde_json::{Value, json};

use super::document::{Buffers, missing};
use crate::ParseError;
use crate::meshopt::{self, Filter, Layout, Mode};

/// The extensions that are unfolded; the second adds a version and a filter to the first.
pub(super) const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// How many bytes a file may unfold to for each of its own: the views of one may overlap.
///
/// Version 0 cannot do more; planes of zeros reach 1024 in version 1, but no mesh is of those alone.
const UNFOLDING: usize = 64;

/// `bufferViews[i].extensions.EXT_meshopt_compression`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct CompressedView {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: usize,
    count: usize,
    mode: String,
    filter: Option<String>,
}

/// Unfolds every compressed view into a buffer of its own, to which the views then point, and
/// takes the extension out of the document.
///
/// # Errors
/// The view and what is wrong with it or its stream.
pub(super) fn decompress(json: &mut Value, buffers: &mut Buffers) -> Result<(), ParseError> {
    let mut unpacked = Vec::new();
    let target = buffers.bytes.len();
    let views = json.get_mut("bufferViews").and_then(Value::as_array_mut);
    for (i, view) in views.into_iter().flatten().enumerate() {
        let wrong = |reason: String| ParseError::part(format!("bufferView {i}"), reason);
        let Some(packed) = take_extension(view).map_err(wrong)? else { continue };
        let stream = stream(&packed, buffers)?;
        let layout = layout(&packed).map_err(wrong)?;
        let length = layout.count.checked_mul(layout.stride);
        if length.is_none() || view["byteLength"].as_u64() != length.map(|length| length as u64) {
            let (count, stride) = (layout.count, layout.stride);
            let reason = format!("its byteLength is not that of {count} elements of {stride}");
            return Err(wrong(reason));
        }
        let room = (1 << 20) + buffers.stored.saturating_mul(UNFOLDING);
        if length.is_none_or(|length| length > room.saturating_sub(unpacked.len())) {
            let reason = "unfolds to far more than the file has data for";
            return Err(wrong(reason.to_owned()));
        }
        let bytes = meshopt::decode(stream, &layout).map_err(|error| wrong(error.to_string()))?;
        unpacked.resize(unpacked.len().next_multiple_of(8), 0);
        view["buffer"] = target.into();
        view["byteOffset"] = unpacked.len().into();
        unpacked.extend(bytes);
    }
    if !unpacked.is_empty() {
        buffers.bytes.push(unpacked);
    }
    forget(json);
    Ok(())
}

/// Whether a buffer is but a place for what views unfold to.
pub(super) fn is_fallback(buffer: &Value) -> bool {
    MESHOPT.iter().any(|name| buffer["extensions"][*name]["fallback"] == true)
}

/// Whether a compressed view names a buffer as its place.
pub(super) fn is_unfolded_into(json: &Value, buffer: usize) -> bool {
    let views = json.get("bufferViews").and_then(Value::as_array);
    let mut of_buffer = views.into_iter().flatten().filter(|view| view["buffer"] == buffer);
    of_buffer.any(|view| MESHOPT.iter().any(|name| view["extensions"].get(name).is_some()))
}

/// Takes the extension out of a view, if it has it.
fn take_extension(view: &mut Value) -> Result<Option<CompressedView>, String> {
    let Some(name) = MESHOPT.into_iter().find(|name| view["extensions"].get(name).is_some()) else {
        return Ok(None);
    };
    let packed = &view["extensions"][name];
    if !packed.is_object() {
        return Err(format!("its {name} is no object"));
    }
    let packed =
        CompressedView::deserialize(packed).map_err(|error| format!("its {name}: {error}"))?;
    drop_entry(view, name);
    Ok(Some(packed))
}

/// Removes an extension of an object, and the object of extensions when it was the only one.
fn drop_entry(of: &mut Value, name: &str) {
    let Some(of) = of.as_object_mut() else { return };
    if let Some(extensions) = of.get_mut("extensions").and_then(Value::as_object_mut) {
        extensions.shift_remove(name);
        if extensions.is_empty() {
            of.shift_remove("extensions");
        }
    }
}

fn stream<'a>(packed: &CompressedView, buffers: &'a Buffers) -> Result<&'a [u8], ParseError> {
    let CompressedView { buffer, byte_offset: offset, byte_length: length, .. } = *packed;
    let Some(bytes) = buffers.bytes.get(buffer) else {
        return Err(missing("buffer", buffer, buffers.bytes.len()));
    };
    let end = offset.checked_add(length);
    end.and_then(|end| bytes.get(offset..end)).ok_or_else(|| {
        let reason = format!("{length} compressed bytes at {offset}, but it has {}", bytes.len());
        ParseError::part(format!("buffer {buffer}"), reason)
    })
}

fn layout(packed: &CompressedView) -> Result<Layout, String> {
    let mode = match &packed.mode[..] {
        "ATTRIBUTES" => Mode::Attributes,
        "TRIANGLES" => Mode::Triangles,
        "INDICES" => Mode::Indices,
        other => return Err(format!("unknown compression mode {other:?}")),
    };
    let filter = match packed.filter.as_deref() {
        None | Some("NONE") => Filter::None,
        Some("OCTAHEDRAL") => Filter::Octahedral,
        Some("QUATERNION") => Filter::Quaternion,
        Some("EXPONENTIAL") => Filter::Exponential,
        Some("COLOR") => Filter::Color,
        Some(other) => return Err(format!("unknown compression filter {other:?}")),
    };
    let layout = Layout { mode, filter, count: packed.count, stride: packed.byte_stride };
    layout.check()?;
    Ok(layout)
}

/// Takes the extensions off buffers and out of the lists of those in use.
fn forget(json: &mut Value) {
    for name in MESHOPT {
        let buffers = json.get_mut("buffers").and_then(Value::as_array_mut);
        buffers.into_iter().flatten().for_each(|buffer| drop_entry(buffer, name));
    }
    for key in ["extensionsUsed", "extensionsRequired"] {
        let Some(names) = json.get_mut(key).and_then(Value::as_array_mut) else { continue };
        let before = names.len();
        names.retain(|name| !MESHOPT.iter().any(|known| *name == json!(known)));
        if names.is_empty() && before > 0 {
            json.as_object_mut().map(|json| json.shift_remove(key));
        }
    }
}
