//! Members of a flock as structure of arrays.

use glam::{Mat3, Vec3};

/// Positions and headings of the members of a flock, one array per coordinate.
///
/// Lengths are in body lengths of a member, and all arrays have the same length. Headings are unit
/// vectors. A member has no roll: its up vector is as close to +y as its heading allows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Members {
    /// Position of each member, by axis.
    pub position: [Vec<f32>; 3],
    /// Unit vector in which each member swims, by axis.
    pub heading: [Vec<f32>; 3],
    /// Speed of each member along its heading, in body lengths a second.
    pub speed: Vec<f32>,
}

impl Members {
    /// Returns the number of members.
    pub fn len(&self) -> usize {
        self.position[0].len()
    }

    /// Returns true if there are no members.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds a member at rest; the heading must be a unit vector.
    pub fn push(&mut self, position: [f32; 3], heading: [f32; 3]) {
        for axis in 0..3 {
            self.position[axis].push(position[axis]);
            self.heading[axis].push(heading[axis]);
        }
        self.speed.push(0.0);
    }

    /// Changes the number of members; new ones rest at the origin and head along +z.
    pub fn resize(&mut self, count: usize) {
        self.position.iter_mut().for_each(|axis| axis.resize(count, 0.0));
        for (axis, values) in self.heading.iter_mut().enumerate() {
            values.resize(count, if axis == 2 { 1.0 } else { 0.0 });
        }
        self.speed.resize(count, 0.0);
    }

    /// Returns the position of a member.
    #[inline]
    pub fn position(&self, member: usize) -> Vec3 {
        let [x, y, z] = &self.position;
        Vec3::new(x[member], y[member], z[member])
    }

    /// Returns the heading of a member, a unit vector.
    #[inline]
    pub fn heading(&self, member: usize) -> Vec3 {
        let [x, y, z] = &self.heading;
        Vec3::new(x[member], y[member], z[member])
    }

    /// Returns the frame of a member: see [`frame_of`].
    #[inline]
    pub fn frame(&self, member: usize) -> Mat3 {
        frame_of(self.heading(member))
    }
}

/// Returns the frame of a member that swims along a unit vector: the columns are its left (x), its
/// up (y) and its heading (z).
///
/// This is the frame in which glTF models face forwards. A member that swims straight up or down
/// has its left along +x.
#[inline]
pub fn frame_of(heading: Vec3) -> Mat3 {
    // Left = +y × heading.
    let flat = Vec3::new(heading.z, 0.0, -heading.x);
    let length = flat.length();
    let left = if length > 1e-6 { flat / length } else { Vec3::X };
    Mat3::from_cols(left, heading.cross(left), heading)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_right_handed_and_upright() {
        for heading in [Vec3::X, Vec3::Z, Vec3::Y, Vec3::NEG_Y, Vec3::new(0.48, 0.6, -0.64)] {
            let frame = frame_of(heading);
            assert!((frame.determinant() - 1.0).abs() < 1e-5, "{frame:?}");
            assert!((frame * Vec3::Z - heading).length() < 1e-6 && frame.y_axis.y >= -1e-6);
        }
        assert!((frame_of(Vec3::Z).x_axis - Vec3::X).length() < 1e-6);
    }

    #[test]
    fn members_are_stored_by_axis() {
        let mut members = Members::default();
        members.push([1.0, 2.0, 3.0], [0.0, 1.0, 0.0]);
        members.resize(2);
        assert_eq!((members.position(0), members.heading(0)), (Vec3::new(1.0, 2.0, 3.0), Vec3::Y));
        assert_eq!((members.len(), members.heading(1)), (2, Vec3::Z));
    }
}
