//! Atlas of pictures that are seen through, and its mipmaps.

use glam::{Vec2, Vec3, Vec4};

use crate::srgb::{decode, encode};
use crate::{Picture, PictureError};

/// Square pictures of one size side by side, each with its own mipmaps down to a single texel.
///
/// Cells are numbered row after row from the top. Memory: 21 bytes a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct CardAtlas {
    /// Side of a cell in the finest level.
    cell_px: u32,
    /// Cells across and down.
    cells: [u32; 2],
    levels: Vec<CardLevel>,
}

/// Mip level: linear light times alpha, and alpha.
#[derive(Clone, Debug, PartialEq)]
struct CardLevel {
    /// Side of a cell in texels.
    side: u32,
    /// Width of the atlas in texels.
    width: u32,
    texels: Vec<Vec4>,
}

impl CardAtlas {
    /// Creates an atlas from a picture whose cells are `cell_px` pixels wide and high.
    ///
    /// # Errors
    /// A side of cells that is no power of two, or does not divide those of the picture.
    pub fn new(picture: &Picture, cell_px: u32) -> Result<Self, PictureError> {
        let [width, height] = [picture.width(), picture.height()];
        let fits = |side: u32| side.is_multiple_of(cell_px);
        if !cell_px.is_power_of_two() || !fits(width) || !fits(height) {
            return Err(PictureError::Cell { cell_px, width, height });
        }
        let texel = |p: &[u8]| {
            let alpha = f32::from(p[3]) / 255.0;
            (decode([p[0], p[1], p[2]]) * alpha).extend(alpha)
        };
        let texels = picture.rgba().chunks_exact(4).map(texel).collect();
        let mut levels = vec![CardLevel { side: cell_px, width, texels }];
        while let Some(half) = levels.last().and_then(CardLevel::half) {
            levels.push(half);
        }
        Ok(Self { cell_px, cells: [width / cell_px, height / cell_px], levels })
    }

    /// Returns the number of cells.
    pub fn cells(&self) -> usize {
        self.cells[0] as usize * self.cells[1] as usize
    }

    /// Returns the side of a cell in pixels.
    pub(super) fn cell_px(&self) -> u32 {
        self.cell_px
    }

    /// Samples a cell, averaged over a square footprint `width` texels wide: linear light times
    /// alpha, and alpha. `at` is (0, 0) in the upper left corner of the cell, (1, 1) in the lower
    /// right.
    pub(super) fn sample(&self, cell: usize, at: Vec2, mut width: f32) -> Vec4 {
        let mut level = 0;
        while width >= 2.0 && level + 1 < self.levels.len() {
            width *= 0.5;
            level += 1;
        }
        let across = self.cells[0] as usize;
        let place = [(cell % across) as u32, (cell / across) as u32];
        let fine = self.levels[level].bilinear(place, at);
        match self.levels.get(level + 1) {
            Some(coarse) if width > 1.0 => fine.lerp(coarse.bilinear(place, at), width - 1.0),
            _ => fine,
        }
    }
}

impl CardLevel {
    /// Computes the next mip level; `None` if cells are single texels.
    fn half(&self) -> Option<Self> {
        if self.side == 1 {
            return None;
        }
        let width = self.width / 2;
        let half = |i: u32| {
            let (x, y) = (2 * (i % width), 2 * (i / width));
            let four = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
            four.map(|(x, y)| self.texel(x, y)).into_iter().sum::<Vec4>() * 0.25
        };
        let texels = (0..self.texels.len() as u32 / 4).map(half).collect();
        Some(Self { side: self.side / 2, width, texels })
    }

    fn texel(&self, x: u32, y: u32) -> Vec4 {
        self.texels[y as usize * self.width as usize + x as usize]
    }

