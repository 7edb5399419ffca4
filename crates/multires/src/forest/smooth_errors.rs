//! Isotonic smoothing of error estimates.

use crate::error_kind::ErrorKind;
use crate::forest::Forest;
use crate::length16::Length16;

impl Forest {
    /// Smooths the error estimates: each becomes the geometric mean of itself and of the trend at
    /// its place in the contraction sequence.
    ///
    /// Simplification contracts first what adds least to the mean error, while estimates bound the
    /// maximum. A cut at one tolerance therefore keeps small places of great error that plain
    /// simplification would have given up long before, and pays for it in faces. Smoothed, a cut
    /// needs fewer faces for the same mean error; a few places exceed the tolerance.
    /// docs/notes/multires.md has figures. Errors stay monotone along dependencies. Proven bounds
    /// are left unchanged.
    ///
    /// Cost: linear.
    pub fn smooth_errors(&mut self) {
        if self.error_kind != ErrorKind::Estimate {
            return;
        }
        let trend =
            isotonic(self.updates.iter().map(|update| update.error.get().max(ERROR_FLOOR).ln()));
        for (u, trend) in trend.into_iter().enumerate() {
            let error = self.updates[u].error.get();
            // Exact updates stay exact.
            let smoothed = if error > 0.0 { (error * trend.exp()).sqrt() } else { 0.0 };
            self.updates[u].error = Length16::up(smoothed);
            if self.updates[u].fused_with_child {
                self.updates[u - 1].error = self.updates[u].error;
            }
        }
    }
}

/// Smallest error that counts, in stored units: the rounding of positions.
const ERROR_FLOOR: f64 = 1e-8;

/// Returns the non-decreasing sequence closest to the input in the least-squares sense.
///
/// # References
/// [ABERS55]: adjacent violators are pooled.
fn isotonic(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for value in values {
        let mut pool = (value, 1);
        while let Some(before) = pools.pop_if(|before| before.0 >= pool.0) {
            let count = before.1 + pool.1;
            let sum = before.0 * before.1 as f64 + pool.0 * pool.1 as f64;
            pool = (sum / count as f64, count);
        }
        pools.push(pool);
    }
    pools.into_iter().flat_map(|(value, count)| std::iter::repeat_n(value, count)).collect()
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;
    use meshlod_simplify::Method;

    use super::*;
    use crate::forest::NONE;
    use crate::tests::walks::{each, forest};

    #[test]
    fn falling_values_are_pooled() {
        let of = |values: &[f64]| isotonic(values.iter().copied());
        assert_eq!(of(&[1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
        assert_eq!(of(&[1.0, 4.0, 2.0, 5.0]), [1.0, 3.0, 3.0, 5.0]);
        assert_eq!(of(&[3.0, 2.0, 1.0]), [2.0; 3]);
        assert!(of(&[]).is_empty());
    }

    #[test]
    fn smoothed_errors_never_grow_along_dependencies() {
        each(|what, _, forest| {
            let mut forest = forest.clone();
            forest.smooth_errors();
            let parents = forest.parents();
            for (u, update) in forest.updates.iter().enumerate() {
                let around = forest.ring(u).iter().copied().chain([forest.node(u) as u32]);
                for need in around.map(|node| parents[node as usize]).filter(|&need| need != NONE) {
                    assert!(forest.updates[need as usize].error >= update.error, "{what}: {u}");
                }
            }
        });
    }

    #[test]
    fn great_errors_shrink_small_ones_grow_and_bounds_stay() {
        let estimates = forest(&samples::gyroid(2000), Method::Qem);
        let mut smoothed = estimates.clone();
        smoothed.smooth_errors();
        let pairs = || estimates.updates.iter().zip(&smoothed.updates);
        assert!(pairs().any(|(before, after)| after.error < before.error));
        assert!(pairs().any(|(before, after)| after.error > before.error));
        let mut bounds = estimates.clone();
        bounds.measure_bounds();
        let before: Vec<_> = bounds.updates.iter().map(|update| update.error).collect();
        bounds.smooth_errors();
        assert!(bounds.updates.iter().map(|update| update.error).eq(before));
    }
}
