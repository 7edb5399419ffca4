//! Flock at one moment: its members and the schools they swim in.

use std::ops::Range;

use glam::{Mat3, Vec3};

use crate::members::{Members, frame_of};

/// Flock at one moment, as policies see it and renderers draw it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flock {
    /// Positions and headings of all members of all schools, in body lengths.
    pub members: Members,
    /// Schools, each a range of consecutive members, in ascending order; members between them
    /// belong to no school.
    pub schools: Vec<School>,
}

/// Group of members that follow one leader within an ellipsoid.
#[derive(Clone, Debug, PartialEq)]
pub struct School {
    /// Members of the school.
    pub members: Range<usize>,
    /// Position of the leader, not a member, in body lengths: the centre of the ellipsoid.
    pub leader: Vec3,
    /// Unit vector in which the leader swims.
    pub heading: Vec3,
    /// Half axes of the ellipsoid along the leader's left, up and heading, in body lengths.
    pub radii: Vec3,
}

impl School {
    /// Returns the leader's frame: the columns are its left (x), up (y) and heading (z).
    pub fn frame(&self) -> Mat3 {
        frame_of(self.heading)
    }

    /// Returns the matrix that maps an offset from the leader into the unit ball of the ellipsoid.
    ///
    /// An axis of zero length counts as a thousandth of a body length.
    pub fn to_unit_ball(&self) -> Mat3 {
        let scale = self.radii.max(Vec3::splat(1e-3)).recip();
        Mat3::from_diagonal(scale) * self.frame().transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_surface_of_the_ellipsoid_becomes_the_unit_sphere() {
        let (heading, radii) = (Vec3::X, Vec3::new(2.0, 3.0, 0.0));
        let school = School { members: 0..0, leader: Vec3::ZERO, heading, radii };
        let to_ball = school.to_unit_ball();
        // Left of a leader that swims along +x is -z.
        assert!((to_ball * Vec3::NEG_Z * 2.0 - Vec3::X).length() < 1e-6);
        assert!((to_ball * Vec3::Y * 3.0 - Vec3::Y).length() < 1e-6);
        assert!((to_ball * Vec3::X).is_finite(), "even an axis of zero");
    }
}
