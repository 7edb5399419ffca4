//! Single-channel images and separable filters.

use rayon::prelude::*;

/// Single-channel image, row after row from the top.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plane {
    width: usize,
    pub values: Vec<f32>,
}

impl Plane {
    /// Creates an image in which pixel `i` has the value `of(i)`.
    pub(crate) fn from_fn(size: [u32; 2], of: impl Fn(usize) -> f32 + Sync + Send) -> Self {
        let [width, height] = size.map(|side| side as usize);
        let values = (0..width * height).into_par_iter().with_min_len(width).map(of).collect();
        Self { width, values }
    }

    /// Filters each row by `along`, then each column by `down`. Both have an odd number of weights,
    /// the middle one for the pixel itself. Beyond its edges, the image repeats its outermost
    /// pixels.
    pub(crate) fn filtered(&self, along: &[f32], down: &[f32]) -> Self {
        self.along_rows(along).down_columns(down)
    }

    /// Filters each row: the first half of [`Plane::filtered`], which several filters may share.
    pub(crate) fn along_rows(&self, weights: &[f32]) -> Self {
        let radius = weights.len() / 2;
        let mut filtered = vec![0.0; self.values.len()];
        let rows =
            filtered.par_chunks_exact_mut(self.width).zip(self.values.par_chunks(self.width));
        rows.for_each_init(Vec::new, |padded, (out, row)| {
            padded.clear();
            padded.resize(radius, row[0]);
            padded.extend_from_slice(row);
            padded.resize(row.len() + 2 * radius, row[row.len() - 1]);
            for (&weight, start) in weights.iter().zip(0..) {
                add_scaled(out, weight, &padded[start..start + row.len()]);
            }
        });
        Self { width: self.width, values: filtered }
    }

    /// Filters each column: the second half of [`Plane::filtered`].
    pub(crate) fn down_columns(&self, weights: &[f32]) -> Self {
        let radius = weights.len() / 2;
        let last = self.values.len() / self.width - 1;
        let mut filtered = vec![0.0; self.values.len()];
        filtered.par_chunks_exact_mut(self.width).enumerate().for_each(|(y, out)| {
            for (i, &weight) in weights.iter().enumerate() {
                let from = (y + i).saturating_sub(radius).min(last) * self.width;
                add_scaled(out, weight, &self.values[from..from + self.width]);
            }
        });
        Self { width: self.width, values: filtered }
    }
}

fn add_scaled(sum: &mut [f32], weight: f32, values: &[f32]) {
    for (sum, value) in sum.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

/// Samples an unnormalised Gaussian at integer distances up to `radius` on both sides.
pub(crate) fn gaussian(deviation: f64, radius: usize) -> Vec<f64> {
    let at = |i: usize| (i as f64 - radius as f64) / deviation;
    (0..=2 * radius).map(|i| (-0.5 * at(i) * at(i)).exp()).collect()
}

/// Scales weights so that the positive ones sum to 1 and the negative ones to -1.
pub(crate) fn normalized(weights: &[f64]) -> Vec<f32> {
    let above: f64 = weights.iter().filter(|&&w| w > 0.0).sum();
    let below: f64 = weights.iter().filter(|&&w| w < 0.0).sum();
    weights.iter().map(|&w| (w / if w > 0.0 { above } else { -below }) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_weighs_neighbours_and_repeats_the_edge() {
        let plane = Plane::from_fn([3, 2], |i| [1.0, 2.0, 4.0, 8.0, 16.0, 32.0][i]);
        let along = plane.along_rows(&[100.0, 10.0, 1.0]);
        assert_eq!(along.values, [112.0, 124.0, 244.0, 896.0, 992.0, 1952.0]);
        let down = plane.down_columns(&[100.0, 10.0, 1.0]);
        assert_eq!(down.values, [118.0, 236.0, 472.0, 188.0, 376.0, 752.0]);
    }

    #[test]
    fn balanced_weights_add_up_to_one_on_each_side() {
        assert_eq!(normalized(&[-3.0, -1.0, 0.0, 2.0]), [-0.75, -0.25, 0.0, 1.0]);
        let gaussian = normalized(&gaussian(1.5, 5));
        assert!((gaussian.iter().sum::<f32>() - 1.0).abs() < 1e-6 && gaussian[5] > gaussian[4]);
    }
}
