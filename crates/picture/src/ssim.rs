//! Structural similarity (SSIM): agreement of pictures in luminance, contrast and structure.

use rayon::prelude::*;

use crate::error::check_same_size;
use crate::plane::{Plane, gaussian, normalized};
use crate::{Picture, PictureError};

/// Computes the structural similarity (SSIM) of two pictures around each pixel, in luma: 1 if
/// equal, at least -1. Row after row from the top.
///
/// The window is a Gaussian of 11 by 11 pixels. Alpha is ignored. The result does not depend on the
/// number of threads. Cost: O(pixels), less than [`flip`](crate::flip()).
///
/// # Errors
/// Pictures of different sizes.
/// # References
/// [WBSS04] with the constants given there; differs: the picture is extended beyond its edges.
pub fn ssim(reference: &Picture, test: &Picture) -> Result<Vec<f32>, PictureError> {
    check_same_size(reference, test)?;
    let size = [reference.width(), reference.height()];
    let [a, b] = [reference, test].map(|picture| luma(picture, size));
    let window = normalized(&gaussian(1.5, 5));
    let local = |of: &(dyn Fn(usize) -> f32 + Sync)| {
        Plane::from_fn(size, of).filtered(&window, &window).values
    };
    let [mean_a, mean_b] = [&a, &b].map(|luma| local(&|i| luma[i]));
    let [square_a, square_b] = [&a, &b].map(|luma| local(&|i| luma[i] * luma[i]));
    let product = local(&|i| a[i] * b[i]);
    let similarity = |i: usize| {
        let (x, y) = (mean_a[i], mean_b[i]);
        let (spread_x, spread_y) = (square_a[i] - x * x, square_b[i] - y * y);
        let together = product[i] - x * y;
        (2.0 * x * y + C1) * (2.0 * together + C2)
            / ((x * x + y * y + C1) * (spread_x + spread_y + C2))
    };
    Ok((0..a.len()).into_par_iter().with_min_len(1024).map(similarity).collect())
}

/// Stabilizing constants, the squares of 1% and 3% of the range: they bound quotients of tiny
/// values.
const C1: f32 = 1e-4;
const C2: f32 = 9e-4;

/// Computes the luma of sRGB in [0, 1] as in Rec. 601, which [WBSS04] uses.
fn luma(picture: &Picture, size: [u32; 2]) -> Vec<f32> {
    let rgba = picture.rgba();
    let luma = |i: usize| {
        let [r, g, b] = [0, 1, 2].map(|channel| f32::from(rgba[4 * i + channel]));
        (0.299 * r + 0.587 * g + 0.114 * b) / 255.0
    };
    Plane::from_fn(size, luma).values
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A soft hill whose light goes from `low` to `low + height`, `shift` to the right.
    fn hill(low: f32, height: f32, shift: i32) -> Picture {
        let level = |i: i32| {
            let (x, y) = ((i % 48 - 24 - shift) as f32, (i / 48 - 24) as f32);
            (low + height * (-(x * x + y * y) / 60.0).exp()) as u8
        };
        Picture::new(48, 48, (0..48 * 48).flat_map(|i| [level(i); 4]).collect()).unwrap()
    }

    fn mean(a: &Picture, b: &Picture) -> f32 {
        ssim(a, b).unwrap().iter().sum::<f32>() / (48.0 * 48.0)
    }

    #[test]
    fn a_picture_is_all_like_itself() {
        let picture = hill(20.0, 200.0, 0);
        assert!(ssim(&picture, &picture).unwrap().iter().all(|s| (s - 1.0).abs() < 1e-4));
    }

    #[test]
    fn flat_pictures_compare_by_their_means_alone() {
        let [a, b] = [51.0, 102.0].map(|low| hill(low, 0.0, 0));
        let expected = (2.0 * 0.2 * 0.4 + 1e-4) / (0.2 * 0.2 + 0.4 * 0.4 + 1e-4);
        assert!((mean(&a, &b) - expected).abs() < 1e-3, "{}", mean(&a, &b));
    }

    #[test]
    fn form_counts_for_more_than_light() {
        let still = hill(60.0, 120.0, 0);
        let [brighter, moved, further] =
            [hill(66.0, 120.0, 0), hill(60.0, 120.0, 3), hill(60.0, 120.0, 6)];
        let [brighter, moved, further] = [brighter, moved, further].map(|p| mean(&still, &p));
        assert!(brighter > moved && moved > further, "{brighter} {moved} {further}");
    }
}
