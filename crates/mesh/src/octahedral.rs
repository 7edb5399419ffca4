//! Directions as two integers, on the unfolded octahedron [CDE14].

use glam::DVec3;

/// Coding of the directions of a layer with a number of bits: two integers, and for a tangent one
/// more for its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirectionCode {
    bits: u32,
}

impl DirectionCode {
    /// Returns the coarsest code that keeps directions within an error in radians, or the finest if
    /// none does.
    pub fn within(bound_rad: f64) -> Self {
        let [least, most] = BITS;
        let bits = (least..most).find(|&bits| max_error_rad(bits) <= bound_rad).unwrap_or(most);
        Self { bits }
    }

    /// Returns the code with a number of bits for each of the two integers, from 3 to 16; `None`
    /// for any other number.
    pub fn of_bits(bits: u32) -> Option<Self> {
        (BITS[0]..=BITS[1]).contains(&bits).then_some(Self { bits })
    }

    /// Returns the number of bits of each of the two integers.
    pub fn bits(self) -> u32 {
        self.bits
    }

    /// Encodes the direction in the first three values, and the sign of the fourth, if there is one:
    /// 1 if it is negative, else 0.
    #[inline]
    pub fn encode(self, values: &[f32]) -> ([u32; 2], Option<u32>) {
        let direction = DVec3::from_array([0, 1, 2].map(|k| values[k].into()));
        let sign = values.get(3).map(|&sign| u32::from(sign < 0.0));
        (fold(direction, self.bits), sign)
    }

    /// Decodes a unit direction and, if there is one, its sign. Integers that are out of range, as
    /// only damaged data has them, count as the largest.
    #[inline]
    pub fn decode(self, at: [u32; 2], sign: Option<u32>) -> impl Iterator<Item = f32> {
        let last = (1 << self.bits) - 1;
        let direction = unfold(at.map(|x| x.min(last)), self.bits).to_array();
        let sign = sign.map(|sign| if sign == 1 { -1.0 } else { 1.0 });
        direction.map(|x| x as f32).into_iter().chain(sign)
    }
}

/// Encodes a direction of any length in twice `bits` bits, as the best of the four nearest codes.
///
/// A direction of zero length becomes the first axis.
pub fn fold(direction: DVec3, bits: u32) -> [u32; 2] {
    let direction = direction.try_normalize().unwrap_or(DVec3::X);
    let most = last(bits);
    let [x, y] = project(direction, bits).map(f64::floor);
    let near = [[x, y], [x + 1.0, y], [x, y + 1.0], [x + 1.0, y + 1.0]];
    let near = near.map(|at| at.map(|x| x.min(most) as u32));
    let distance = |at: &[u32; 2]| unfold(*at, bits).distance_squared(direction);
    near.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("there are four")
}

/// Projects a direction of any length but zero to the plane of the codes: between those that are
/// nearest.
pub fn project(direction: DVec3, bits: u32) -> [f64; 2] {
    flat(direction).map(|x| (x + 1.0) / 2.0 * last(bits))
}

/// Decodes a unit direction from two integers below 2^`bits`, identically on every machine.
pub fn unfold(at: [u32; 2], bits: u32) -> DVec3 {
    let [x, y] = at.map(|x| f64::from(x) / last(bits) * 2.0 - 1.0);
    let z = 1.0 - x.abs() - y.abs();
    let over = (-z).max(0.0);
    DVec3::new(x - over.copysign(x), y - over.copysign(y), z).normalize()
}

/// Returns the largest error of a direction, in radians.
///
/// Cells are squares of side `s` = 2 / (2^bits - 1). Where the octahedron is closest to its centre,
/// a step along their diagonal turns three times as far as it is long, and across it √3 times:
/// corners of cells form a lattice of triangles with side √6 s there, and no direction is farther
/// from all of them than √6 s / √3.
pub fn max_error_rad(bits: u32) -> f64 {
    2.0 * 2f64.sqrt() / last(bits)
}

/// Minimum and maximum number of bits of each integer.
const BITS: [u32; 2] = [3, 16];

fn last(bits: u32) -> f64 {
    f64::from((1u32 << bits) - 1)
}

/// Projects a direction to the unfolded octahedron, from -1 to 1.
fn flat(direction: DVec3) -> [f64; 2] {
    let DVec3 { x, y, z } = direction / direction.abs().element_sum();
    if z >= 0.0 {
        return [x, y];
    }
    [(1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bit_more_halves_how_far_directions_turn() {
        let worst = |bits: u32| {
            // A golden-angle spiral covers the sphere evenly.
            let turn = |i: u32| {
                let z = (f64::from(i) + 0.5) / 5000.0 - 1.0;
                let (y, x) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
                let direction = (DVec3::new(x, y, 0.0) * (1.0 - z * z).sqrt()).with_z(z);
                unfold(fold(direction, bits), bits).angle_between(direction)
            };
            (0..10_000).map(turn).fold(0.0, f64::max)
        };
        for bits in [4, 8, 12, 16] {
            let bound = max_error_rad(bits);
            assert!((0.8 * bound..bound).contains(&worst(bits)), "{bits}: {}", worst(bits));
        }
    }

    #[test]
    fn codes_keep_directions_and_signs() {
        let code = DirectionCode::within(1e-3);
        let tangent = [0.0, -0.6, 0.8, -1.0];
        let (at, sign) = code.encode(&tangent);
        let back: Vec<f32> = code.decode(at, sign).collect();
        assert!(back.iter().zip(tangent).all(|(is, was)| (is - was).abs() < 1e-3), "{back:?}");
        assert_eq!(code.decode(code.encode(&tangent[..3]).0, None).count(), 3);
        assert!(code.decode([u32::MAX; 2], Some(7)).all(f32::is_finite));
        assert_eq!(DirectionCode::of_bits(code.bits()), Some(code));
        assert_eq!([2, 17].map(DirectionCode::of_bits), [None; 2]);
    }

    #[test]
    fn axes_and_zero_vectors_have_a_code() {
        for axis in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
            assert!(unfold(fold(axis, 10), 10).angle_between(axis) < 2e-3);
        }
        assert!(unfold(fold(DVec3::ZERO, 10), 10).angle_between(DVec3::X) < 2e-3);
    }
}
