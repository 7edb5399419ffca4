//! Decoding of PNG, JPEG and WebP files as textures.

use std::io::Cursor;

use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;

use crate::error::check_size;
use crate::{MAX_SIDE, PictureError, Texture};

/// First bytes of every JPEG file.
const JPEG_START: [u8; 2] = [0xff, 0xd8];

/// Maximum number of bytes that one byte of a deflate stream can expand to.
const MAX_DEFLATE_RATIO: usize = 1032;

/// Maximum number of pixels of a WebP, of which any number may take a few bytes; 2^26 take 256 MB.
const MAX_WEBP_PIXELS: usize = 1 << 26;

/// Maximum number of pixels per byte of a JPEG: every block of 8 by 8 takes at least a bit.
const MAX_JPEG_RATIO: usize = 8 * 64;

impl Texture {
    /// Decodes a PNG, JPEG or WebP file as a texture; the type is detected from the first bytes.
    ///
    /// Grey, palette and 16-bit images are converted to 8-bit colour.
    ///
    /// # Errors
    /// Damaged or truncated files, and images with a side above [`MAX_SIDE`].
    pub fn decode(bytes: &[u8]) -> Result<Self, PictureError> {
        match bytes {
            _ if bytes.starts_with(&JPEG_START) => Self::from_jpeg(bytes),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => {
                Self::from_webp(bytes)
            }
            _ => Self::from_png(bytes),
        }
    }

    /// Decodes a PNG file as a texture.
    ///
    /// # Errors
    /// Errors of [`Texture::decode`].
    pub fn from_png(bytes: &[u8]) -> Result<Self, PictureError> {
        let wrong = |e: png::DecodingError| damaged("png", e);
        let mut decoder = png::Decoder::new(Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::normalize_to_color8());
        let mut reader = decoder.read_info().map_err(wrong)?;
        let (width, height) = (reader.info().width, reader.info().height);
        check_size(width.into(), height.into())?;
        check_plausible("png", reader.info().raw_bytes(), MAX_DEFLATE_RATIO, bytes)?;
        let length = reader.output_buffer_size();
        let length = length.ok_or_else(|| damaged("png", "the image does not fit in memory"))?;
        let mut pixels = vec![0; length];
        let frame = reader.next_frame(&mut pixels).map_err(wrong)?;
        let rgba = match frame.color_type {
            png::ColorType::Rgba => pixels,
            png::ColorType::Rgb => rgba(&pixels, 3, |p| [p[0], p[1], p[2], 255]),
            png::ColorType::GrayscaleAlpha => rgba(&pixels, 2, |p| [p[0], p[0], p[0], p[1]]),
            png::ColorType::Grayscale => rgba(&pixels, 1, |p| [p[0], p[0], p[0], 255]),
            png::ColorType::Indexed => return Err(damaged("png", "its palette was not applied")),
        };
        Self::new(width, height, &rgba)
    }

    /// Decodes a WebP file as a texture; of an animation, the first picture.
    ///
    /// # Errors
    /// Errors of [`Texture::decode`]; also more than 2^26 pixels, as a few bytes may stand for all
    /// of them.
    pub fn from_webp(bytes: &[u8]) -> Result<Self, PictureError> {
        let wrong = |e: image_webp::DecodingError| damaged("webp", e);
        let mut decoder = image_webp::WebPDecoder::new(Cursor::new(bytes)).map_err(wrong)?;
        decoder.set_memory_limit(8 * MAX_WEBP_PIXELS);
        let (width, height) = decoder.dimensions();
        check_size(width.into(), height.into())?;
        let length = decoder.output_buffer_size();
        let length = length.filter(|_| width as usize * height as usize <= MAX_WEBP_PIXELS);
        let length = length.ok_or_else(|| damaged("webp", "it has more than 2^26 pixels"))?;
        let mut pixels = vec![0; length];
        decoder.read_image(&mut pixels).map_err(wrong)?;
        let rgba = match decoder.has_alpha() {
            true => pixels,
            false => rgba(&pixels, 3, |p| [p[0], p[1], p[2], 255]),
        };
        Self::new(width, height, &rgba)
    }

    /// Decodes a JPEG file as a texture.
    ///
    /// # Errors
    /// Errors of [`Texture::decode`].
    pub fn from_jpeg(bytes: &[u8]) -> Result<Self, PictureError> {
        let options = DecoderOptions::default()
            .set_max_width(MAX_SIDE as usize)
            .set_max_height(MAX_SIDE as usize)
            .jpeg_set_out_colorspace(ColorSpace::RGBA);
        let mut decoder = zune_jpeg::JpegDecoder::new_with_options(Cursor::new(bytes), options);
        let wrong = |e: zune_jpeg::errors::DecodeErrors| damaged("jpeg", format!("{e:?}"));
        decoder.decode_headers().map_err(wrong)?;
        let size = decoder.dimensions().ok_or_else(|| damaged("jpeg", "the size is missing"))?;
        check_size(size.0 as u64, size.1 as u64)?;
        check_plausible("jpeg", size.0 * size.1, MAX_JPEG_RATIO, bytes)?;
        let pixels = decoder.decode().map_err(wrong)?;
        Self::new(size.0 as u32, size.1 as u32, &pixels)
    }
}

