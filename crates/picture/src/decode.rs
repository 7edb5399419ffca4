//! Decoding of PNG, JPEG and WebP files as textures.

use std::io::Cursor;

use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;

use crate::error::check_size;
use crate::shrink::{Shrinker, shrink_factor};
use crate::{Averaging, MAX_SIDE, PictureError, Texture};

/// First bytes of every JPEG file.
const JPEG_START: [u8; 2] = [0xff, 0xd8];

/// Maximum number of bytes that one byte of a deflate stream can expand to.
const MAX_DEFLATE_RATIO: usize = 1032;

/// Maximum number of pixels per byte of a JPEG: every block of 8 by 8 takes at least a bit.
const MAX_JPEG_RATIO: usize = 8 * 64;

/// Maximum number of bytes that decoding may allocate, not counting the file and the texture.
const MAX_MEMORY: usize = 1 << 30;

/// Bytes for each pixel of an image that is decoded whole. A progressive JPEG takes more by its
/// coefficients, for each channel; of a WebP without alpha 7 were measured.
const JPEG_BYTES: usize = 3;
const COEFFICIENT_BYTES: usize = 2;
const WEBP_BYTES: usize = 8;

impl Texture {
    /// Decodes a PNG, JPEG or WebP file as a texture; the type is detected from the first bytes.
    /// Of an animation, the first picture is taken.
    ///
    /// Grey, palette and 16-bit images are converted to 8-bit colour. Images of more than 2^24
    /// pixels are made smaller: squares of 2 by 2 or 4 by 4 pixels become texels, averaged in
    /// linear light. [`Texture::image_size`] has the size that the image had.
    ///
    /// # Errors
    /// Damaged or truncated files, images with a side above [`MAX_SIDE`], and those whose decoding
    /// takes more than 1 GiB: progressive colour JPEGs of more than 119 million pixels,
    /// WebPs of more than 134 million.
    pub fn decode(bytes: &[u8]) -> Result<Self, PictureError> {
        Self::decode_averaged(bytes, Averaging::Light)
    }

    /// Decodes a file like [`Texture::decode`], given how large images and mipmaps are averaged.
    ///
    /// # Errors
    /// Errors of [`Texture::decode`].
    pub fn decode_averaged(bytes: &[u8], averaging: Averaging) -> Result<Self, PictureError> {
        match bytes {
            _ if bytes.starts_with(&JPEG_START) => of_jpeg(bytes, averaging),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => {
                of_webp(bytes, averaging)
            }
            _ => of_png(bytes, averaging),
        }
    }
}

/// Decodes a PNG: a large one by rows, unless these are interlaced.
fn of_png(bytes: &[u8], averaging: Averaging) -> Result<Texture, PictureError> {
    let wrong = |e: png::DecodingError| damaged("png", e);
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(wrong)?;
    let size = [reader.info().width, reader.info().height];
    check_size(size[0].into(), size[1].into())?;
    check_plausible("png", reader.info().raw_bytes(), MAX_DEFLATE_RATIO, bytes)?;
    let channels = match reader.output_color_type().0 {
        png::ColorType::Indexed => return Err(damaged("png", "its palette was not applied")),
        colors => colors.samples(),
    };
    if shrink_factor(size) > 1 && !reader.info().interlaced {
        let mut shrinker = Shrinker::new(size, channels, averaging);
        while let Some(row) = reader.next_row().map_err(wrong)? {
            shrinker.push(row.data());
        }
        return shrinker.finish();
    }
    let length = reader.output_buffer_size().filter(|&length| length <= MAX_MEMORY);
    let length = length.ok_or_else(|| damaged("png", TOO_LARGE))?;
    let mut pixels = vec![0; length];
    reader.next_frame(&mut pixels).map_err(wrong)?;
    of_pixels(size, channels, &pixels, averaging)
}

fn of_webp(bytes: &[u8], averaging: Averaging) -> Result<Texture, PictureError> {
    let wrong = |e: image_webp::DecodingError| damaged("webp", e);
    let mut decoder = image_webp::WebPDecoder::new(Cursor::new(bytes)).map_err(wrong)?;
    decoder.set_memory_limit(MAX_MEMORY);
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into())?;
    check_memory("webp", [width, height], WEBP_BYTES)?;
    let length = decoder.output_buffer_size().ok_or_else(|| damaged("webp", TOO_LARGE))?;
    let mut pixels = vec![0; length];
    decoder.read_image(&mut pixels).map_err(wrong)?;
    of_pixels([width, height], if decoder.has_alpha() { 4 } else { 3 }, &pixels, averaging)
}

