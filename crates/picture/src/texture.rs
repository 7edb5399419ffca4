//! Textures with mipmaps and anisotropic sampling.

use glam::{Vec2, Vec3};

use crate::error::{check_length, check_size};
use crate::srgb::{DECODE, encode};
use crate::{Averaging, PictureError};

/// Texture image in sRGB that repeats over the plane of texture coordinates, with its mipmaps.
///
/// uv (0, 0) is the lower left corner of the image, (1, 1) the upper right.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Mip levels: the image, then successive halves down to a single texel.
    levels: Vec<Level>,
    image_size: [u32; 2],
}

#[derive(Clone, Debug, PartialEq)]
struct Level {
    width: u32,
    height: u32,
    texels: Vec<[u8; 4]>,
}

/// Maximum number of probes along an elongated footprint.
const MAX_PROBES: f32 = 8.0;

impl Texture {
    /// Creates a texture from RGBA texels: four bytes each, row after row from the top.
    ///
    /// Alpha is ignored when drawing. Mipmaps average colours in linear light.
    ///
    /// # Errors
    /// A side of zero or above [`MAX_SIDE`](crate::MAX_SIDE), or not `4 * width * height` bytes.
    pub fn new(width: u32, height: u32, rgba: &[u8]) -> Result<Self, PictureError> {
        Self::new_averaged(width, height, rgba, Averaging::Light)
    }

    /// Creates a texture like [`Texture::new`], given how mipmaps average texels.
    ///
    /// # Errors
    /// Errors of [`Texture::new`].
    pub fn new_averaged(
        width: u32,
        height: u32,
        rgba: &[u8],
        averaging: Averaging,
    ) -> Result<Self, PictureError> {
        check_size(width.into(), height.into())?;
        check_length("texture bytes", rgba.len(), 4 * width as usize * height as usize)?;
        let texels = rgba.chunks_exact(4).map(|t| [t[0], t[1], t[2], t[3]]).collect();
        let mut levels = vec![Level { width, height, texels }];
        while let Some(half) = levels.last().and_then(|level| level.half(averaging)) {
            levels.push(half);
        }
        Ok(Self { levels, image_size: [width, height] })
    }

    /// Notes the size of the image that was made smaller for this texture.
    pub(crate) fn of_image(self, image_size: [u32; 2]) -> Self {
        Self { image_size, ..self }
    }

    /// Returns the width and height in pixels of the image that the texture was decoded from, which
    /// are more than those of its first level if [`Texture::decode`] made it smaller.
    pub fn image_size(&self) -> [u32; 2] {
        self.image_size
    }

    /// Creates a checkerboard texture of `squares` by `squares`, redder to the right and greener
    /// upwards, so that rotation and distortion show.
    pub fn checker(squares: u32) -> Self {
        const SIDE: u32 = 512;
        let squares = squares.clamp(1, SIDE);
        let texel = |i: u32| {
            let (x, y) = (i % SIDE, i / SIDE);
            let (column, row) = (x * squares / SIDE, y * squares / SIDE);
            let light = if (column + row).is_multiple_of(2) { 235 } else { 120 };
            let part = |along: u32| 0.62 + 0.38 * (along as f32 + 0.5) / squares as f32;
            let shade = |amount: f32| (light as f32 * amount) as u8;
            [shade(part(column)), shade(part(squares - 1 - row)), shade(0.80), 255]
        };
        let rgba: Vec<u8> = (0..SIDE * SIDE).flat_map(texel).collect();
        Self::new(SIDE, SIDE, &rgba).expect("the size is right")
    }

    /// Returns the width, height and RGBA texels of the image and of all its mipmaps, row after row
    /// from the top.
    pub fn levels(&self) -> impl Iterator<Item = (u32, u32, &[[u8; 4]])> {
        self.levels.iter().map(|level| (level.width, level.height, &level.texels[..]))
    }

    /// Samples the texture at `uv`, in linear light, averaged over a footprint: the change of uv
    /// per pixel to the right and per pixel down.
    pub(crate) fn sample(&self, uv: Vec2, footprint: [Vec2; 2]) -> Vec3 {
        let base = &self.levels[0];
        let size = Vec2::new(base.width as f32, base.height as f32);
        let [x, y] = footprint.map(|step| (step * size).length());
        let (long, along, short) = if x > y { (x, footprint[0], y) } else { (y, footprint[1], x) };
        // An elongated footprint is covered by several round ones in a row.
        let probes = (long / short.max(1.0)).clamp(1.0, MAX_PROBES).ceil();
        let probes = if probes.is_finite() { probes } else { 1.0 };
        let width = short.max(long / probes);
        let mut sum = Vec3::ZERO;
        for probe in 0..probes as u32 {
            let offset = (probe as f32 + 0.5) / probes - 0.5;
            sum += self.trilinear(uv + along * offset, width);
        }
        sum / probes
    }

    /// Samples around `uv` over a footprint `width` texels wide, between the two nearest mip
    /// levels.
    fn trilinear(&self, uv: Vec2, mut width: f32) -> Vec3 {
        let mut level = 0;
        while width >= 2.0 && level + 1 < self.levels.len() {
            width *= 0.5;
            level += 1;
        }
        let fine = self.levels[level].bilinear(uv);
        match self.levels.get(level + 1) {
            Some(coarse) if width > 1.0 => fine + (coarse.bilinear(uv) - fine) * (width - 1.0),
            _ => fine,
        }
    }
}

