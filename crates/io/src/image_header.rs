//! Types and sizes of encoded images, read from their headers.

use crate::Image;

/// Type of an encoded image and its size in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageHeader {
    /// Name of the type, such as `PNG`.
    pub format: &'static str,
    /// Width and height in pixels; `None` if the header is cut off.
    pub pixels: Option<[u32; 2]>,
}

impl Image {
    /// Reads the header of the image and nothing else; `None` for other types than PNG, JPEG, WebP,
    /// KTX2, GIF and BMP.
    pub fn header(&self) -> Option<ImageHeader> {
        let bytes = &self.bytes[..];
        let (format, pixels) = match bytes {
            [0x89, b'P', b'N', b'G', ..] => ("PNG", [be32(bytes, 16), be32(bytes, 20)]),
            [0xff, 0xd8, 0xff, ..] => ("JPEG", jpeg(bytes)),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => {
                ("WebP", webp(bytes))
            }
            [0xab, b'K', b'T', b'X', ..] => ("KTX2", [le(bytes, 20, 4), le(bytes, 24, 4)]),
            [b'G', b'I', b'F', b'8', ..] => ("GIF", [le(bytes, 6, 2), le(bytes, 8, 2)]),
            // A negative height says that rows run from the top.
            [b'B', b'M', ..] => {
                let height = le(bytes, 22, 4).map(|height| (height as i32).unsigned_abs());
                ("BMP", [le(bytes, 18, 4), height])
            }
            _ => return None,
        };
        let pixels = match pixels {
            [Some(width), Some(height)] => Some([width, height]),
            _ => None,
        };
        Some(ImageHeader { format, pixels })
    }
}

/// Finds the frame header of a JPEG, behind segments of any kind.
fn jpeg(bytes: &[u8]) -> [Option<u32>; 2] {
    let mut at = 2;
    while let Some(&[0xff, marker]) = bytes.get(at..at + 2) {
        let is_frame = matches!(marker, 0xc0..=0xcf) && !matches!(marker, 0xc4 | 0xc8 | 0xcc);
        if is_frame {
            return [be16(bytes, at + 7), be16(bytes, at + 5)];
        }
        match (marker, be16(bytes, at + 2)) {
            // Bytes of 0xff may precede any marker.
            (0xff, _) => at += 1,
            (_, Some(length)) if length >= 2 => at += 2 + length as usize,
            _ => break,
        }
    }
    [None; 2]
}

fn webp(bytes: &[u8]) -> [Option<u32>; 2] {
    match bytes.get(12..16) {
        Some(b"VP8 ") => [26, 28].map(|at| le(bytes, at, 2).map(|size| size & 0x3fff)),
        Some(b"VP8L") => {
            let bits = le(bytes, 21, 4);
            [0, 14].map(|shift| bits.map(|bits| (bits >> shift & 0x3fff) + 1))
        }
        Some(b"VP8X") => [24, 27].map(|at| le(bytes, at, 3).map(|size| size + 1)),
        _ => [None; 2],
    }
}

fn be32(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..at + 4)?;
    Some(bytes.iter().fold(0, |number, &byte| number << 8 | u32::from(byte)))
}

fn be16(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..at + 2)?;
    Some(u32::from(bytes[0]) << 8 | u32::from(bytes[1]))
}

/// Reads a little-endian number of up to four bytes.
fn le(bytes: &[u8], at: usize, count: usize) -> Option<u32> {
    let bytes = bytes.get(at..at + count)?;
    Some(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(bytes: &[u8]) -> Option<ImageHeader> {
        Image { name: String::new(), bytes: bytes.to_vec() }.header()
    }

    #[test]
    fn sizes_are_read_from_headers() {
        let png = [b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x02\0\0\0\0\x07", &[8; 9][..]].concat();
        // A comment stands before the frame header.
        let jpeg = b"\xff\xd8\xff\xfe\0\x04ab\xff\xc0\0\x11\x08\0\x03\x01\0\x03";
        let webp = b"RIFF\0\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\xff\x03\0\x01\0\0";
        for (bytes, format, pixels) in [
            (&png[..], "PNG", [512, 7]),
            (jpeg, "JPEG", [256, 3]),
            (webp, "WebP", [1024, 2]),
            (b"GIF89a\x05\0\x06\0", "GIF", [5, 6]),
        ] {
            assert_eq!(header(bytes), Some(ImageHeader { format, pixels: Some(pixels) }));
        }
    }

    #[test]
    fn any_prefix_has_a_type_or_none() {
        let jpeg = b"\xff\xd8\xff\xff\xff\xfe\0\x04ab\xff\xc0\0\x11\x08\0\x03\x01\0\x03";
        for length in 3..jpeg.len() {
            let found = header(&jpeg[..length]).unwrap();
            assert_eq!(found.format, "JPEG");
            assert_eq!(found.pixels.is_some(), length >= 19, "{length}");
        }
        assert_eq!(header(b"\xff\xd8\xff\xe0\0\0\xff\xd8").unwrap().pixels, None);
        assert_eq!(header(b"plain text"), None);
    }
}
