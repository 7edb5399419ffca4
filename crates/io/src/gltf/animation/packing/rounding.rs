//! Rounding of the poses of an animation to their stored form.

use super::key_track::{KeyTrack, KeyValue, distance, nearer};
use crate::meshopt::{Filter, apply_filter, encode_exponential, encode_quaternion};

/// Poses of all keys of a track, encoded and decoded again.
pub(crate) struct Rounded {
    /// Elements, encoded for the filter.
    pub bytes: Vec<u8>,
    /// Bytes of an element.
    pub stride: usize,
    pub filter: Filter,
    pub poses: Vec<KeyValue>,
}

/// Fewest and most bits of a component of a rotation.
const LEAST_BITS: u32 = 8;
const MOST_BITS: u32 = 16;
/// Fraction of the tolerance for rounding; the rest is for dropped keys.
const ROUNDING: f64 = 0.6;

/// Rounds the poses of a track to as few bits as the tolerance allows: with `filters` for a meshopt
/// stream, without to shorts and floats. `None` if there is no such form.
pub(crate) fn round(track: &KeyTrack, tolerance: f64, filters: bool) -> Option<Rounded> {
    match track.is_rotation() {
        true => rotations(track, tolerance, filters),
        false => vectors(track, tolerance, filters),
    }
}

fn rotations(track: &KeyTrack, tolerance: f64, filters: bool) -> Option<Rounded> {
    if !filters {
        let short = |x: &f64| (x * 32767.0).round() as i16;
        let bytes: Vec<u8> =
            track.poses.iter().flatten().flat_map(|x| short(x).to_le_bytes()).collect();
        let poses = decoded_rotations(&bytes);
        return Some(Rounded { bytes, stride: 8, filter: Filter::None, poses });
    }
    let with_bits = |bits| {
        let bytes = encode_quaternion(&track.poses, bits);
        let mut decoded = bytes.clone();
        apply_filter(Filter::Quaternion, 8, &mut decoded);
        let poses = decoded_rotations(&decoded);
        Rounded { bytes, stride: 8, filter: Filter::Quaternion, poses }
    };
    let is_close = |rounded: &Rounded| {
        let mut pairs = rounded.poses.iter().zip(&track.poses);
        pairs.all(|(&a, &b)| distance(a, nearer(a, b)) <= ROUNDING * tolerance)
    };
    (LEAST_BITS..=MOST_BITS).map(with_bits).find(is_close)
}

/// Decodes normalized shorts to unit quaternions.
fn decoded_rotations(bytes: &[u8]) -> Vec<KeyValue> {
    let pose = |element: &[u8; 8]| {
        let shorts = element.as_chunks::<2>().0;
        let q: KeyValue = std::array::from_fn(|k| f64::from(i16::from_le_bytes(shorts[k])));
        let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        q.map(|x| x / length.max(1.0))
    };
    bytes.as_chunks().0.iter().map(pose).collect()
}

fn vectors(track: &KeyTrack, tolerance: f64, filters: bool) -> Option<Rounded> {
    let floats: Vec<f32> =
        track.poses.iter().flat_map(|pose| &pose[..3]).map(|&x| x as f32).collect();
    if !filters {
        let bytes = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
        return Some(Rounded {
            bytes,
            stride: 12,
            filter: Filter::None,
            poses: track.poses.clone(),
        });
    }
    // The error is at most half a step along each axis.
    let step = 2.0 / 3f64.sqrt() * ROUNDING * tolerance;
    let bytes = encode_exponential(&floats, if step > 0.0 { step } else { 1.0 })?;
    let mut decoded = bytes.clone();
    apply_filter(Filter::Exponential, 12, &mut decoded);
    let values: Vec<f64> =
        decoded.as_chunks().0.iter().map(|&b| f64::from(f32::from_le_bytes(b))).collect();
    let poses = values.as_chunks::<3>().0.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
    Some(Rounded { bytes, stride: 12, filter: Filter::Exponential, poses })
}
