//! Estimates drawn half way to what is usual when their contraction's turn comes.

use crate::bounds::ErrorKind;
use crate::forest::Forest;
use crate::frame::Length16;

impl Forest {
    /// Draws estimates of errors together: each becomes the geometric mean of itself and of what is usual
    /// at its place in the sequence of contractions.
    ///
    /// A simplification contracts first what adds least to the mean error; estimates are of the greatest.
    /// A cut to one tolerance keeps places of great errors that simplifying straight would have given up
    /// long before, and pays with its mean. Evened out, it takes fewer faces to the same mean; a few
    /// places are further off than the tolerance. The notes have figures. Errors stay monotone along
    /// needs. Bounds are left as they are.
    ///
    /// Cost: linear.
    pub fn smooth_errors(&mut self) {
        if self.error_kind == ErrorKind::Bound {
            return;
        }
        let usual = rising(self.updates.iter().map(|update| update.error.get().max(LEAST).ln()));
        for (u, usual) in usual.into_iter().enumerate() {
            let error = self.updates[u].error.get();
            // What is exact stays so.
            let drawn = if error > 0.0 { (error * usual.exp()).sqrt() } else { 0.0 };
            self.updates[u].error = Length16::up(drawn);
            if self.updates[u].fused_with_child {
                self.updates[u - 1].error = self.updates[u].error;
            }
        }
    }
}

/// Errors below this count as this, in stored units: it is the rounding of positions.
const LEAST: f64 = 1e-8;

/// The sequence that never falls and is closest to this one, by squares.
///
/// # References
/// [ABERS55]: neighbours that fall are pooled.
fn rising(values: impl Iterator<Item = f64>) -> Vec<f64> {
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
    fn what_falls_is_pooled() {
        let of = |values: &[f64]| rising(values.iter().copied());
        assert_eq!(of(&[1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
        assert_eq!(of(&[1.0, 4.0, 2.0, 5.0]), [1.0, 3.0, 3.0, 5.0]);
        assert_eq!(of(&[3.0, 2.0, 1.0]), [2.0; 3]);
        assert!(of(&[]).is_empty());
    }

    #[test]
    fn evened_errors_never_grow_along_needs() {
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
        let mut evened = estimates.clone();
        evened.smooth_errors();
        let pairs = || estimates.updates.iter().zip(&evened.updates);
        assert!(pairs().any(|(before, after)| after.error < before.error));
        assert!(pairs().any(|(before, after)| after.error > before.error));
        let mut bounds = estimates.clone();
        bounds.measure_bounds();
        let before: Vec<_> = bounds.updates.iter().map(|update| update.error).collect();
        bounds.smooth_errors();
        assert!(bounds.updates.iter().map(|update| update.error).eq(before));
    }
}