fn of_jpeg(bytes: &[u8], averaging: Averaging) -> Result<Texture, PictureError> {
    let options = DecoderOptions::default()
        .set_max_width(MAX_SIDE as usize)
        .set_max_height(MAX_SIDE as usize)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(Cursor::new(bytes), options);
    let wrong = |e: zune_jpeg::errors::DecodeErrors| damaged("jpeg", format!("{e:?}"));
    decoder.decode_headers().map_err(wrong)?;
    let info = decoder.info().ok_or_else(|| damaged("jpeg", "the size is missing"))?;
    let size = [info.width, info.height].map(u32::from);
    check_size(size[0].into(), size[1].into())?;
    check_plausible("jpeg", size[0] as usize * size[1] as usize, MAX_JPEG_RATIO, bytes)?;
    let kept = if info.sof.is_progressive() { usize::from(info.components) } else { 0 };
    check_memory("jpeg", size, JPEG_BYTES + COEFFICIENT_BYTES * kept)?;
    let pixels = decoder.decode().map_err(wrong)?;
    of_pixels(size, 3, &pixels, averaging)
}

/// Makes a texture of an image that was decoded whole.
fn of_pixels(
    size: [u32; 2],
    channels: usize,
    pixels: &[u8],
    averaging: Averaging,
) -> Result<Texture, PictureError> {
    let mut shrinker = Shrinker::new(size, channels, averaging);
    let row = channels * size[0] as usize;
    pixels.chunks_exact(row).take(size[1] as usize).for_each(|row| shrinker.push(row));
    shrinker.finish()
}

const TOO_LARGE: &str =
    "decoding takes more than 1 GiB; store it as PNG, not interlaced, or smaller";

/// Rejects an image that takes too much memory while it is decoded whole.
fn check_memory(
    kind: &'static str,
    [width, height]: [u32; 2],
    bytes: usize,
) -> Result<(), PictureError> {
    if width as usize * height as usize * bytes <= MAX_MEMORY {
        return Ok(());
    }
    Err(damaged(kind, TOO_LARGE))
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
        assert!(message.contains("1 GiB"), "{message}");
    }

    #[test]
    fn a_progressive_jpeg_may_have_fewer_pixels() {
        let mut bytes = grey_jpeg();
        let frame = bytes.windows(2).position(|mark| mark == [0xff, 0xc0]).unwrap();
        bytes[frame + 5..frame + 9].copy_from_slice(&[0x40, 0, 0x40, 0]);
        // So long that it could hold its pixels.
        bytes.resize(1 << 20, 0);
        assert!(check_memory("jpeg", [1 << 14; 2], JPEG_BYTES).is_ok());
        bytes[frame + 1] = 0xc2;
        let message = Texture::decode(&bytes).unwrap_err().to_string();
        assert!(message.contains("1 GiB"), "{message}");
    }

    /// Grey columns of 0 and 255.
    fn striped_png(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Grayscale);
        let row = [0, 255].repeat(width as usize / 2);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&row.repeat(height as usize)).unwrap();
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn a_large_png_becomes_smaller() {
        let bytes = striped_png(8192, 2050);
        for (averaging, grey) in [(Averaging::Light, 188), (Averaging::Values, 128)] {
            let texture = Texture::decode_averaged(&bytes, averaging).unwrap();
            assert_eq!(texture.image_size(), [8192, 2050]);
            let (width, height, texels) = texture.levels().next().unwrap();
            assert_eq!([width, height], [4096, 1025]);
            assert!(texels.iter().all(|&texel| texel == [grey, grey, grey, 255]));
        }
        for length in [100, bytes.len() / 2, bytes.len() - 13] {
            assert!(Texture::decode(&bytes[..length]).is_err(), "{length} bytes");
        }
    }

    #[test]
    fn an_image_at_the_bound_stays_as_it_is() {
        let texture = Texture::decode(&striped_png(16_384, 1024)).unwrap();
        let (width, height, texels) = texture.levels().next().unwrap();
        assert_eq!([width, height], texture.image_size());
        assert_eq!(texels[..2], [[0, 0, 0, 255], [255; 4]]);
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
