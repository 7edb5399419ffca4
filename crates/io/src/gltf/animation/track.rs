//! Tracks of animations: the value of one property over time.

use glam::{DQuat, DVec4};
use serde_json::Value;

use super::sampler::{Interpolation, Sampler};
use super::slerp::slerp;
use crate::gltf::document::Document;

/// Type of a track's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// Vectors or lists of weights of this length.
    Numbers(usize),
    /// Unit quaternions.
    Rotation,
}

/// Values of one property at increasing times.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    times: Vec<f64>,
    interpolation: Interpolation,
    quantity: Quantity,
    /// Values of all keys; for splines, tangent, value and tangent of each.
    values: Vec<f64>,
}

/// Shortest and longest length of a quaternion accepted as unit, as for nodes.
const UNIT: std::ops::Range<f64> = 0.5..2.0;

impl Quantity {
    fn width(self) -> usize {
        match self {
            Self::Numbers(width) => width,
            Self::Rotation => 4,
        }
    }
}

impl Track {
    /// Reads a sampler of an animation.
    ///
    /// # Errors
    /// Errors of [`Sampler::read`], a wrong number of values, rotations of invalid length.
    pub(crate) fn read(
        document: &Document<'_>,
        sampler: &Value,
        quantity: Quantity,
    ) -> Result<Self, String> {
        let Sampler { interpolation, times, output } = Sampler::read(document, sampler)?;
        let times: Vec<f64> = times.into_iter().map(f64::from).collect();
        let values: Vec<f64> = output.values.into_iter().map(f64::from).collect();
        let of_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let expected = times.len().saturating_mul(of_key).saturating_mul(quantity.width());
        let fits = matches!(quantity, Quantity::Numbers(_)) || output.width == 4;
        if !fits || values.len() != expected {
            let found = values.len();
            return Err(format!("its output has {found} numbers instead of {expected}"));
        }
        let this = Self { times, interpolation, quantity, values };
        let is_turned = |key: &usize| UNIT.contains(&quaternion(this.key(*key)).length());
        match (0..this.times.len()).find(|key| quantity == Quantity::Rotation && !is_turned(key)) {
            Some(key) => Err(format!("its rotation at key {key} is no unit quaternion")),
            None => Ok(this),
        }
    }

    pub(crate) fn times(&self) -> &[f64] {
        &self.times
    }

    /// Returns the value at a time, clamped to the first and last key.
    pub(crate) fn at(&self, time: f64) -> Vec<f64> {
        let after = self.times.partition_point(|&key| key <= time);
        let Some(before) = after.checked_sub(1) else { return self.unit(self.key(0).to_vec()) };
        if after == self.times.len() || self.interpolation == Interpolation::Step {
            return self.unit(self.key(before).to_vec());
        }
        let span = self.times[after] - self.times[before];
        let part = (time - self.times[before]) / span;
        match (self.interpolation, self.quantity) {
            (Interpolation::CubicSpline, _) => self.unit(self.spline(before, span, part)),
            (_, Quantity::Rotation) => {
                let [from, to] = [before, after].map(|key| quaternion(self.key(key)).normalize());
                turned(from, to, part).to_array().to_vec()
            }
            (_, Quantity::Numbers(_)) => {
                let pairs = self.key(before).iter().zip(self.key(after));
                pairs.map(|(from, to)| from + (to - from) * part).collect()
            }
        }
    }

    /// Returns the value of a key.
    fn key(&self, key: usize) -> &[f64] {
        match self.interpolation {
            Interpolation::CubicSpline => self.group(3 * key + 1),
            _ => self.group(key),
        }
    }

    /// Returns a value or tangent by its index among all.
    fn group(&self, at: usize) -> &[f64] {
        let width = self.quantity.width();
        &self.values[at * width..][..width]
    }

    /// Evaluates the Hermite spline from a key to the next one, `span` seconds apart.
    fn spline(&self, key: usize, span: f64, t: f64) -> Vec<f64> {
        let (t2, t3) = (t * t, t * t * t);
        let leaving = self.group(3 * key + 2);
        let [arriving, to] = [3 * key + 3, 3 * key + 4].map(|at| self.group(at));
        let value = |k: usize| {
            (2.0 * t3 - 3.0 * t2 + 1.0) * self.key(key)[k]
                + span * (t3 - 2.0 * t2 + t) * leaving[k]
                + (3.0 * t2 - 2.0 * t3) * to[k]
                + span * (t3 - t2) * arriving[k]
        };
        (0..self.quantity.width()).map(value).collect()
    }

    /// Normalizes a quaternion; returns the identity for zero.
    fn unit(&self, value: Vec<f64>) -> Vec<f64> {
        match self.quantity {
            Quantity::Numbers(_) => value,
            Quantity::Rotation => {
                let direction = DVec4::from_slice(&value).try_normalize();
                direction.unwrap_or(DVec4::W).to_array().to_vec()
            }
        }
    }
}

fn quaternion(values: &[f64]) -> DQuat {
    DQuat::from_slice(values)
}

/// Interpolates between two rotations along the shorter arc.
fn turned(from: DQuat, to: DQuat, part: f64) -> DQuat {
    slerp(from, if from.dot(to) < 0.0 { -to } else { to }, part)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(interpolation: Interpolation, quantity: Quantity, values: &[f64]) -> Track {
        Track { times: vec![1.0, 3.0], interpolation, quantity, values: values.to_vec() }
    }

    #[test]
    fn values_before_and_after_all_keys_are_those_of_the_ends() {
        let linear = track(Interpolation::Linear, Quantity::Numbers(1), &[10.0, 20.0]);
        let at = |time| linear.at(time)[0];
        assert_eq!([0.0, 1.0, 1.5, 3.0, 9.0].map(at), [10.0, 10.0, 12.5, 20.0, 20.0]);
        let step = track(Interpolation::Step, Quantity::Numbers(1), &[10.0, 20.0]);
        assert_eq!([0.0, 2.99, 3.0].map(|time| step.at(time)[0]), [10.0, 10.0, 20.0]);
    }

    #[test]
    fn splines_leave_and_arrive_with_their_tangents() {
        // Tangent, value, tangent of each key; slopes are per second.
        let values = [0.0, 0.0, 3.0, -5.0, 1.0, 0.0];
        let spline = track(Interpolation::CubicSpline, Quantity::Numbers(1), &values);
        let slope = |time: f64| (spline.at(time + 1e-6)[0] - spline.at(time - 1e-6)[0]) / 2e-6;
        assert!((slope(1.0 + 2e-6) - 3.0).abs() < 1e-4 && (slope(3.0 - 2e-6) + 5.0).abs() < 1e-4);
        assert_eq!([1.0, 3.0].map(|time| spline.at(time)[0]), [0.0, 1.0]);
    }

    #[test]
    fn rotations_go_the_shorter_way_at_constant_speed() {
        let quarter = DQuat::from_rotation_z(1.5);
        for to in [quarter, -quarter] {
            for part in [0.0, 0.1, 0.5, 0.77, 1.0] {
                let found = turned(DQuat::IDENTITY, to, part);
                let off = (found - DQuat::from_rotation_z(1.5 * part)).length();
                assert!(off < 1e-12, "{part}: {off}");
            }
        }
    }
}
