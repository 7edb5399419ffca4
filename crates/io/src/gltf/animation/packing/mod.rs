//! Packing of animations: redundant keys are dropped, the others are rounded and stored together.
//!
//! Rotations become normalized shorts, all in one buffer view, translations and scales another, and
//! times a third. Cubic splines, weights of morph targets, pointers and malformed samplers stay
//! unchanged.

pub(crate) mod key_track;
mod keys;
mod rounding;

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use crate::gltf::animation::sampler::AnimatedProperty;
use crate::gltf::document::{Document, component};
use crate::gltf::write::buffer::BufferBuilder;
use crate::gltf::write::settings::Compression;
use key_track::KeyTrack;
use keys::{RoundedTrack, select};
use rounding::{Rounded, round};

/// Location of a sampler: its animation, and its index there.
type SamplerPlace = (usize, usize);

/// Sampler with the encoded keys and the indices of the kept ones.
struct PackedTrack {
    place: SamplerPlace,
    property: AnimatedProperty,
    times: Vec<f32>,
    elements: Rounded,
    kept: Vec<usize>,
}

/// Samplers that get new keys.
#[derive(Default)]
pub(crate) struct PackedAnimations {
    tracks: Vec<PackedTrack>,
    places: BTreeSet<SamplerPlace>,
}

/// Approximate bytes of a key, and of the JSON of an accessor, saved by sharing times.
const KEY_COST: usize = 3;
const ACCESSOR_COST: usize = 130;
/// Limit on the number of times that tracks leave the group of shared keys.
const MOST_ROUNDS: usize = 4;

impl PackedAnimations {
    /// Rounds the samplers of a document and selects their keys.
    pub fn of(document: &Document<'_>, compression: &Compression) -> Self {
        let animations = document.json.get("animations").and_then(Value::as_array);
        let all = animations.into_iter().flatten().enumerate();
        let pack = |(index, json)| pack(document, json, index, compression);
        let tracks: Vec<PackedTrack> = all.flat_map(pack).collect();
        let places = tracks.iter().map(|track| track.place).collect();
        Self { tracks, places }
    }

    /// Reports whether a sampler gets new keys.
    pub fn replaces(&self, place: SamplerPlace) -> bool {
        self.places.contains(&place)
    }

    /// Writes the keys, and makes the samplers refer to them.
    pub fn enter(&self, json: &mut Value, builder: &mut BufferBuilder) {
        let mut arrays = [(); 3].map(|()| KeyArray::default());
        let places: Vec<_> =
            self.tracks.iter().map(|track| arrays_of(track, &mut arrays)).collect();
        let accessors = arrays.map(|array| array.enter(builder));
        for (track, (input, (kind, output))) in self.tracks.iter().zip(places) {
            let sampler = &mut json["animations"][track.place.0]["samplers"][track.place.1];
            sampler["input"] = accessors[TIMES][input].into();
            sampler["output"] = accessors[kind][output].into();
            let is_default = sampler.get("interpolation").is_some_and(|word| word == "LINEAR");
            if let Some(sampler) = sampler.as_object_mut().filter(|_| is_default) {
                sampler.shift_remove("interpolation");
            }
        }
    }
}

/// Packs the samplers of one animation.
fn pack(
    document: &Document<'_>,
    animation: &Value,
    index: usize,
    compression: &Compression,
) -> Vec<PackedTrack> {
    let samplers = animation.get("samplers").and_then(Value::as_array);
    let properties = properties(animation);
    let read = |(at, sampler): (usize, &Value)| {
        let property = properties.get(&at).copied().flatten()?;
        let track = KeyTrack::read(document, sampler, property)?;
        let tolerance = tolerance(&track, compression.animation_degrees);
        let elements = round(&track, tolerance, compression.meshopt)?;
        let rounded = elements.poses.clone();
        Some((at, elements, RoundedTrack { track, rounded, tolerance }))
    };
    let read: Vec<_> = samplers.into_iter().flatten().enumerate().filter_map(read).collect();
    let end = |last: bool| {
        let ends = read.iter().filter_map(|(_, _, rounded)| {
            let times = &rounded.track.times;
            if last { times.last() } else { times.first() }
        });
        ends.copied().reduce(|a, b| if last { a.max(b) } else { a.min(b) })
    };
    let mut range = Range { first: end(false), last: end(true) };
    let kept = kept_keys(&read.iter().map(|(_, _, track)| track).collect::<Vec<_>>(), &mut range);
    read.into_iter()
        .zip(kept)
        .filter_map(|((at, elements, rounded), kept)| {
            let KeyTrack { property, times, .. } = rounded.track;
            Some(PackedTrack { place: (index, at), property, times, elements, kept: kept? })
        })
        .collect()
}

