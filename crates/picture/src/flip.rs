//! FLIP: the difference a viewer perceives when two pictures alternate in place.

use glam::Vec3;
use rayon::prelude::*;

use crate::error::check_same_size;
use crate::lab::{from_opponent, hunt_lab, hyab, to_opponent};
use crate::plane::{Plane, gaussian, normalized};
use crate::srgb::decode;
use crate::{Picture, PictureError};

/// Pixels per degree of visual angle that [`flip`] assumes: a 3840-pixel-wide screen of 0.7 m, seen
/// from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// Computes the FLIP error (perceived difference) of each pixel between two pictures, from 0
/// (equal) to 1, row after row from the top.
///
/// The viewing distance is given by [`PIXELS_PER_DEGREE`]. Alpha is ignored. The result does not
/// depend on the number of threads; machines may differ in the last bits.
///
/// Cost: O(pixels); a picture of 1024 by 1024 takes some 0.2 s of one core.
///
/// # Errors
/// Pictures of different sizes.
/// # References
/// [ANA20]; the constants are those of their program.
pub fn flip(reference: &Picture, test: &Picture) -> Result<Vec<f32>, PictureError> {
    check_same_size(reference, test)?;
    let filters = Filters::new();
    let [reference, test] = [reference, test].map(|picture| PerceivedImage::new(picture, &filters));
    let scale = ColorScale::new();
    let error = |i: usize| {
        let color = scale.error(reference.colors[i], test.colors[i]);
        let edges = (reference.edges[i] - test.edges[i]).abs();
        let points = (reference.points[i] - test.points[i]).abs();
        let feature = (edges.max(points) * std::f32::consts::FRAC_1_SQRT_2).sqrt().min(1.0);
        // A difference in features amplifies one in colour.
        color.powf(1.0 - feature)
    };
    Ok((0..reference.colors.len()).into_par_iter().with_min_len(1024).map(error).collect())
}

/// Picture as perceived by the eye.
struct PerceivedImage {
    /// CIE L*a*b* colours, without detail too fine to be seen.
    colors: Vec<Vec3>,
    /// Strength of the edge at each pixel.
    edges: Vec<f32>,
    /// Strength of the point or line at each pixel.
    points: Vec<f32>,
}

impl PerceivedImage {
    fn new(picture: &Picture, filters: &Filters) -> Self {
        let size = [picture.width(), picture.height()];
        let opponent: Vec<Vec3> = picture
            .rgba()
            .par_chunks_exact(4)
            .map(|p| to_opponent(decode([p[0], p[1], p[2]])))
            .collect();
        let channel = |axis: usize| Plane::from_fn(size, |i| opponent[i][axis]);
        let [light, red_green, blue_yellow] = [0, 1, 2].map(channel);
        let (edges, points) = filters.features(&light);
        let seen = [
            filters.light.apply(&light),
            filters.red_green.apply(&red_green),
            filters.blue_yellow.apply(&blue_yellow),
        ];
        let color = |i: usize| {
            hunt_lab(
                from_opponent(Vec3::from(seen.each_ref().map(|p| p.values[i])))
                    .clamp(Vec3::ZERO, Vec3::ONE),
            )
        };
        let colors = (0..opponent.len()).into_par_iter().with_min_len(1024).map(color).collect();
        Self { colors, edges, points }
    }
}

/// All filters, for a viewing distance of [`PIXELS_PER_DEGREE`].
struct Filters {
    light: Sensitivity,
    red_green: Sensitivity,
    blue_yellow: Sensitivity,
    /// Gaussian and its first two derivatives.
    feature: [Vec<f32>; 3],
}

/// Blur of one channel by the eye: a sum of Gaussians with their weights.
struct Sensitivity(Vec<(f32, Vec<f32>)>);

/// Term of the contrast sensitivity function: `a sqrt(π/b) exp(-π² d²/b)` at d degrees.
struct Term {
    a: f64,
    b: f64,
}

/// Terms of [ANA20] table 1: light, red to green, blue to yellow.
const LIGHT: [Term; 1] = [Term { a: 1.0, b: 0.0047 }];
const RED_GREEN: [Term; 1] = [Term { a: 1.0, b: 0.0053 }];
const BLUE_YELLOW: [Term; 2] = [Term { a: 34.1, b: 0.04 }, Term { a: 13.5, b: 0.025 }];

/// Largest `b` of all terms: three of its standard deviations bound all filters.
const WIDEST: f64 = 0.04;

/// Width of the feature detector, in degrees: [ANA20] § 4.2.
const FEATURE_WIDTH: f64 = 0.082;

impl Filters {
    fn new() -> Self {
        let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let radius = (3.0 * deviation).ceil() as usize;
        let gaussian = gaussian(deviation, radius);
        let derived = |of: fn(f64) -> f64| -> Vec<f32> {
            let at = |i: usize| (i as f64 - radius as f64) / deviation;
            normalized(&gaussian.iter().enumerate().map(|(i, g)| of(at(i)) * g).collect::<Vec<_>>())
        };
        Self {
            light: Sensitivity::new(&LIGHT),
            red_green: Sensitivity::new(&RED_GREEN),
            blue_yellow: Sensitivity::new(&BLUE_YELLOW),
            feature: [normalized(&gaussian), derived(|x| -x), derived(|x| x * x - 1.0)],
        }
    }

