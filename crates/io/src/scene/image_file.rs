//! Encoded images: their types, sizes and colours, read from the first bytes alone.

use super::Image;

/// Type of an encoded image and its size in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageHeader {
    /// Name of the type, such as `PNG`.
    pub format: &'static str,
    /// Width and height in pixels; `None` if the header is cut off or of another type than PNG,
    /// JPEG, WebP, KTX2, GIF and BMP.
    pub pixels: Option<[u32; 2]>,
}

impl Image {
    /// Reads only the header of the image; `None` if its type is unknown.
    pub fn header(&self) -> Option<ImageHeader> {
        let bytes = &self.bytes[..];
        let format = image_type(&self.name, bytes)?;
        let pixels = match format {
            "PNG" => [be32(bytes, 16), be32(bytes, 20)],
            "JPEG" => [7, 5].map(|at| be16(jpeg_frame(bytes)?, at)),
            "WebP" => webp(bytes),
            "KTX2" => [le(bytes, 20, 4), le(bytes, 24, 4)],
            "GIF" => [le(bytes, 6, 2), le(bytes, 8, 2)],
            // A negative height says that rows run from the top.
            "BMP" => [le(bytes, 18, 4), le(bytes, 22, 4).map(|h| (h as i32).unsigned_abs())],
            _ => [None; 2],
        };
        let [width, height] = pixels;
        Some(ImageHeader { format, pixels: width.zip(height).map(|(w, h)| [w, h]) })
    }
}

/// Magic bytes of image types.
const BEGINNINGS: [(&[u8], &str); 18] = [
    (b"\x89PNG", "PNG"),
    (b"\xff\xd8\xff", "JPEG"),
    (b"GIF8", "GIF"),
    (b"BM", "BMP"),
    (b"DDS ", "DDS"),
    (b"II*\0", "TIFF"),
    (b"MM\0*", "TIFF"),
    (b"8BPS", "PSD"),
    (b"\xabKTX", "KTX2"),
    (b"#?", "HDR"),
    (b"v/1\x01", "OpenEXR"),
    (b"\x01\xda", "SGI"),
    (b"\0\0\x01\0", "ICO"),
    (b"P4", "PNM"),
    (b"P5", "PNM"),
    (b"P6", "PNM"),
    (b"PF", "PFM"),
    (b"Pf", "PFM"),
];

/// Returns the name of the type of an image; `None` if it is unknown.
///
/// TGA files have no magic bytes: they need the suffix and a plausible header.
fn image_type(name: &str, bytes: &[u8]) -> Option<&'static str> {
    if let Some((_, kind)) = BEGINNINGS.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Some(kind);
    }
    match bytes {
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => return Some("WebP"),
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => return Some("HEIF"),
        [_, _, _, _, b'j', b'P', b' ', b' ', ..] => return Some("JPEG 2000"),
        _ => {}
    }
    let is_targa = name.to_ascii_lowercase().ends_with(".tga")
        && matches!(bytes, [_, 0 | 1, 1..=3 | 9..=11, ..])
        && bytes.len() >= 18;
    is_targa.then_some("TGA")
}

/// Reports whether bytes are an image of a common type.
pub(crate) fn is_image(name: &str, bytes: &[u8]) -> bool {
    image_type(name, bytes).is_some()
}

/// Returns the MIME type of an image, if glTF or one of its extensions supports it.
pub(crate) fn mime_type(bytes: &[u8]) -> Option<&'static str> {
    match image_type("", bytes)? {
        "PNG" => Some("image/png"),
        "JPEG" => Some("image/jpeg"),
        "WebP" => Some("image/webp"),
        "KTX2" => Some("image/ktx2"),
        _ => None,
    }
}

/// Reports whether a new glTF document can hold an encoded image: a PNG, a JPEG or, by an
/// extension, a WebP.
pub(crate) fn holds_image(bytes: &[u8]) -> bool {
    matches!(mime_type(bytes), Some("image/png" | "image/jpeg" | "image/webp"))
}

/// Reports whether an image is a PNG or JPEG with colours, unlike a height map.
pub(crate) fn has_colors(bytes: &[u8]) -> bool {
    match image_type("", bytes) {
        // The colour type is in the header, behind width, height and depth.
        Some("PNG") => bytes.get(25).is_some_and(|&kind| matches!(kind, 2 | 3 | 6)),
        Some("JPEG") => jpeg_frame(bytes).and_then(|frame| frame.get(9)) == Some(&3),
        _ => false,
    }
}

/// Finds the frame header of a JPEG after any other segments.
fn jpeg_frame(bytes: &[u8]) -> Option<&[u8]> {
    let mut at = 2;
    while let Some(&[0xff, marker]) = bytes.get(at..at + 2) {
        if matches!(marker, 0xc0..=0xcf) && !matches!(marker, 0xc4 | 0xc8 | 0xcc) {
            return Some(&bytes[at..]);
        }
        match (marker, be16(bytes, at + 2)) {
            // Bytes of 0xff may precede any marker.
            (0xff, _) => at += 1,
            (_, Some(length)) if length >= 2 => at += 2 + length as usize,
            _ => break,
        }
    }
    None
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
            (&png[..], "PNG", Some([512, 7])),
            (jpeg, "JPEG", Some([256, 3])),
            (webp, "WebP", Some([1024, 2])),
            (b"GIF89a\x05\0\x06\0", "GIF", Some([5, 6])),
            (b"DDS 1234567890", "DDS", None),
        ] {
            assert_eq!(header(bytes), Some(ImageHeader { format, pixels }));
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

    #[test]
    fn images_are_distinguished_from_other_files() {
        for bytes in [&b"\x89PNG\r\n"[..], b"RIFF1234WEBPVP8 ", b"\0\0\0\x18ftypavif", b"BM12"] {
            assert!(is_image("a", bytes), "{bytes:?}");
        }
        let mut targa = [0; 18];
        targa[2] = 2;
        assert!(is_image("A.TGA", &targa) && !is_image("a.dat", &targa));
        for bytes in [&b""[..], b"root:x:0:0", b"-----BEGIN", b"RIFF1234WAVE", b"\0\0\0"] {
            assert!(!is_image("a.tga", bytes), "{bytes:?}");
        }
    }

    #[test]
    fn colours_are_in_the_header() {
        let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x01\0\0\0\x01\x08".to_vec();
        png.push(0);
        assert!(!has_colors(&png));
        png[25] = 2;
        assert!(has_colors(&png) && !has_colors(&png[..25]));
        let jpeg = |components| {
            let frame = [0xff, 0xc0, 0, 11, 8, 0, 1, 0, 1, components];
            [&[0xff, 0xd8, 0xff, 0xe0, 0, 4, 1, 2, 0xff][..], &frame].concat()
        };
        assert!(has_colors(&jpeg(3)) && !has_colors(&jpeg(1)));
        for end in 0..jpeg(3).len() {
            assert!(!has_colors(&jpeg(3)[..end]));
        }
    }
}
