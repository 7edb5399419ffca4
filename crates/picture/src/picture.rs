//! Pictures in memory, and saving them as PNG.

use std::io::Write;

use crate::PictureError;
use crate::error::{check_length, check_size};

/// Picture in memory: sRGB pixels with straight (not premultiplied) alpha, row after row from the
/// top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
}

impl Picture {
    /// Creates a picture from its RGBA pixels: four bytes each, row after row from the top.
    ///
    /// # Errors
    /// A side of zero or above [`MAX_SIDE`](crate::MAX_SIDE), or not `4 * width * height` bytes.
    pub fn new(width: u32, height: u32, rgba: Vec<u8>) -> Result<Self, PictureError> {
        check_size(width.into(), height.into())?;
        check_length("pixel bytes", rgba.len(), 4 * width as usize * height as usize)?;
        Ok(Self { width, height, rgba })
    }

    /// Returns the width of the picture in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the height of the picture in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns all pixels as sRGB and alpha: four bytes each, row after row from the top.
    pub fn rgba(&self) -> &[u8] {
        &self.rgba
    }

    /// Returns the RGBA value of the pixel `x` from the left and `y` from the top.
    ///
    /// Panics outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        assert!(x < self.width && y < self.height, "({x}, {y}) is outside of the picture");
        let at = 4 * (y as usize * self.width as usize + x as usize);
        [self.rgba[at], self.rgba[at + 1], self.rgba[at + 2], self.rgba[at + 3]]
    }

    /// Writes the picture as PNG: RGB if every pixel is opaque, else RGBA.
    ///
    /// The bytes are the same on every run.
    ///
    /// # Errors
    /// Errors of the encoder and of `out`.
    pub fn write_png(&self, out: &mut impl Write) -> Result<(), PictureError> {
        let mut encoder = png::Encoder::new(out, self.width, self.height);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let opaque = self.rgba.iter().skip(3).step_by(4).all(|&alpha| alpha == 255);
        if opaque {
            encoder.set_color(png::ColorType::Rgb);
            let rgb: Vec<u8> = self.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
            encoder.write_header()?.write_image_data(&rgb)?;
        } else {
            encoder.set_color(png::ColorType::Rgba);
            encoder.write_header()?.write_image_data(&self.rgba)?;
        }
        Ok(())
    }

    /// Returns the picture as the bytes of a PNG file.
    pub fn png(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write_png(&mut bytes).expect("a whole picture is always written to memory");
        bytes
    }
}

/// Places pictures side by side in one picture, aligned at the top; the rest is transparent.
///
/// # Errors
/// An empty list, or a result that is too wide.
pub fn side_by_side(pictures: &[Picture]) -> Result<Picture, PictureError> {
    grid(pictures, pictures.len())
}

/// Arranges pictures in a grid with `columns` columns; every cell is as large as the largest
/// picture.
///
/// # Errors
/// An empty list, zero columns, or a result that is too large.
pub fn grid(pictures: &[Picture], columns: usize) -> Result<Picture, PictureError> {
    let columns = columns.min(pictures.len());
    let rows = pictures.len().checked_div(columns).unwrap_or(0)
        + usize::from(columns > 0 && !pictures.len().is_multiple_of(columns));
    let cell_width = pictures.iter().map(|p| p.width).max().unwrap_or(0) as usize;
    let cell_height = pictures.iter().map(|p| p.height).max().unwrap_or(0) as usize;
    let (width, height) = (columns * cell_width, rows * cell_height);
    check_size(width as u64, height as u64)?;
    let mut rgba = vec![0; 4 * width * height];
    for (i, picture) in pictures.iter().enumerate() {
        let (left, top) = (i % columns * cell_width, i / columns * cell_height);
        let row_bytes = 4 * picture.width as usize;
        for (y, row) in picture.rgba.chunks_exact(row_bytes).enumerate() {
            let start = 4 * ((top + y) * width + left);
            rgba[start..start + row_bytes].copy_from_slice(row);
        }
    }
    Picture::new(width as u32, height as u32, rgba)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(width: u32, height: u32, color: [u8; 4]) -> Picture {
        Picture::new(width, height, color.repeat((width * height) as usize)).unwrap()
    }

    fn decode(bytes: &[u8]) -> (png::ColorType, Vec<u8>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        (info.color_type, pixels)
    }

    #[test]
    fn png_drops_alpha_only_where_nothing_is_seen_through() {
        assert_eq!(
            decode(&plain(1, 1, [1, 2, 3, 255]).png()),
            (png::ColorType::Rgb, vec![1, 2, 3])
        );
        let seen_through = plain(1, 1, [1, 2, 3, 9]).png();
        assert_eq!(decode(&seen_through), (png::ColorType::Rgba, vec![1, 2, 3, 9]));
    }

    #[test]
    fn a_picture_needs_all_its_pixels() {
        assert!(Picture::new(2, 2, vec![0; 15]).is_err());
        assert!(Picture::new(0, 2, vec![]).is_err());
    }

    #[test]
    fn a_grid_fills_row_by_row() {
        let [a, b, c] = [1, 2, 3].map(|level| plain(2, 1, [level; 4]));
        let all = grid(&[a, b, c], 2).unwrap();
        assert_eq!((all.width(), all.height()), (4, 2));
        assert_eq!((all.pixel(1, 0), all.pixel(2, 0)), ([1; 4], [2; 4]));
        assert_eq!((all.pixel(0, 1), all.pixel(3, 1)), ([3; 4], [0; 4]));
    }

    #[test]
    fn no_pictures_make_no_grid() {
        assert!(side_by_side(&[]).is_err());
        assert!(grid(&[plain(1, 1, [0; 4])], 0).is_err());
    }
}