/// First and last time of a clip, unless a track has kept them.
struct Range {
    first: Option<f32>,
    last: Option<f32>,
}

impl Range {
    /// Records that a track keeps these ends.
    fn cover(&mut self, times: &[f32]) {
        if times.first() == self.first.as_ref() {
            self.first = None;
        }
        if times.last() == self.last.as_ref() {
            self.last = None;
        }
    }

    fn needs(&self, times: &[f32]) -> bool {
        let first = self.first.is_some() && times.first() == self.first.as_ref();
        first || self.last.is_some() && times.last() == self.last.as_ref()
    }
}

/// Selects the keys of each track; `None` for unchanged tracks.
///
/// Tracks with the same times keep the same keys, unless separate keys save more than another array
/// of times costs. A constant track keeps its first key, and also its last if the clip would become
/// shorter.
fn kept_keys(tracks: &[&RoundedTrack], range: &mut Range) -> Vec<Option<Vec<usize>>> {
    let mut kept: Vec<Option<Vec<usize>>> = vec![None; tracks.len()];
    let mut groups: BTreeMap<Vec<u32>, Vec<usize>> = BTreeMap::new();
    let mut constant = Vec::new();
    for (i, rounded) in tracks.iter().enumerate() {
        if rounded.is_constant() {
            constant.push(i);
        } else if let Some(own) = select(&[rounded]) {
            kept[i] = Some(own);
            let times = rounded.track.times.iter().map(|time| time.to_bits()).collect();
            groups.entry(times).or_default().push(i);
            range.cover(&rounded.track.times);
        }
    }
    for members in groups.values() {
        share_keys(tracks, members, &mut kept);
    }
    for i in constant {
        let times = &tracks[i].track.times;
        let mut keys = vec![0];
        if times.len() > 1 && range.needs(times) {
            keys.push(times.len() - 1);
        }
        range.cover(times);
        kept[i] = Some(keys);
    }
    kept
}

/// Makes tracks with the same times share keys where that takes fewer bytes.
fn share_keys(tracks: &[&RoundedTrack], members: &[usize], kept: &mut [Option<Vec<usize>>]) {
    let own = |i: usize| kept[i].as_ref().map_or(0, Vec::len);
    let mut shared = members.to_vec();
    for round in 0..MOST_ROUNDS {
        let all: Vec<&RoundedTrack> = shared.iter().map(|&i| tracks[i]).collect();
        let Some(common) = select(&all) else { return };
        let worth = |&i: &usize| KEY_COST * common.len() <= (KEY_COST + 1) * own(i) + ACCESSOR_COST;
        let staying: Vec<usize> = shared.iter().copied().filter(worth).collect();
        if staying.len() == shared.len() || round + 1 == MOST_ROUNDS {
            shared.into_iter().for_each(|i| kept[i] = Some(common.clone()));
            return;
        }
        shared = staying;
    }
}

/// Returns the property that each sampler animates; `None` if its channels disagree.
pub(crate) fn properties(animation: &Value) -> BTreeMap<usize, Option<AnimatedProperty>> {
    let mut properties = BTreeMap::new();
    let channels = animation.get("channels").and_then(Value::as_array);
    for channel in channels.into_iter().flatten() {
        let Some(sampler) = channel.get("sampler").and_then(Value::as_u64) else { continue };
        let target = channel.get("target");
        let is_plain = target.is_some_and(|target| target.get("extensions").is_none());
        let path = target.and_then(|target| target.get("path")?.as_str());
        let property = path.filter(|_| is_plain).and_then(AnimatedProperty::named);
        let property = property.filter(|&property| property != AnimatedProperty::Weights);
        let known = properties.entry(sampler as usize).or_insert(property);
        if *known != property {
            *known = None;
        }
    }
    properties
}

