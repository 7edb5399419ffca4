//! Poses of a camera, sides to look from, and smooth moves between poses.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

/// Place and direction of a [`CameraRig`](super::CameraRig).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigPose {
    /// Point that the camera looks at and turns around, in model units.
    pub target: [f64; 3],
    /// Distance of the eye from the target, in model units, above 0.
    pub distance: f64,
    /// Turn around the up axis, in radians; 0 looks from the front.
    pub yaw_rad: f64,
    /// Elevation of the viewing direction, in radians, between −π/2 (straight down) and π/2.
    pub pitch_rad: f64,
}

/// Side from which to look along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// From the front.
    Front,
    /// From the back.
    Back,
    /// From the right.
    Right,
    /// From the left.
    Left,
    /// From above.
    Top,
    /// From below.
    Bottom,
}

/// Smooth move to another pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Flight {
    pub(super) from: RigPose,
    pub(super) to: RigPose,
    /// Part of the way in time, 0 to 1.
    pub(super) part: f64,
}

/// Distances whose squares fit in `f64`. A range relative to the last framed object would trap
/// flights far away.
const DISTANCES: [f64; 2] = [1e-120, 1e120];

impl Side {
    /// Returns the yaw and the pitch in radians; no yaw for views along the up axis.
    pub(super) fn angles(self) -> (Option<f64>, f64) {
        match self {
            Self::Front => (Some(0.0), 0.0),
            Self::Back => (Some(2.0 * FRAC_PI_2), 0.0),
            Self::Right => (Some(FRAC_PI_2), 0.0),
            Self::Left => (Some(-FRAC_PI_2), 0.0),
            Self::Top => (Some(0.0), -FRAC_PI_2),
            Self::Bottom => (Some(0.0), FRAC_PI_2),
        }
    }
}

impl RigPose {
    /// Returns the pose with its distance and elevation in range.
    pub(super) fn clamped(self) -> Self {
        let [least, most] = DISTANCES;
        let distance = if self.distance.is_nan() { 1.0 } else { self.distance };
        Self {
            distance: distance.clamp(least, most),
            pitch_rad: self.pitch_rad.clamp(-FRAC_PI_2, FRAC_PI_2),
            ..self
        }
    }
}

impl Flight {
    /// Returns the pose at the current part of the way.
    pub(super) fn pose(&self) -> RigPose {
        let t = self.part.clamp(0.0, 1.0);
        let eased = t * t * (3.0 - 2.0 * t);
        let mix = |a: f64, b: f64| a + (b - a) * eased;
        let (from, to) = (&self.from, &self.to);
        RigPose {
            target: DVec3::from(from.target).lerp(to.target.into(), eased).into(),
            distance: from.distance * (to.distance / from.distance).powf(eased),
            yaw_rad: mix(from.yaw_rad, to.yaw_rad),
            pitch_rad: mix(from.pitch_rad, to.pitch_rad),
        }
    }
}
