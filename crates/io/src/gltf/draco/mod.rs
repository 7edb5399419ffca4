//! Decompression of primitives compressed with `KHR_draco_mesh_compression`.
//!
//! The rest of the reader sees an uncompressed document.

#[cfg(feature = "draco")]
mod contained;
#[cfg(feature = "draco")]
mod header;
mod primitive;
#[cfg(feature = "draco")]
mod stream;
#[cfg(feature = "draco")]
mod unpack;

use serde::Deserialize;
use serde_json::Value;

use crate::error::ParseError;
use crate::gltf::document::buffers::Buffers;
use crate::gltf::document::extensions::{DRACO, drop_entry, forget_names};
use crate::gltf::document::schema;
use crate::gltf::document::schema::Accessor;
use crate::notes::Note;
use primitive::{Compressed, Extension, Place};
#[cfg(feature = "draco")]
use unpack::unpack;

/// Decompresses every compressed primitive into accessors of a new buffer and removes the extension
/// from the document.
///
/// If the file also holds a primitive uncompressed, that copy is read, since it is not rounded.
/// Strips become triangles, and accessors get the bounds of the decoded values. Returns a note on
/// the decoded primitives.
///
/// # Errors
/// The primitive or accessor, and the reason. Without the feature `draco`, every primitive that has
/// no uncompressed copy.
/// # References
/// [ZSG17]
pub(crate) fn decompress(json: &mut Value, buffers: &mut Buffers) -> Result<Note, ParseError> {
    let compressed = take_extensions(json)?;
    let required: Vec<String> = schema::array(json, "extensionsRequired", "extensionsRequired")?;
    let is_required = required.iter().any(|name| name == DRACO);
    forget_names(json, &[DRACO]);
    if compressed.is_empty() {
        return Ok(decoded(0));
    }
    let accessors: Vec<Accessor> = schema::array(json, "accessors", "accessor")?;
    let (plain, compressed): (Vec<_>, Vec<_>) = compressed
        .into_iter()
        .partition(|c| !is_required && has_fallback(c.place.of(json), &accessors));
    shorten_streams(json, &plain, &compressed);
    unpack(json, buffers, accessors, &compressed)?;
    Ok(decoded(compressed.len()))
}

/// Notes that primitives were decoded and will be written uncompressed.
fn decoded(count: usize) -> Note {
    Note::changed(
        count,
        "primitive decompressed from Draco, which is not written",
        "primitives decompressed from Draco, which is not written",
    )
    .remedied("compress makes a small file")
}

/// Removes the extension from all primitives and returns it.
fn take_extensions(json: &mut Value) -> Result<Vec<Compressed>, ParseError> {
    let mut taken = Vec::new();
    let meshes = json.get_mut("meshes").and_then(Value::as_array_mut);
    for (m, mesh) in meshes.into_iter().flatten().enumerate() {
        let primitives = mesh.get_mut("primitives").and_then(Value::as_array_mut);
        for (p, primitive) in primitives.into_iter().flatten().enumerate() {
            let extensions = primitive.get("extensions");
            let Some(extension) = extensions.and_then(|all| all.get(DRACO)) else { continue };
            let place = Place(m, p);
            if !extension.is_object() {
                return Err(place.wrong(format!("its {DRACO} is not an object")));
            }
            let extension = Extension::deserialize(extension)
                .map_err(|error| place.wrong(format!("its {DRACO}: {error}")))?;
            drop_entry(primitive, DRACO);
            taken.push(Compressed { place, extension });
        }
    }
    Ok(taken)
}

/// Reports whether the file also holds all arrays of a primitive uncompressed.
fn has_fallback(primitive: &Value, accessors: &[Accessor]) -> bool {
    let has_view = |accessor: &Value| {
        let index = accessor.as_u64().map(|index| index as usize);
        let accessor = index.and_then(|index| accessors.get(index));
        accessor.is_some_and(|accessor| accessor.buffer_view.is_some())
    };
    let attributes = primitive["attributes"].as_object();
    attributes.is_some_and(|all| !all.is_empty() && all.values().all(has_view))
        && primitive.get("indices").is_some_and(has_view)
}

/// Shortens the streams that are not decoded to a few bytes, so that they are not written again.
fn shorten_streams(json: &mut Value, plain: &[Compressed], compressed: &[Compressed]) {
    for Compressed { extension: Extension { buffer_view: view, .. }, .. } in plain {
        let is_decoded = compressed.iter().any(|other| other.extension.buffer_view == *view);
        let view = json.get_mut("bufferViews").and_then(|views| views.get_mut(*view));
        let length = view.filter(|_| !is_decoded).and_then(|view| view.get_mut("byteLength"));
        if let Some(length) = length {
            *length = length.as_u64().map_or(0, |length| length.min(4)).into();
        }
    }
}

/// Refuses primitives without an uncompressed copy.
#[cfg(not(feature = "draco"))]
fn unpack(
    _: &mut Value,
    _: &mut Buffers,
    _: Vec<Accessor>,
    compressed: &[Compressed],
) -> Result<(), ParseError> {
    match compressed.first() {
        None => Ok(()),
        Some(Compressed { place, .. }) => Err(crate::gltf::document::extensions::compressed(
            &format!("mesh {}, primitive {}", place.0, place.1),
            DRACO,
        )),
    }
}