    /// Computes the strength of edges and of points at each pixel of the light channel.
    fn features(&self, light: &Plane) -> (Vec<f32>, Vec<f32>) {
        let [gaussian, first, second] = &self.feature;
        let flat = light.along_rows(gaussian);
        let strength = |derivative: &[f32]| -> Vec<f32> {
            let across = light.along_rows(derivative).down_columns(gaussian).values;
            let down = flat.down_columns(derivative).values;
            across.iter().zip(down).map(|(x, y)| (x * x + y * y).sqrt()).collect()
        };
        (strength(first), strength(second))
    }
}

impl Sensitivity {
    fn new(terms: &[Term]) -> Self {
        use std::f64::consts::PI;
        let deviation = |b: f64| (b / 2.0).sqrt() / PI * PIXELS_PER_DEGREE;
        let radius = (3.0 * deviation(WIDEST)).ceil() as usize;
        let curves = terms.iter().map(|Term { a, b }| {
            let gaussian = gaussian(deviation(*b), radius);
            let volume = a * (PI / b).sqrt() * gaussian.iter().sum::<f64>().powi(2);
            (volume, normalized(&gaussian))
        });
        let curves: Vec<_> = curves.collect();
        let whole: f64 = curves.iter().map(|(volume, _)| volume).sum();
        Self(
            curves
                .into_iter()
                .map(|(volume, gaussian)| ((volume / whole) as f32, gaussian))
                .collect(),
        )
    }

    fn apply(&self, channel: &Plane) -> Plane {
        let blurred = self.0.iter().map(|(part, gaussian)| {
            let mut plane = channel.filtered(gaussian, gaussian);
            plane.values.iter_mut().for_each(|value| *value *= part);
            plane
        });
        let sum = blurred.reduce(|mut sum, plane| {
            sum.values.iter_mut().zip(plane.values).for_each(|(sum, value)| *sum += value);
            sum
        });
        sum.expect("every channel has a term")
    }
}

/// Mapping from colour differences to [0, 1].
struct ColorScale {
    /// Difference of green and blue, the largest of all.
    most: f32,
}

impl ColorScale {
    /// Constants of [ANA20] § 4.1: the exponent, and the knee that leaves the top of the range to
    /// the largest differences.
    const EXPONENT: f32 = 0.7;
    const KNEE: [f32; 2] = [0.4, 0.95];

    fn new() -> Self {
        let [green, blue] = [Vec3::Y, Vec3::Z].map(hunt_lab);
        Self { most: hyab(green, blue).powf(Self::EXPONENT) }
    }

    fn error(&self, reference: Vec3, test: Vec3) -> f32 {
        let [knee, value] = Self::KNEE;
        let part = hyab(reference, test).powf(Self::EXPONENT) / self.most;
        if part < knee {
            part * value / knee
        } else {
            value + (part - knee) / (1.0 - knee) * (1.0 - value)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stripes of two colours, `period` wide, moved by `shift`.
    fn stripes(colors: [[u8; 4]; 2], period: u32, shift: u32) -> Picture {
        let color = |i: u32| colors[((i % 64 + shift) / period % 2) as usize];
        Picture::new(64, 64, (0..64 * 64).flat_map(color).collect()).unwrap()
    }

    fn mean(a: &Picture, b: &Picture) -> f32 {
        flip(a, b).unwrap().iter().sum::<f32>() / (64.0 * 64.0)
    }

    const GREY: [u8; 4] = [128, 128, 128, 255];
    const PALE: [u8; 4] = [150, 150, 150, 255];
    const GREEN: [u8; 4] = [0, 255, 0, 255];
    const BLUE: [u8; 4] = [0, 0, 255, 255];

    #[test]
    fn a_picture_does_not_differ_from_itself() {
        let picture = stripes([GREEN, BLUE], 5, 0);
        assert!(flip(&picture, &picture).unwrap().iter().all(|&error| error == 0.0));
    }

    #[test]
    fn green_and_blue_are_as_far_apart_as_can_be() {
        let [green, blue] = [GREEN, BLUE].map(|color| stripes([color; 2], 5, 0));
        assert!((mean(&green, &blue) - 1.0).abs() < 1e-3, "{}", mean(&green, &blue));
    }

    #[test]
    fn neither_picture_comes_first() {
        let [a, b] = [stripes([GREY, PALE], 7, 0), stripes([GREEN, PALE], 5, 1)];
        assert_eq!(flip(&a, &b).unwrap(), flip(&b, &a).unwrap());
    }

    #[test]
    fn the_farther_stripes_move_the_more_is_seen() {
        let still = stripes([GREY, PALE], 16, 0);
        let errors = [1, 2, 4, 8].map(|shift| mean(&still, &stripes([GREY, PALE], 16, shift)));
        assert!(
            errors.is_sorted() && errors[0] > 0.01 && errors[3] > 2.0 * errors[0],
            "{errors:?}"
        );
    }

    #[test]
    fn what_is_too_fine_for_the_eye_counts_less() {
        let error = |period| {
            let [a, b] = [0, period].map(|shift| stripes([GREY, PALE], period, shift));
            mean(&a, &b)
        };
        assert!(error(1) < 0.2 * error(16), "{} {}", error(1), error(16));
    }

    #[test]
    fn pictures_of_different_sizes_are_refused() {
        let small = Picture::new(1, 1, GREY.to_vec()).unwrap();
        let error = flip(&small, &stripes([GREY; 2], 1, 0)).unwrap_err().to_string();
        assert!(error.contains("1 x 1") && error.contains("64 x 64"), "{error}");
    }
}
