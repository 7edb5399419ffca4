//! Leaders and the paths they swim along.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use crate::simulation::error::PathError;
use crate::simulation::range::{FARTHEST, is_near};

/// Leader of a school; it knows the way and is not a member.
#[derive(Clone, Debug, PartialEq)]
pub enum Leader {
    /// Round a closed path, from its first waypoint.
    Path(LeaderPath),
    /// Straight on for ever.
    Line {
        /// Position at the beginning.
        from: Vec3,
        /// Direction of any length but zero.
        direction: Vec3,
    },
}

impl Leader {
    /// Returns position and unit heading after swimming `distance` body lengths.
    pub(super) fn after(&self, distance: f64) -> (Vec3, Vec3) {
        match self {
            Self::Path(path) => path.after(distance),
            Self::Line { from, direction } => {
                let heading = direction.normalize_or(Vec3::Z);
                ((from.as_dvec3() + heading.as_dvec3() * distance).as_vec3(), heading)
            }
        }
    }
}

/// Closed smooth curve through waypoints, along which distances are known.
#[derive(Clone, Debug, PartialEq)]
pub struct LeaderPath {
    waypoints: Vec<DVec3>,
    /// Length of the curve up to each sample, [`SAMPLES`] to a waypoint; the last is the whole.
    lengths: Vec<f64>,
}

/// Samples of the curve between two waypoints: on a square's four corners the speed is constant
/// within 0.5 %.
const SAMPLES: usize = 32;
/// Waypoints of a ring: a curve through them leaves the circle by less than 1e-4 of its radius.
const RING: usize = 32;

impl LeaderPath {
    /// Creates the closed Catmull-Rom curve through `waypoints`, in body lengths.
    ///
    /// # Errors
    /// Fewer than three waypoints, one that is not finite or far away, or two equal ones in a row.
    pub fn through(waypoints: &[Vec3]) -> Result<Self, PathError> {
        let count = waypoints.len();
        if count < 3 {
            return Err(PathError::TooFew(count));
        }
        for (i, waypoint) in waypoints.iter().enumerate() {
            if !is_near(*waypoint) {
                return Err(PathError::NotFinite(i));
            }
            if *waypoint == waypoints[(i + count - 1) % count] {
                return Err(PathError::Repeated(i));
            }
        }
        Ok(Self::new(waypoints.iter().map(|waypoint| waypoint.as_dvec3()).collect()))
    }

    /// Creates a ring round `center` that starts at +x of it and turns left, towards -z.
    ///
    /// It is tilted about the x axis by `tilt_rad`. The radius is at least a body length; numbers
    /// that are not finite become zero.
    pub fn ring(center: Vec3, radius: f32, tilt_rad: f32) -> Self {
        let finite = |x: f32| if x.is_finite() { x.clamp(-FARTHEST, FARTHEST) } else { 0.0 };
        let center = Vec3::from(center.to_array().map(finite)).as_dvec3();
        let radius = f64::from(finite(radius).max(1.0));
        let (sin, cos) = f64::from(finite(tilt_rad)).sin_cos();
        let point = |i: usize| {
            let (along, across) = (TAU * i as f64 / RING as f64).sin_cos();
            center + radius * DVec3::new(across, along * sin, -along * cos)
        };
        Self::new((0..RING).map(point).collect())
    }

    fn new(waypoints: Vec<DVec3>) -> Self {
        let mut path = Self { lengths: vec![0.0], waypoints };
        let (mut length, mut last) = (0.0, path.waypoints[0]);
        for sample in 1..=path.waypoints.len() * SAMPLES {
            let (point, _) = path.at(sample as f64 / SAMPLES as f64);
            length += point.distance(last);
            last = point;
            path.lengths.push(length);
        }
        path
    }