/// Rejects a file too short for the size in its header, before memory is allocated for it.
fn check_plausible(
    kind: &'static str,
    claimed: usize,
    per_byte: usize,
    bytes: &[u8],
) -> Result<(), PictureError> {
    if claimed / per_byte <= bytes.len() {
        return Ok(());
    }
    Err(damaged(kind, format!("{} bytes cannot hold an image of the declared size", bytes.len())))
}

fn rgba(pixels: &[u8], width: usize, widen: impl Fn(&[u8]) -> [u8; 4]) -> Vec<u8> {
    pixels.chunks_exact(width).flat_map(widen).collect()
}

fn damaged(kind: &'static str, reason: impl ToString) -> PictureError {
    PictureError::Decode { kind, reason: reason.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Picture;

    fn png_of(rgba: &[u8]) -> Vec<u8> {
        Picture::new(2, 1, rgba.to_vec()).unwrap().png()
    }

    #[test]
    fn a_png_comes_back_as_it_was_written() {
        for rgba in [[1, 2, 3, 255, 9, 8, 7, 255], [1, 2, 3, 4, 5, 6, 7, 8]] {
            let texture = Texture::decode(&png_of(&rgba)).unwrap();
            assert_eq!(texture, Texture::new(2, 1, &rgba).unwrap());
        }
    }

    /// Eight by eight pixels of one grey: a table of ones, one code of one bit for each Huffman
    /// table, and two bits of data.
    fn grey_jpeg() -> Vec<u8> {
        let quantizers = [&[0xff, 0xdb, 0, 67, 0][..], &[1; 64]].concat();
        let frame = [0xff, 0xc0, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0];
        let huffman = |class| {
            let mut lengths = [0; 16];
            lengths[0] = 1;
            [&[0xff, 0xc4, 0, 20, class][..], &lengths, &[0]].concat()
        };
        let scan = [0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0, 0b0011_1111, 0xff, 0xd9];
        [&JPEG_START[..], &quantizers, &frame, &huffman(0x00), &huffman(0x10), &scan].concat()
    }

    #[test]
    fn a_jpeg_is_read() {
        let grey = Texture::new(8, 8, &[128, 128, 128, 255].repeat(64)).unwrap();
        assert_eq!(Texture::decode(&grey_jpeg()).unwrap(), grey);
    }

    #[test]
    fn a_jpeg_that_lies_about_its_size_is_refused() {
        let mut bytes = grey_jpeg();
        let frame = bytes.windows(2).position(|mark| mark == [0xff, 0xc0]).unwrap();
        bytes[frame + 5..frame + 9].copy_from_slice(&[0x40, 0, 0x40, 0]);
        let message = Texture::decode(&bytes).unwrap_err().to_string();
        assert!(message.contains("cannot hold"), "{message}");
    }

    fn webp_of(rgba: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let encoder = image_webp::WebPEncoder::new(&mut bytes);
        encoder.encode(rgba, 2, 1, image_webp::ColorType::Rgba8).unwrap();
        bytes
    }

    #[test]
    fn a_webp_is_read() {
        for rgba in [[1, 2, 3, 255, 9, 8, 7, 255], [1, 2, 3, 4, 5, 6, 7, 8]] {
            let texture = Texture::decode(&webp_of(&rgba)).unwrap();
            assert_eq!(texture, Texture::new(2, 1, &rgba).unwrap());
        }
    }

    #[test]
    fn a_webp_of_more_pixels_than_fit_is_refused_before_memory_is_taken() {
        let mut bytes = webp_of(&[0; 8]);
        let size = bytes.windows(5).position(|b| b.starts_with(b"VP8L")).unwrap() + 9;
        // Width and height of 2^14 - 1, each less one in 14 bits.
        bytes[size..size + 3].copy_from_slice(&[0xfe, 0xbf, 0xff]);
        bytes[size + 3] |= 0x0f;
        let message = Texture::decode(&bytes).unwrap_err().to_string();
        assert!(message.contains("2^26"), "{message}");
    }

    #[test]
    fn every_cut_of_a_file_is_an_error() {
        let whole = png_of(&[1, 2, 3, 255, 9, 8, 7, 255]);
        // The end mark, 12 bytes, carries nothing.
        for length in 0..whole.len() - 12 {
            assert!(Texture::decode(&whole[..length]).is_err(), "{length} bytes");
        }
        assert!(Texture::decode(&JPEG_START).is_err());
        assert!(Texture::decode(&[0xff, 0xd8, 0xff, 0xe0, 0, 16, b'J', b'F']).is_err());
    }

    #[test]
    fn a_header_that_lies_about_its_size_is_refused() {
        let mut bytes = png_of(&[0; 8]);
        for claim in [0x7fff_ffff, MAX_SIDE] {
            bytes[16..20].copy_from_slice(&claim.to_be_bytes());
            assert!(Texture::decode(&bytes).is_err());
        }
    }
}
