//! Perceptually uniform colour maps.

use glam::Vec3;

use crate::{Picture, PictureError, srgb};

/// Perceptually uniform colour map, which shows numbers as colours.
///
/// All maps are interpolated in Oklab [Ott20], where equal steps look equally large.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMap {
    /// Pale grey at zero, then yellow and red to deep purple at the maximum: for errors on a
    /// surface.
    #[default]
    Heat,
    /// Deep violet over green to yellow, with evenly rising lightness: for any quantity.
    Sequential,
    /// Blue over near-white to red: for signed quantities with zero in the middle.
    Diverging,
}

/// Number of entries in a look-up table.
const STEPS: usize = 256;

/// Oklab coordinates: lightness, green to red, blue to yellow. Control points are evenly spaced.
type Oklab = [f32; 3];

const HEAT: [Oklab; 6] = [
    [0.81, -0.008, -0.018],
    [0.85, -0.014, 0.128],
    [0.77, 0.070, 0.145],
    [0.60, 0.195, 0.105],
    [0.43, 0.165, -0.010],
    [0.26, 0.085, -0.070],
];

const SEQUENTIAL: [Oklab; 6] = [
    [0.27, 0.069, -0.098],
    [0.40, 0.011, -0.125],
    [0.53, -0.065, -0.068],
    [0.66, -0.115, 0.031],
    [0.79, -0.105, 0.130],
    [0.92, -0.030, 0.172],
];

const DIVERGING: [Oklab; 5] = [
    [0.42, -0.025, -0.145],
    [0.70, -0.045, -0.085],
    [0.95, 0.000, 0.000],
    [0.72, 0.105, 0.060],
    [0.46, 0.170, 0.075],
];

impl ColorMap {
    /// Returns the sRGB colour for the number `t`, clamped to [0, 1]; grey for NaN.
    pub fn color(self, t: f32) -> [u8; 3] {
        if t.is_nan() {
            return NOT_A_NUMBER;
        }
        self.linear(t).to_array().map(srgb::encode)
    }

    /// Draws the colour map as a horizontal bar for use as a legend, with the minimum at the left.
    ///
    /// # Errors
    /// A width or height out of range.
    pub fn bar(self, width: u32, height: u32) -> Result<Picture, PictureError> {
        crate::error::check_size(width.into(), height.into())?;
        let pixel = |x: u32| {
            let [r, g, b] = self.color((x as f32 + 0.5) / width as f32);
            [r, g, b, 255]
        };
        let row: Vec<u8> = (0..width).flat_map(pixel).collect();
        Picture::new(width, height, row.repeat(height as usize))
    }

    fn linear(self, t: f32) -> Vec3 {
        let points: &[Oklab] = match self {
            Self::Heat => &HEAT,
            Self::Sequential => &SEQUENTIAL,
            Self::Diverging => &DIVERGING,
        };
        let at = t.clamp(0.0, 1.0) * (points.len() - 1) as f32;
        let low = (at as usize).min(points.len() - 2);
        let [a, b] = [low, low + 1].map(|i| Vec3::from(points[i]));
        linear_rgb(a + (b - a) * (at - low as f32))
    }
}

const NOT_A_NUMBER: [u8; 3] = [128, 128, 128];

/// Colour map over a range of values, prepared for many look-ups.
pub(crate) struct Scale {
    table: Vec<Vec3>,
    low: f32,
    per_value: f32,
}

impl Scale {
    pub(crate) fn new(map: ColorMap, range: [f32; 2]) -> Self {
        let table = (0..STEPS).map(|i| map.linear(i as f32 / (STEPS - 1) as f32)).collect();
        let [low, high] = range;
        let span = high - low;
        let per_value = if span != 0.0 && span.is_finite() { 1.0 / span } else { 0.0 };
        Self { table, low, per_value }
    }

    /// Returns the linear colour of a value.
    pub(crate) fn color(&self, value: f32) -> Vec3 {
        if value.is_nan() {
            return srgb::decode(NOT_A_NUMBER);
        }
        let t = ((value - self.low) * self.per_value).clamp(0.0, 1.0);
        self.table[(t * (STEPS - 1) as f32 + 0.5) as usize]
    }
}

/// Converts Oklab to linear sRGB with the two matrices of [Ott20].
#[allow(clippy::excessive_precision)]
fn linear_rgb(lab: Vec3) -> Vec3 {
    let [lightness, a, b] = lab.to_array();
    let cubed = |x: f32| x * x * x;
    let l = cubed(lightness + 0.3963377774 * a + 0.2158037573 * b);
    let m = cubed(lightness - 0.1055613458 * a - 0.0638541728 * b);
    let s = cubed(lightness - 0.0894841775 * a - 1.2914855480 * b);
    let rgb = Vec3::new(
        4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
        -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
        -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s,
    );
    rgb.clamp(Vec3::ZERO, Vec3::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(color: [u8; 3]) -> f32 {
        srgb::decode(color).dot(Vec3::new(0.2126, 0.7152, 0.0722))
    }

    #[test]
    fn oklab_white_and_grey_are_neutral() {
        assert!((linear_rgb(Vec3::X) - Vec3::ONE).abs().max_element() < 1e-3);
        let grey = linear_rgb(Vec3::X * 0.5);
        assert!((grey.max_element() - grey.min_element()) < 1e-3);
    }

    #[test]
    fn lightness_goes_one_way() {
        for i in 0..20 {
            let [a, b] = [i, i + 1].map(|i| i as f32 / 20.0);
            let at = |map: ColorMap, t| luminance(map.color(t));
            assert!(at(ColorMap::Sequential, a) < at(ColorMap::Sequential, b), "{a}");
            // Heat begins with a change of hue alone.
            assert!(at(ColorMap::Heat, a) > at(ColorMap::Heat, b) - 0.03, "{a}");
        }
    }

    #[test]
    fn values_beyond_the_range_take_its_ends() {
        let scale = Scale::new(ColorMap::Sequential, [1.0, 3.0]);
        assert_eq!(scale.color(-5.0), scale.color(1.0));
        assert_eq!(scale.color(f32::INFINITY), scale.color(3.0));
        assert_ne!(scale.color(1.0), scale.color(3.0));
        assert_eq!(scale.color(f32::NAN), srgb::decode(NOT_A_NUMBER));
    }

    #[test]
    fn a_range_of_one_value_is_no_trouble() {
        assert!(Scale::new(ColorMap::Heat, [2.0, 2.0]).color(2.0).is_finite());
        assert!(Scale::new(ColorMap::Heat, [f32::NAN, 2.0]).color(2.0).is_finite());
    }
}
