//! Large images made smaller row by row, while they are decoded.

use crate::srgb::{DECODE, encode};
use crate::{PictureError, Texture};

/// Maximum number of texels of a decoded texture: 4096 by 4096 take 64 MiB, 85 with mipmaps.
pub const MAX_TEXELS: u64 = 1 << 24;

/// Mean of the texels that become one in a smaller version of an image, such as a mipmap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Averaging {
    /// Averages colours in linear light, and alpha as it is stored.
    Light,
    /// Averages all channels as they are stored, as normals and roughness need it.
    Values,
}

impl Averaging {
    fn is_light(self, channel: usize) -> bool {
        self == Self::Light && channel < 3
    }
}

/// Texture in the making, from rows that come from the top.
///
/// Squares of 1, 2 by 2 or 4 by 4 pixels become texels. Pixels left over at the right and at the
/// bottom are ignored, as by mipmaps.
pub(crate) struct Shrinker {
    image_size: [u32; 2],
    factor: usize,
    channels: usize,
    averaging: Averaging,
    /// Sums of the squares that the next row adds to.
    sums: Vec<[f32; 4]>,
    rows: usize,
    texels: Vec<u8>,
}

impl Shrinker {
    /// Starts an image of 1 to 4 channels: grey, grey and alpha, colour, colour and alpha.
    pub fn new(image_size: [u32; 2], channels: usize, averaging: Averaging) -> Self {
        let factor = shrink_factor(image_size) as usize;
        let [width, height] = image_size.map(|side| side as usize / factor);
        let sums = if factor > 1 { vec![[0.0; 4]; width] } else { Vec::new() };
        let texels = Vec::with_capacity(4 * width * height);
        Self { image_size, factor, channels, averaging, sums, rows: 0, texels }
    }

    /// Adds the next row, one byte per channel. Rows below the image are ignored.
    pub fn push(&mut self, row: &[u8]) {
        let (widen, averaging) = (widen(self.channels), self.averaging);
        let pixels = row.chunks_exact(self.channels).map(widen);
        self.rows += 1;
        if self.factor == 1 {
            self.texels.extend(pixels.flatten());
            return;
        }
        for (x, pixel) in pixels.enumerate() {
            let Some(sum) = self.sums.get_mut(x / self.factor) else { break };
            for (channel, (sum, value)) in sum.iter_mut().zip(pixel).enumerate() {
                *sum += match averaging.is_light(channel) {
                    true => DECODE[value as usize],
                    false => f32::from(value),
                };
            }
        }
        if self.rows.is_multiple_of(self.factor) {
            self.finish_squares();
        }
    }

    fn finish_squares(&mut self) {
        let averaging = self.averaging;
        let part = 1.0 / (self.factor * self.factor) as f32;
        for i in 0..self.sums.len() {
            let sum = std::mem::take(&mut self.sums[i]);
            self.texels.extend((0..4).map(|channel| match averaging.is_light(channel) {
                true => encode(sum[channel] * part),
                false => (sum[channel] * part + 0.5) as u8,
            }));
        }
    }

    /// Returns the texture.
    ///
    /// # Errors
    /// Fewer rows or pixels than the image has.
    pub fn finish(self) -> Result<Texture, PictureError> {
        let [width, height] = self.image_size.map(|side| side / self.factor as u32);
        let texture = Texture::new_averaged(width, height, &self.texels, self.averaging)?;
        Ok(texture.of_image(self.image_size))
    }
}

/// Returns how many pixels of an image, along each side, become one texel: 1, 2 or 4.
pub(crate) fn shrink_factor([width, height]: [u32; 2]) -> u32 {
    let fits = |factor: &u32| u64::from(width / factor) * u64::from(height / factor) <= MAX_TEXELS;
    [1, 2].into_iter().find(fits).unwrap_or(4)
}

fn widen(channels: usize) -> fn(&[u8]) -> [u8; 4] {
    match channels {
        1 => |p| [p[0], p[0], p[0], 255],
        2 => |p| [p[0], p[0], p[0], p[1]],
        3 => |p| [p[0], p[1], p[2], 255],
        _ => |p| [p[0], p[1], p[2], p[3]],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shrunk(size: [u32; 2], row: &[u8], averaging: Averaging) -> Texture {
        let mut shrinker = Shrinker::new(size, row.len() / size[0] as usize, averaging);
        (0..size[1]).for_each(|_| shrinker.push(row));
        shrinker.finish().unwrap()
    }

    #[test]
    fn sizes_up_to_the_bound_stay() {
        for (size, factor) in [
            ([4096, 4096], 1),
            ([16_384, 1024], 1),
            ([4097, 4096], 2),
            ([8193, 8193], 2),
            ([8194, 8192], 4),
            ([16_384, 16_384], 4),
        ] {
            assert_eq!(shrink_factor(size), factor, "{size:?}");
        }
    }

    #[test]
    fn squares_become_their_mean() {
        // Columns of black and white, with an odd one at the end that is ignored.
        let mut row = [[0, 0, 0, 100], [255, 255, 255, 201]].concat().repeat(4096);
        row.extend([7; 4]);
        for (averaging, level) in [(Averaging::Light, 188), (Averaging::Values, 128)] {
            let texture = shrunk([8193, 2049], &row, averaging);
            assert_eq!(texture.image_size(), [8193, 2049]);
            let (width, height, texels) = texture.levels().next().unwrap();
            assert_eq!([width, height], [4096, 1024]);
            assert!(texels.iter().all(|&texel| texel == [level, level, level, 151]));
        }
    }

    #[test]
    fn fewer_rows_are_an_error() {
        let mut shrinker = Shrinker::new([8192, 8192], 1, Averaging::Light);
        (0..8190).for_each(|_| shrinker.push(&[9; 8192]));
        assert!(shrinker.finish().is_err());
    }
}