impl Level {
    /// Computes the next mip level: the mean of every two by two texels, alpha as it is stored. The
    /// last row or column of an odd side is ignored. Returns `None` for a single texel.
    fn half(&self, averaging: Averaging) -> Option<Self> {
        if self.width == 1 && self.height == 1 {
            return None;
        }
        let [width, height] = [self.width, self.height].map(|side| (side / 2).max(1));
        let mut texels = Vec::with_capacity(width as usize * height as usize);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
                [(2 * x + dx).min(self.width - 1), (2 * y + dy).min(self.height - 1)]
            });
            let mut mean = self.mean_value(four);
            if averaging == Averaging::Light {
                let sum: Vec3 = four.iter().map(|&[x, y]| self.texel(x, y)).sum();
                mean[..3].copy_from_slice(&(sum * 0.25).to_array().map(encode));
            }
            texels.push(mean);
        }
        Some(Self { width, height, texels })
    }

    /// Averages four texels as they are stored.
    fn mean_value(&self, four: [[u32; 2]; 4]) -> [u8; 4] {
        let mut sum = [2u32; 4];
        for [x, y] in four {
            let texel = self.texels[y as usize * self.width as usize + x as usize];
            (0..4).for_each(|channel| sum[channel] += u32::from(texel[channel]));
        }
        sum.map(|sum| (sum / 4) as u8)
    }

    fn texel(&self, x: u32, y: u32) -> Vec3 {
        let [r, g, b, _] = self.texels[y as usize * self.width as usize + x as usize];
        Vec3::new(DECODE[r as usize], DECODE[g as usize], DECODE[b as usize])
    }

    fn bilinear(&self, uv: Vec2) -> Vec3 {
        let ([x0, x1], s) = neighbours(uv.x, self.width);
        let ([y0, y1], t) = neighbours(1.0 - uv.y, self.height);
        let top = self.texel(x0, y0).lerp(self.texel(x1, y0), s);
        let bottom = self.texel(x0, y1).lerp(self.texel(x1, y1), s);
        top.lerp(bottom, t)
    }
}

/// Returns the two texels on either side of a coordinate, and its distance from the first in
/// texels. A coordinate that is not finite counts as zero.
fn neighbours(place: f32, count: u32) -> ([u32; 2], f32) {
    let within = if place.is_finite() { place - place.floor() } else { 0.0 };
    let at = within * count as f32 - 0.5;
    let low = at.floor();
    let wrap = |i: i64| i.rem_euclid(i64::from(count)) as u32;
    ([wrap(low as i64), wrap(low as i64 + 1)], at - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two by two: red and green above, blue and white below.
    fn four() -> Texture {
        let rgba = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]].concat();
        Texture::new(2, 2, &rgba).unwrap()
    }

    const NO_STEP: [Vec2; 2] = [Vec2::ZERO; 2];

    #[test]
    fn the_lower_left_corner_is_the_origin() {
        let at = |u, v| four().sample(Vec2::new(u, v), NO_STEP);
        assert_eq!([at(0.25, 0.75), at(0.75, 0.75)], [Vec3::X, Vec3::Y]);
        assert_eq!([at(0.25, 0.25), at(0.75, 0.25)], [Vec3::Z, Vec3::ONE]);
    }

    #[test]
    fn it_repeats() {
        for shift in [-3.0, 1.0, 8.0] {
            assert_eq!(four().sample(Vec2::new(0.25 + shift, 0.75 - shift), NO_STEP), Vec3::X);
        }
    }

    #[test]
    fn between_texels_it_blends_even_across_the_border() {
        let at = |u, v| four().sample(Vec2::new(u, v), NO_STEP);
        let mean = Vec3::new(0.5, 0.5, 0.5);
        assert_eq!([at(0.5, 0.5), at(0.0, 0.0), at(1.0, 0.5)], [mean; 3]);
    }

    #[test]
    fn from_afar_it_is_its_mean() {
        let step = [Vec2::X * 40.0, Vec2::Y * 40.0];
        let far = four().sample(Vec2::new(0.3, 0.9), step);
        assert!((far - Vec3::splat(0.5)).abs().max_element() < 0.005, "{far}");
    }

    #[test]
    fn mipmaps_average_light_or_values_and_keep_alpha() {
        let rgba = [[0, 0, 0, 100], [255, 255, 255, 201]].concat();
        for (averaging, grey) in [(Averaging::Light, 188), (Averaging::Values, 128)] {
            let texture = Texture::new_averaged(2, 1, &rgba, averaging).unwrap();
            let levels: Vec<_> = texture.levels().collect();
            assert_eq!(levels[1], (1, 1, &[[grey, grey, grey, 151]][..]));
        }
    }

    #[test]
    fn odd_places_are_no_trouble() {
        for place in [f32::NAN, f32::INFINITY, -1e30, 1e30] {
            let uv = Vec2::splat(place);
            assert!(four().sample(uv, [uv, Vec2::ZERO]).is_finite());
        }
        let checker = Texture::checker(0);
        assert!(checker.sample(Vec2::ZERO, [Vec2::splat(1e-30); 2]).is_finite());
    }
}
