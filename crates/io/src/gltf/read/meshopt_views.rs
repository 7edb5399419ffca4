//! Decompression of buffer views compressed with `EXT_meshopt_compression` or
//! `KHR_meshopt_compression`.
//!
//! The rest of the reader sees an uncompressed document.

use std::borrow::Cow;

use serde::Deserialize;
use serde_json::Value;

use crate::error::ParseError;
use crate::gltf::document::buffers::Buffers;
use crate::gltf::document::extensions::{MESHOPT, drop_entry, forget_names};
use crate::meshopt;
use crate::meshopt::{Filter, Layout, Mode};

/// Largest ratio of decompressed to stored bytes of a file, whose views may overlap.
///
/// Version 0 cannot exceed it. Planes of zeros reach 1024 in version 1, but no real mesh consists
/// of those alone.
const MAX_EXPANSION: usize = 64;

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

/// Decompresses every compressed view into a new buffer, points the views at it and removes the
/// extension from the document.
///
/// # Errors
/// The view, and the reason.
pub(crate) fn decompress(json: &mut Value, buffers: &mut Buffers) -> Result<(), ParseError> {
    let mut decompressed = buffers.grow();
    let target = buffers.parts.len();
    let views = json.get_mut("bufferViews").and_then(Value::as_array_mut);
    for (i, view) in views.into_iter().flatten().enumerate() {
        let wrong = |reason: String| ParseError::part(format!("bufferView {i}"), reason);
        let Some(compressed) = take_extension(view).map_err(wrong)? else { continue };
        let stream = stream(&compressed, buffers)?;
        let layout = layout(&compressed).map_err(wrong)?;
        let length = layout.count.checked_mul(layout.stride);
        if length.is_none() || view["byteLength"].as_u64() != length.map(|length| length as u64) {
            let (count, stride) = (layout.count, layout.stride);
            let reason =
                format!("its byteLength does not match {count} elements of {stride} bytes");
            return Err(wrong(reason));
        }
        let room = (1 << 20) + buffers.stored.saturating_mul(MAX_EXPANSION);
        if length.is_none_or(|length| length > room.saturating_sub(decompressed.len())) {
            let reason = "decompresses to far more than the file has data for";
            return Err(wrong(reason.to_owned()));
        }
        let bytes = meshopt::decode(&stream, &layout).map_err(|error| wrong(error.to_string()))?;
        view["buffer"] = target.into();
        view["byteOffset"] = decompressed.add(&bytes)?.into();
    }
    buffers.push(decompressed)?;
    forget(json);
    Ok(())
}

/// Removes the compression extension from a view and returns it, if any.
fn take_extension(view: &mut Value) -> Result<Option<CompressedView>, String> {
    let Some(name) = MESHOPT.into_iter().find(|name| view["extensions"].get(name).is_some()) else {
        return Ok(None);
    };
    let compressed = &view["extensions"][name];
    if !compressed.is_object() {
        return Err(format!("its {name} is not an object"));
    }
    let compressed =
        CompressedView::deserialize(compressed).map_err(|error| format!("its {name}: {error}"))?;
    drop_entry(view, name);
    Ok(Some(compressed))
}

fn stream<'a>(
    compressed: &CompressedView,
    buffers: &'a Buffers,
) -> Result<Cow<'a, [u8]>, ParseError> {
    let CompressedView { buffer, byte_offset: offset, byte_length: length, .. } = *compressed;
    let found = buffers.part(buffer)?.length();
    buffers.range(buffer, offset, length)?.ok_or_else(|| {
        let reason =
            format!("the compressed range of {length} bytes at {offset} exceeds its {found} bytes");
        ParseError::part(format!("buffer {buffer}"), reason)
    })
}

fn layout(compressed: &CompressedView) -> Result<Layout, String> {
    let mode = match &compressed.mode[..] {
        "ATTRIBUTES" => Mode::Attributes,
        "TRIANGLES" => Mode::Triangles,
        "INDICES" => Mode::Indices,
        other => return Err(format!("unknown compression mode {other:?}")),
    };
    let filter = match compressed.filter.as_deref() {
        None | Some("NONE") => Filter::None,
        Some("OCTAHEDRAL") => Filter::Octahedral,
        Some("QUATERNION") => Filter::Quaternion,
        Some("EXPONENTIAL") => Filter::Exponential,
        Some("COLOR") => Filter::Color,
        Some(other) => return Err(format!("unknown compression filter {other:?}")),
    };
    let layout = Layout { mode, filter, count: compressed.count, stride: compressed.byte_stride };
    layout.check()?;
    Ok(layout)
}

/// Removes the extensions from the buffers and from the lists of the document.
fn forget(json: &mut Value) {
    for name in MESHOPT {
        let buffers = json.get_mut("buffers").and_then(Value::as_array_mut);
        buffers.into_iter().flatten().for_each(|buffer| drop_entry(buffer, name));
    }
    forget_names(json, &MESHOPT);
}
