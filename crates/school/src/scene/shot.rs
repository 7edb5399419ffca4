//! Paths of cameras, which follow the leader of the first school.

use std::f64::consts::TAU;

use glam::Vec3;
use meshlod::flock::School;

use crate::scene::ground::CircleHeights;

/// How a camera moves; lengths are in body lengths.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shot {
    /// Circles the leader.
    Circle {
        /// Least and greatest distance, by turns.
        distances: [f32; 2],
        /// Time for a circle.
        period_s: f64,
    },
    /// Swims near the leader within the school, and looks all round.
    Inside,
    /// Keeps abreast of a leader on a ring, outside of it.
    Beside {
        /// Distance from the leader's ring.
        outside: f32,
    },
    /// Looks down on a leader on a ring.
    Over {
        /// Radius of the camera's own ring.
        radius: f32,
        /// Angle by which the camera is behind.
        behind: f32,
        /// Heights along the camera's ring.
        heights: CircleHeights,
    },
}

/// Time in which the camera inside a school looks round once.
const LOOK_ROUND_S: f64 = 36.0;

impl Shot {
    /// Returns the eye, and the point that it looks at.
    pub(super) fn look(&self, school: &School, time_s: f64) -> [Vec3; 2] {
        let leader = school.leader;
        let wave = |period_s: f64, start: f64| ((time_s / period_s + start) * TAU).sin() as f32;
        match self {
            Self::Circle { distances: [near, far], period_s } => {
                let away = 0.5 + 0.5 * wave(1.3 * period_s, -0.25);
                let distance = near + (far - near) * away;
                let elevation = 0.24 + 0.12 * wave(0.7 * period_s, 0.0);
                let (sin, cos) = ((time_s / period_s + 0.06) * TAU).sin_cos();
                let flat = Vec3::new(cos as f32, 0.0, -sin as f32);
                let (up, along) = elevation.sin_cos();
                [leader + distance * (flat * along + Vec3::Y * up), leader]
            }
            Self::Inside => {
                let frame = school.frame();
                let place = Vec3::new(
                    0.25 * wave(17.0, 0.1),
                    0.2 * wave(23.0, 0.4),
                    0.15 + 0.2 * wave(29.0, 0.7),
                );
                let (sin, cos) = ((time_s / LOOK_ROUND_S + 0.04) * TAU).sin_cos();
                let view = Vec3::new(sin as f32, 0.12 * wave(11.0, 0.0), cos as f32);
                let eye = leader + frame * (place * school.radii);
                [eye, eye + frame * view * school.radii.z.max(1.0)]
            }
            Self::Beside { outside } => {
                let flat = Vec3::new(leader.x, 0.0, leader.z);
                let outward = flat.normalize_or(Vec3::X);
                let height = 0.35 * school.radii.z + 0.5 * wave(13.0, 0.0);
                let ahead = 0.25 * school.radii.z * school.heading;
                [leader + outward * *outside + Vec3::Y * height + ahead, leader + ahead]
            }
            Self::Over { radius, behind, heights } => {
                let angle = (-leader.z).atan2(leader.x) - behind;
                let (sin, cos) = angle.sin_cos();
                [Vec3::new(radius * cos, heights.at(angle), -radius * sin), leader]
            }
        }
    }
}
