//! Tracks of animations for packing: their keys, and the poses between them.

use glam::DQuat;
use serde_json::Value;

use crate::gltf::animation::sampler::{AnimatedProperty, Interpolation, Sampler};
use crate::gltf::animation::slerp;
use crate::gltf::document::Document;

/// Value of a sampler: a unit quaternion, or a vector with a fourth component of zero.
pub(crate) type KeyValue = [f64; 4];

/// Keys of a sampler, at least one, in order of time.
#[derive(Clone, Debug)]
pub(crate) struct KeyTrack {
    pub property: AnimatedProperty,
    /// If true, each key holds until the next; if not, poses in between are interpolated.
    pub is_step: bool,
    /// Seconds, strictly increasing.
    pub times: Vec<f32>,
    pub poses: Vec<KeyValue>,
}

impl KeyTrack {
    /// Reads a sampler; `None` if it is malformed, a cubic spline, or has rotations that are not
    /// unit quaternions.
    pub fn read(
        document: &Document<'_>,
        sampler: &Value,
        property: AnimatedProperty,
    ) -> Option<Self> {
        let Sampler { interpolation, times, output } = Sampler::read(document, sampler).ok()?;
        let is_rotation = property == AnimatedProperty::Rotation;
        let sound = interpolation != Interpolation::CubicSpline
            && output.width == if is_rotation { 4 } else { 3 }
            && times.len() == output.count()
            && times[0] >= 0.0;
        if !sound {
            return None;
        }
        let pose = |key: &[f32]| {
            let mut pose: KeyValue = [0.0; 4];
            pose.iter_mut().zip(key).for_each(|(to, &from)| *to = f64::from(from));
            if is_rotation { unit(pose) } else { Some(pose) }
        };
        let poses = output.values.chunks_exact(output.width).map(pose).collect::<Option<_>>()?;
        Some(Self { property, is_step: interpolation == Interpolation::Step, times, poses })
    }

    /// Returns true if the poses are unit quaternions.
    pub fn is_rotation(&self) -> bool {
        self.property == AnimatedProperty::Rotation
    }

    /// Interpolates between two keys; rotations take the shorter way.
    pub fn between(&self, a: KeyValue, b: KeyValue, part: f64) -> KeyValue {
        match self.is_rotation() {
            true => slerp(a, nearer(a, b), part),
            false => mixed(a, b, [1.0 - part, part]),
        }
    }

    /// Returns the pose at a time in seconds, clamped to the first and last key.
    #[cfg(test)]
    pub fn at(&self, time: f64) -> KeyValue {
        let after = self.times.partition_point(|&key| f64::from(key) <= time);
        let Some(key) = after.checked_sub(1) else { return self.poses[0] };
        if after == self.times.len() || self.is_step {
            return self.poses[key];
        }
        let [from, to] = [key, after].map(|key| f64::from(self.times[key]));
        self.between(self.poses[key], self.poses[after], (time - from) / (to - from))
    }
}

/// Normalizes a quaternion; `None` if its length differs from 1 by more than rounding.
fn unit(q: KeyValue) -> Option<KeyValue> {
    let length = dot(q, q).sqrt();
    ((length - 1.0).abs() <= 1e-3).then(|| q.map(|x| x / length))
}

pub(crate) fn dot(a: KeyValue, b: KeyValue) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns the distance of two poses as points.
pub(crate) fn distance(a: KeyValue, b: KeyValue) -> f64 {
    let off = mixed(a, b, [1.0, -1.0]);
    dot(off, off).sqrt()
}

/// Returns the sign of a quaternion that is nearer to another; both signs are the same rotation.
pub(crate) fn nearer(to: KeyValue, q: KeyValue) -> KeyValue {
    if dot(to, q) < 0.0 { q.map(|x| -x) } else { q }
}

/// Returns the angle between two unit quaternions on the sphere, half the angle of rotation between
/// them.
pub(crate) fn arc(a: KeyValue, b: KeyValue) -> f64 {
    2.0 * (0.5 * distance(a, b)).min(1.0).asin()
}

/// Interpolates along the arc between two unit quaternions, without choosing signs.
pub(crate) fn slerp(a: KeyValue, b: KeyValue, part: f64) -> KeyValue {
    let [from, to] = [a, b].map(DQuat::from_array);
    slerp::slerp(from, to, part).to_array()
}

fn mixed(a: KeyValue, b: KeyValue, [s, t]: [f64; 2]) -> KeyValue {
    std::array::from_fn(|i| s * a[i] + t * b[i])
}
