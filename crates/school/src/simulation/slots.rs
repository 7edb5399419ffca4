//! Places of members in their school: an endless sequence of points, evenly spread in the unit ball.

use glam::{DVec3, Vec3};

/// Reciprocal powers of the root of x⁴ = x + 1, by which successive points differ: the generalised
/// golden ratio of three dimensions, whose multiples fill the cube evenly for any number of points.
const STRIDE: DVec3 =
    DVec3::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_970_3);

/// Endless sequence of slots in the unit ball.
///
/// Every prefix of it fills the ball evenly, so that the slot of a member does not depend on how
/// many members there are.
#[derive(Clone, Debug)]
pub struct Slots {
    at: DVec3,
}

impl Slots {
    /// Starts the sequence at a point that the seed determines.
    pub fn new(seed: u64) -> Self {
        let part = |salt: u64| (mix(seed ^ salt) >> 11) as f64 / (1_u64 << 53) as f64;
        Self { at: DVec3::new(part(0x51), part(0x52), part(0x53)) }
    }
}

impl Iterator for Slots {
    type Item = Vec3;

    fn next(&mut self) -> Option<Vec3> {
        // Points of the cube that are outside the ball are left out: about half.
        loop {
            self.at += STRIDE;
            self.at -= self.at.floor();
            let point = self.at * 2.0 - 1.0;
            if point.length_squared() <= 1.0 {
                return Some(point.as_vec3());
            }
        }
    }
}

/// Mixes the bits of a number, so that successive numbers become unrelated ones.
pub fn mix(number: u64) -> u64 {
    let mut bits = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_slots_are_in_the_inner_half_of_the_volume() {
        for count in [64, 1000, 20_000] {
            let inner = Slots::new(7).take(count).filter(|p| p.length_squared().powf(1.5) < 0.5);
            let share = inner.count() as f64 / count as f64;
            assert!((share - 0.5).abs() < 0.06, "{share} of {count}");
        }
    }

    #[test]
    fn seeds_give_different_slots() {
        let first = |seed| Slots::new(seed).next().unwrap();
        assert_eq!(first(1), first(1));
        assert!(first(1).distance(first(2)) > 1e-3);
    }
}
