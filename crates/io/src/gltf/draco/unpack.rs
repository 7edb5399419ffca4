//! Accessors filled with the decoded arrays of Draco streams.

use std::borrow::Cow;

use rustc_hash::{FxHashMap, FxHashSet};
use serde_json::{Map, Value};

use super::header::{Ceiling, TOO_LARGE};
use super::primitive::{Compressed, Extension, Place};
use super::stream::{Array, Decoded};
use crate::error::ParseError;
use crate::gltf::document::buffers::{Buffers, Growing};
use crate::gltf::document::extensions::DRACO;
use crate::gltf::document::schema::{Accessor, BufferView};
use crate::gltf::document::{missing, schema};

/// Decompressed bytes allowed for any file. A regular terrain takes a bit per face or less, so the
/// file size is no measure; at this limit the decoder used 720 MiB.
const LEAST_ROOM: usize = 1 << 28;

/// Largest ratio of decompressed to stored bytes of a file, beyond those.
const MAX_EXPANSION: usize = 64;

/// Decodes the streams of primitives into a new buffer and points their accessors there.
///
/// # Errors
/// The primitive, accessor or buffer view, and the reason.
pub(crate) fn unpack(
    json: &mut Value,
    buffers: &mut Buffers,
    accessors: Vec<Accessor>,
    compressed: &[Compressed],
) -> Result<(), ParseError> {
    let mut unpacker = Unpacker {
        views: schema::array(json, "bufferViews", "bufferView")?,
        accessors,
        room: LEAST_ROOM.saturating_add(buffers.stored.saturating_mul(MAX_EXPANSION)),
        buffers,
        filled: FxHashMap::default(),
        taken: FxHashSet::default(),
        bytes: buffers.grow(),
    };
    // Primitives that share a stream usually follow each other.
    let mut last: Option<(usize, Decoded)> = None;
    for Compressed { place, extension } in compressed {
        let view = extension.buffer_view;
        let decoded = match last.take() {
            Some((of, decoded)) if of == view => decoded,
            _ => unpacker.decode(place.of(json), *place, view)?,
        };
        unpacker.unpack(json, *place, extension, &decoded)?;
        last = Some((view, decoded));
    }
    let decompressed = unpacker.bytes;
    buffers.push(decompressed)
}

/// Source of an accessor's data: the buffer view of a stream, and the id of an attribute; `None`
/// for indices.
type Source = (usize, Option<u32>);

/// Decompression under way.
struct Unpacker<'a> {
    buffers: &'a Buffers,
    /// Buffer views and accessors as they are in the file.
    views: Vec<BufferView>,
    accessors: Vec<Accessor>,
    filled: FxHashMap<usize, Source>,
    /// Buffer views of streams that now hold decompressed arrays.
    taken: FxHashSet<usize>,
    /// Decompressed arrays.
    bytes: Growing,
    /// Remaining decompressed bytes allowed.
    room: usize,
}

