//! Interpolation of rotations, for poses and the packing of animations.

use glam::DQuat;

/// Cosine of an arc that its chord approximates to within 3e-14.
const STRAIGHT: f64 = 1.0 - 1e-8;
/// Halvings after which every arc of up to half a circle is this short.
const MOST_HALVINGS: usize = 16;

/// Interpolates between two unit quaternions along their arc at constant speed, without choosing
/// signs: for the shorter rotation, pass the nearer sign of `to`.
///
/// The arc is halved until it is straight, using only sums and roots, so that the result is the
/// same on every machine. Opposite quaternions have no defined arc.
pub(crate) fn slerp(mut from: DQuat, mut to: DQuat, mut part: f64) -> DQuat {
    for _ in 0..MOST_HALVINGS {
        if from.dot(to) >= STRAIGHT {
            break;
        }
        let middle = (from + to).normalize();
        part *= 2.0;
        if part >= 1.0 {
            (from, part) = (middle, part - 1.0);
        } else {
            to = middle;
        }
    }
    (from * (1.0 - part) + to * part).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arcs_of_any_length_are_passed_at_constant_speed() {
        for angle in [0.0, 1e-9, 1e-4, 3e-4, 0.1, 1.5, 3.0, 6.0] {
            for part in [0.0, 0.1, 0.5, 0.77, 1.0] {
                let found = slerp(DQuat::IDENTITY, DQuat::from_rotation_z(angle), part);
                let off = (found - DQuat::from_rotation_z(angle * part)).length();
                assert!(off < 1e-13, "{angle}, {part}: {off}");
            }
        }
    }
}