    /// Blends the four texels of a cell around a point; those beyond its rim count as those at it.
    fn bilinear(&self, place: [u32; 2], at: Vec2) -> Vec4 {
        let last = (self.side - 1) as f32;
        let along = |axis: usize| {
            let x = (at[axis] * self.side as f32 - 0.5).max(0.0).min(last);
            let (first, low) = (place[axis] * self.side, x as u32);
            ([first + low, first + (low + 1).min(self.side - 1)], x - low as f32)
        };
        let ([x0, x1], s) = along(0);
        let ([y0, y1], t) = along(1);
        let row = |y: u32| self.texel(x0, y).lerp(self.texel(x1, y), s);
        row(y0).lerp(row(y1), t)
    }
}

/// Returns a picture whose transparent pixels have the colour of the nearest ones in their cell
/// that are not, and stay transparent.
///
/// Renderers that filter colours and alpha apart would otherwise mix the colour of nothing into the
/// rims. A cell without a visible pixel stays as it is.
///
/// # Errors
/// A side of cells that is no power of two, or does not divide those of the picture.
pub fn bleed(picture: &Picture, cell_px: u32) -> Result<Picture, PictureError> {
    let atlas = CardAtlas::new(picture, cell_px)?;
    let width = picture.width();
    let mut rgba = picture.rgba().to_vec();
    for (pixel, i) in rgba.chunks_exact_mut(4).zip(0u32..).filter(|(pixel, _)| pixel[3] == 0) {
        let (x, y) = (i % width, i / width);
        let mut above = (1u32..).zip(&atlas.levels[1..]);
        let near = above.find_map(|(level, texels)| {
            let texel = texels.texel(x >> level, y >> level);
            (texel.w > 0.0).then(|| texel.truncate() / texel.w)
        });
        let color: Option<Vec3> = near;
        if let Some(color) = color {
            pixel[..3].copy_from_slice(&color.to_array().map(encode));
        }
    }
    Picture::new(width, picture.height(), rgba)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two cells of two by two: an opaque red texel in the left one, the right one half green.
    fn two() -> Picture {
        let (red, none, green) = ([255, 0, 0, 255], [0; 4], [0, 255, 0, 128]);
        let rows = [[red, none, green, green], [none, none, green, green]];
        Picture::new(4, 2, rows.as_flattened().as_flattened().to_vec()).unwrap()
    }

    #[test]
    fn cells_do_not_mix() {
        let atlas = CardAtlas::new(&two(), 2).unwrap();
        assert_eq!(atlas.cells(), 2);
        for width in [0.0, 1.5, 2.0, 99.0] {
            for x in [-1.0, 0.0, 0.5, 1.0, f32::NAN] {
                let [left, right] = [0, 1].map(|cell| atlas.sample(cell, Vec2::splat(x), width));
                assert_eq!((left.y, right.x), (0.0, 0.0), "{width} {x}");
                assert!((right.w - 128.0 / 255.0).abs() < 1e-6 && right.y == right.w);
            }
        }
        let far = atlas.sample(0, Vec2::splat(0.5), 2.0);
        assert_eq!(far, Vec4::new(0.25, 0.0, 0.0, 0.25));
    }

    #[test]
    fn transparent_pixels_get_the_colour_of_their_cell() {
        let filled = bleed(&two(), 2).unwrap();
        assert_eq!(filled.pixel(0, 0), [255, 0, 0, 255]);
        assert_eq!(filled.pixel(1, 1), [255, 0, 0, 0]);
        assert_eq!(filled.pixel(3, 1), [0, 255, 0, 128]);
        let nothing = Picture::new(2, 2, vec![0; 16]).unwrap();
        assert_eq!(bleed(&nothing, 2).unwrap(), nothing);
    }

    #[test]
    fn cells_that_do_not_fit_are_refused() {
        for cell_px in [0, 3, 4] {
            assert!(matches!(
                CardAtlas::new(&two(), cell_px),
                Err(PictureError::Cell { width: 4, height: 2, .. })
            ));
        }
    }
}
