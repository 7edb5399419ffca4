//! Exact test for faces of zero area.

use robust::{Coord, orient2d};

/// Returns true if three points are exactly collinear.
///
/// They are if their projections onto the three coordinate planes are. A bound on the rounding
/// error spares nearly all faces exact arithmetic.
#[inline]
pub(crate) fn has_zero_area(corners: [[f64; 3]; 3]) -> bool {
    let [a, b, c] = corners;
    // Each difference, each product and the final difference is rounded once.
    const BOUND: f64 = 4.0 * f64::EPSILON;
    let certain = |x: usize, y: usize| {
        let left = (b[x] - a[x]) * (c[y] - a[y]);
        let right = (b[y] - a[y]) * (c[x] - a[x]);
        let magnitude = left.abs() + right.abs();
        // Smaller products lose bits to underflow.
        (left - right).abs() > magnitude * BOUND && magnitude > 1e-280
    };
    !(certain(0, 1) || certain(1, 2) || certain(2, 0)) && is_collinear(corners)
}

#[cold]
fn is_collinear(corners: [[f64; 3]; 3]) -> bool {
    // Scaling an axis by a power of two preserves collinearity and keeps products of very large or
    // very small coordinates in range.
    let mut scaled = corners;
    for axis in 0..3 {
        let greatest = corners.iter().fold(0.0, |most: f64, p| most.max(p[axis].abs()));
        let scale = power_of_two_below(greatest);
        scaled.iter_mut().for_each(|p| p[axis] /= scale);
    }
    [(0, 1), (1, 2), (2, 0)].into_iter().all(|(x, y)| {
        let [a, b, c] = scaled.map(|p| Coord { x: p[x], y: p[y] });
        orient2d(a, b, c) == 0.0
    })
}

/// Returns the greatest power of two that is not above `x`; 1 for zero and subnormal numbers.
fn power_of_two_below(x: f64) -> f64 {
    if x.is_normal() { f64::from_bits(x.to_bits() & 0x7ff0_0000_0000_0000) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_bit_off_the_line_is_an_area() {
        let on = [[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.4, 0.4, 0.4]];
        assert!(has_zero_area(on));
        let mut off = on;
        off[1][2] = 0.2_f64.next_up();
        assert!(!has_zero_area(off));
    }

    #[test]
    fn size_and_place_do_not_matter() {
        for scale in [1e-300, 1e-160, 1e-20, 1.0, 1e150, 1e300] {
            let corners =
                [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [4.0, 8.0, 12.0]].map(|p| p.map(|x| x * scale));
            let mut bent = corners;
            bent[2][0] = f64::next_down(bent[2][0]);
            assert!(!has_zero_area(bent), "at {scale}");
        }
        let flat = [[1.0; 3], [2.0; 3], [3.0; 3]];
        for scale in [1e-300_f64, 1e300].map(power_of_two_below) {
            assert!(has_zero_area(flat.map(|p| p.map(|x| x * scale))), "at {scale}");
        }
        let far = [[1e9, 0.0, 0.0], [1e9, 1e-6, 0.0], [1e9, 0.0, 1e-6]];
        assert!(!has_zero_area(far));
    }

    #[test]
    fn two_equal_corners_are_a_line() {
        assert!(has_zero_area([[0.3, 0.2, 0.1], [0.3, 0.2, 0.1], [5.0, 0.0, -2.0]]));
    }
}