impl Unpacker<'_> {
    fn decode(
        &mut self,
        primitive: &Value,
        place: Place,
        view: usize,
    ) -> Result<Decoded, ParseError> {
        let stream = self.stream(view)?;
        let indices = primitive["indices"].as_u64();
        let declared = indices.and_then(|index| self.accessors.get(index as usize));
        let of_accessor = declared.map_or(usize::MAX, |accessor| accessor.count);
        // A strip has less than one triangle an index.
        let faces = if is_strip(primitive) { of_accessor } else { of_accessor.div_ceil(3) };
        let ceiling = Ceiling { faces, bytes: self.room };
        let decoded =
            Decoded::from_stream(&stream, ceiling).map_err(|reason| place.wrong(reason))?;
        self.spend(place, decoded.size())?;
        Ok(decoded)
    }

    /// Returns the bytes of a stream.
    fn stream(&self, index: usize) -> Result<Cow<'_, [u8]>, ParseError> {
        let Some(view) = self.views.get(index) else {
            return Err(missing("bufferView", index, self.views.len()));
        };
        let found = self.buffers.part(view.buffer)?.length();
        let (offset, length) = (view.byte_offset, view.byte_length);
        self.buffers.range(view.buffer, offset, length)?.ok_or_else(|| {
            let reason =
                format!("{length} bytes at {offset} exceed its buffer, which has {found} bytes");
            ParseError::part(format!("bufferView {index}"), reason)
        })
    }

    fn spend(&mut self, place: Place, bytes: usize) -> Result<(), ParseError> {
        self.room = self.room.checked_sub(bytes).ok_or_else(|| place.wrong(TOO_LARGE))?;
        Ok(())
    }

    /// Fills the accessors of a primitive with its decoded stream.
    fn unpack(
        &mut self,
        json: &mut Value,
        place: Place,
        extension: &Extension,
        decoded: &Decoded,
    ) -> Result<(), ParseError> {
        let primitive = place.of(json);
        let is_strip = is_strip(primitive);
        if !is_strip && primitive.get("mode").is_some_and(|mode| *mode != 4) {
            return Err(place.wrong("only triangles and strips can be compressed by Draco"));
        }
        let index = |value: Option<&Value>| value.and_then(Value::as_u64).map(|i| i as usize);
        let Some(indices) = index(primitive.get("indices")) else {
            return Err(place.wrong("has no indices, which Draco's streams are decoded to"));
        };
        let mut attributes = Vec::new();
        for (name, &id) in &extension.attributes {
            let Some(accessor) = index(primitive["attributes"].get(name)) else {
                return Err(place.wrong(format!("its {DRACO} has {name}, but it has not")));
            };
            attributes.push((name, id, accessor));
        }
        let declared = self.accessor(indices)?;
        let count = if is_strip { 3 * decoded.faces() } else { declared.count };
        let array = decoded.indices();
        check_count(indices, count, array.count)?;
        let view = extension.buffer_view;
        let indices = self.fill(json, place, (view, None), indices, array)?;
        let mut filled = Map::new();
        for (name, id, accessor) in attributes {
            let declared = self.accessor(accessor)?;
            check_count(accessor, declared.count, decoded.points())?;
            let array = decoded
                .attribute(id, declared)
                .map_err(|reason| place.wrong(format!("attribute {name} {reason}")))?;
            let accessor = self.fill(json, place, (view, Some(id)), accessor, array)?;
            filled.insert(name.clone(), accessor.into());
        }
        let primitive = &mut json["meshes"][place.0]["primitives"][place.1];
        primitive["indices"] = indices.into();
        primitive["mode"] = 4.into();
        for (name, accessor) in filled {
            primitive["attributes"][name] = accessor;
        }
        Ok(())
    }

    fn accessor(&self, index: usize) -> Result<&Accessor, ParseError> {
        self.accessors.get(index).ok_or_else(|| missing("accessor", index, self.accessors.len()))
    }

    /// Fills an accessor, or a copy of it if it was filled from another source, and returns its
    /// index.
    fn fill(
        &mut self,
        json: &mut Value,
        place: Place,
        source: Source,
        accessor: usize,
        array: Array,
    ) -> Result<usize, ParseError> {
        let before = self.filled.get(&accessor).copied();
        if before == Some(source) {
            return Ok(accessor);
        }
        self.spend(place, array.bytes.len())?;
        let view = self.add_view(json, source.0, &array)?;
        let accessors = json["accessors"].as_array_mut().expect("it has an accessor");
        let accessor = match before {
            None => accessor,
            Some(_) => {
                accessors.push(accessors[accessor].clone());
                accessors.len() - 1
            }
        };
        let of = accessors[accessor].as_object_mut().expect("an accessor is an object");
        of.insert("bufferView".into(), view.into());
        of.insert("componentType".into(), array.component.into());
        of.insert("count".into(), array.count.into());
        for (key, bound) in ["min", "max"].into_iter().zip(array.extent()) {
            if of.contains_key(key) {
                of.insert(key.into(), bound.into());
            }
        }
        for key in ["byteOffset", "sparse"] {
            of.shift_remove(key);
        }
        self.filled.insert(accessor, source);
        Ok(accessor)
    }

    /// Adds a view of an array; the first one replaces the view of its stream.
    fn add_view(
        &mut self,
        json: &mut Value,
        stream: usize,
        array: &Array,
    ) -> Result<usize, ParseError> {
        let start = self.bytes.add(&array.bytes)?;
        let mut view = Map::new();
        view.insert("buffer".into(), self.buffers.parts.len().into());
        view.insert("byteOffset".into(), start.into());
        view.insert("byteLength".into(), array.bytes.len().into());
        if let Some(stride) = array.stride {
            view.insert("byteStride".into(), stride.into());
        }
        let views = json["bufferViews"].as_array_mut().expect("the stream has a view");
        if self.taken.insert(stream) {
            views[stream] = view.into();
            return Ok(stream);
        }
        views.push(view.into());
        Ok(views.len() - 1)
    }
}

fn is_strip(primitive: &Value) -> bool {
    primitive["mode"] == 5
}

fn check_count(accessor: usize, declared: usize, decoded: usize) -> Result<(), ParseError> {
    if declared == decoded {
        return Ok(());
    }
    let reason = format!("declares {declared} elements, but its Draco stream has {decoded}");
    Err(ParseError::part(format!("accessor {accessor}"), reason))
}
