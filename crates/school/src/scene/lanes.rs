//! Members shared out among schools, and schools placed one after the other on a ring.

use std::f32::consts::TAU;

use glam::Vec3;

use crate::scene::SceneError;
use crate::simulation::{Leader, LeaderPath, SchoolOptions};

/// Greatest number of schools of a scenario.
const MOST_SCHOOLS: usize = 64;

/// Waypoints of a leader's path.
const WAYPOINTS: usize = 64;

/// Distance between the leaders of two schools in a lane, over the schools' length along it.
const APART: f32 = 2.6;

/// Height from lane to lane over the schools' half height.
const LANE_HEIGHT: f32 = 2.6;

/// Ring that leaders swim round, starting at +x of the origin towards -z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    /// Half axes of the largest school.
    pub radii: Vec3,
    /// Radius of the ring, wide enough that the school can follow.
    pub radius: f32,
}

impl Ring {
    /// Returns the ring for schools of this many members, sized by [`SchoolOptions::of`].
    pub(super) fn of(members: usize) -> Self {
        let radii = SchoolOptions::of(members).radii;
        Self { radii, radius: (4.0 * radii.z).max(24.0) }
    }

    /// Returns the point at an angle, as high as `height` says for that angle.
    pub(super) fn point(&self, angle: f32, height: impl Fn(f32) -> f32) -> Vec3 {
        let (sin, cos) = angle.sin_cos();
        Vec3::new(self.radius * cos, height(angle), -self.radius * sin)
    }

    /// Returns the angle by which a distance along the ring turns.
    pub(super) fn angle_of(&self, distance: f32) -> f32 {
        distance / self.radius
    }

    /// Returns schools on this ring, the first at angle zero and the others by turns before and
    /// behind it, and in lanes above where the ring is full.
    pub(super) fn schools(
        &self,
        counts: &[usize],
        height: impl Fn(f32) -> f32,
    ) -> Result<Vec<SchoolOptions>, SceneError> {
        let step = self.angle_of(APART * self.radii.z);
        let of_lane = ((TAU / step) as usize).max(1);
        let school = |(i, &members): (usize, &usize)| {
            let (lane, place) = (i / of_lane, i % of_lane);
            let turns = place.div_ceil(2) as f32 * if place % 2 == 1 { step } else { -step };
            let lift = lane as f32 * LANE_HEIGHT * self.radii.y;
            let waypoint = |k: usize| {
                let angle = turns + k as f32 / WAYPOINTS as f32 * TAU;
                self.point(angle, &height) + Vec3::Y * lift
            };
            let path = LeaderPath::through(&(0..WAYPOINTS).map(waypoint).collect::<Vec<_>>())?;
            Ok(SchoolOptions { leader: Leader::Path(path), ..SchoolOptions::of(members) })
        };
        counts.iter().enumerate().map(school).collect()
    }
}

/// Shares members out among schools as evenly as possible, larger schools first.
pub(super) fn shares(members: usize, schools: usize) -> Result<Vec<usize>, SceneError> {
    if members == 0 {
        return Err(SceneError::NoMembers);
    }
    let most = members.min(MOST_SCHOOLS);
    if !(1..=most).contains(&schools) {
        return Err(SceneError::Schools { schools, members, most });
    }
    let (each, more) = (members / schools, members % schools);
    Ok((0..schools).map(|i| each + usize::from(i < more)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_member_has_a_school() {
        assert_eq!(shares(10, 3), Ok(vec![4, 3, 3]));
        assert_eq!(shares(1, 1), Ok(vec![1]));
        assert_eq!(shares(0, 1), Err(SceneError::NoMembers));
        assert!(shares(5, 6).is_err() && shares(5, 0).is_err() && shares(500, 65).is_err());
    }
}