    /// Returns the length of the whole curve.
    pub fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// Returns position and unit heading at a distance along the curve from its first waypoint.
    fn after(&self, distance: f64) -> (Vec3, Vec3) {
        let distance = distance.rem_euclid(self.length());
        let next = self.lengths.partition_point(|&length| length <= distance);
        let next = next.clamp(1, self.lengths.len() - 1);
        let (before, after) = (self.lengths[next - 1], self.lengths[next]);
        let length = (after - before).max(f64::MIN_POSITIVE);
        let part = ((distance - before) / length).clamp(0.0, 1.0);
        // The part of the sample's parameter, by a cubic whose slopes at both ends are that of the
        // parameter over the length.
        let slope = |sample: usize| {
            let (_, tangent) = self.at(sample as f64 / SAMPLES as f64);
            (length * SAMPLES as f64 / tangent.length().max(f64::MIN_POSITIVE)).min(3.0)
        };
        let (first, last) = (slope(next - 1), slope(next));
        let bend = first + last - 2.0;
        let part = part * (first + part * (1.0 - first - bend + part * bend));
        let (point, tangent) = self.at((next as f64 - 1.0 + part) / SAMPLES as f64);
        (point.as_vec3(), tangent.as_vec3().normalize_or(Vec3::Z))
    }

    /// Returns position and derivative at `place`: a waypoint, plus a fraction towards the next.
    fn at(&self, place: f64) -> (DVec3, DVec3) {
        let count = self.waypoints.len();
        let (whole, t) = (place.floor() as usize, place.fract());
        let [a, b, c, d] = [count - 1, 0, 1, 2].map(|i| self.waypoints[(whole + i) % count]);
        let (linear, square) = (c - a, 2.0 * a - 5.0 * b + 4.0 * c - d);
        let cube = 3.0 * (b - c) + d - a;
        let point = b + 0.5 * t * (linear + t * (square + t * cube));
        let tangent = 0.5 * (linear + t * (2.0 * square + t * 3.0 * cube));
        (point, tangent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_leader_passes_its_waypoints_at_constant_speed() {
        let corners = [[0.0, 0.0, 0.0], [9.0, 1.0, 0.0], [9.0, 0.0, 9.0], [0.0, -1.0, 9.0]];
        let path = LeaderPath::through(&corners.map(Vec3::from)).unwrap();
        let steps = 4000;
        let speed = path.length() / f64::from(steps);
        let (mut last, mut nearest) = (path.after(0.0).0, [f32::MAX; 4]);
        for step in 1..=steps {
            let (at, heading) = path.after(f64::from(step) * speed);
            assert!((at.distance(last) / speed as f32 - 1.0).abs() < 0.005);
            assert!((heading.length() - 1.0).abs() < 1e-5);
            last = at;
            for (near, corner) in nearest.iter_mut().zip(corners) {
                *near = near.min(at.distance(corner.into()));
            }
        }
        assert!(nearest.iter().all(|&near| near < 0.01), "{nearest:?}");
    }

    #[test]
    fn a_ring_is_round() {
        let path = LeaderPath::ring(Vec3::Y, 30.0, 0.5);
        assert!((path.length() / (TAU * 30.0) - 1.0).abs() < 1e-3);
        for i in 0..100 {
            let (at, heading) = path.after(f64::from(i) * 1.7);
            assert!((at.distance(Vec3::Y) - 30.0).abs() < 0.01);
            assert!(heading.dot(at - Vec3::Y).abs() < 0.1);
        }
    }

    #[test]
    fn a_path_without_a_direction_is_refused() {
        let path = |points: &[[f32; 3]]| {
            LeaderPath::through(&points.iter().copied().map(Vec3::from).collect::<Vec<_>>())
        };
        assert_eq!(path(&[[0.0; 3], [1.0; 3]]), Err(PathError::TooFew(2)));
        assert_eq!(path(&[[0.0; 3], [1.0; 3], [0.0; 3]]), Err(PathError::Repeated(0)));
        assert_eq!(path(&[[0.0; 3], [1.0, f32::NAN, 1.0], [1.0; 3]]), Err(PathError::NotFinite(1)));
    }
}