/// Returns the distance by which the poses of a track may move, as points.
///
/// A rotation by an angle moves its quaternion by the chord of half of it. The same angle moves a
/// vector by its arc, so that a child moves as far as by the rotation of its parent.
fn tolerance(track: &KeyTrack, degrees: f64) -> f64 {
    let angle = degrees.to_radians();
    let length = |pose: &[f64; 4]| pose.iter().map(|x| x * x).sum::<f64>().sqrt();
    match track.is_rotation() {
        true => 2.0 * (angle / 4.0).sin(),
        false => angle * track.poses.iter().map(length).fold(0.0, f64::max),
    }
}

/// Array of times, of rotations or of vectors, in one buffer view.
#[derive(Default)]
struct KeyArray {
    bytes: Vec<u8>,
    /// Accessors without their buffer view.
    accessors: Vec<Value>,
    /// Accessors by the bytes of their elements.
    known: BTreeMap<Vec<u8>, usize>,
    stride: usize,
    filter: crate::meshopt::Filter,
}

const TIMES: usize = 0;
const ROTATIONS: usize = 1;
const VECTORS: usize = 2;

/// Appends the kept keys of a track, and returns the accessors of its times and of its poses with
/// their array.
fn arrays_of(track: &PackedTrack, arrays: &mut [KeyArray; 3]) -> (usize, (usize, usize)) {
    let times: Vec<f32> = track.kept.iter().map(|&key| track.times[key]).collect();
    let bytes = times.iter().flat_map(|time| time.to_le_bytes()).collect();
    let mut accessor = json!({ "componentType": component::F32, "type": "SCALAR" });
    accessor["min"] = json!(times[..1]);
    accessor["max"] = json!(times[times.len() - 1..]);
    arrays[TIMES].stride = 4;
    let input = arrays[TIMES].add(bytes, accessor);
    let Rounded { bytes, stride, filter, .. } = &track.elements;
    let elements = track.kept.iter().flat_map(|&key| &bytes[key * stride..][..*stride]);
    let (kind, accessor) = match track.property {
        AnimatedProperty::Rotation => (
            ROTATIONS,
            json!({ "componentType": component::I16, "type": "VEC4", "normalized": true }),
        ),
        _ => (VECTORS, json!({ "componentType": component::F32, "type": "VEC3" })),
    };
    (arrays[kind].stride, arrays[kind].filter) = (*stride, *filter);
    (input, (kind, arrays[kind].add(elements.copied().collect(), accessor)))
}

impl KeyArray {
    /// Appends elements unless they exist, and returns the index of their accessor.
    fn add(&mut self, bytes: Vec<u8>, mut accessor: Value) -> usize {
        if let Some(&known) = self.known.get(&bytes) {
            return known;
        }
        if !self.bytes.is_empty() {
            accessor["byteOffset"] = self.bytes.len().into();
        }
        accessor["count"] = (bytes.len() / self.stride).into();
        self.bytes.extend_from_slice(&bytes);
        self.accessors.push(accessor);
        self.known.insert(bytes, self.accessors.len() - 1);
        self.accessors.len() - 1
    }

    /// Writes the array, and returns the indices of its accessors.
    fn enter(self, builder: &mut BufferBuilder) -> Vec<usize> {
        if self.bytes.is_empty() {
            return Vec::new();
        }
        let view = builder.add_keys(&self.bytes, self.stride, self.filter);
        let enter = |mut accessor: Value| {
            accessor["bufferView"] = view.into();
            builder.add_accessor(accessor)
        };
        self.accessors.into_iter().map(enter).collect()
    }
}
