//! Types of encoded images, told by their first bytes.

/// Beginnings of the image files that materials may name.
const BEGINNINGS: [&[u8]; 18] = [
    b"\x89PNG",
    b"\xff\xd8\xff",
    b"GIF8",
    b"BM",
    b"DDS ",
    b"II*\0",
    b"MM\0*",
    b"8BPS",
    b"\xabKTX",
    b"#?",
    b"v/1\x01",
    b"\x01\xda",
    b"\0\0\x01\0",
    b"P4",
    b"P5",
    b"P6",
    b"PF",
    b"Pf",
];

/// Reports whether bytes are an image of a common type.
///
/// TGA files have no beginning of their own: the name must say so, and the header be possible.
pub(crate) fn is_image(name: &str, bytes: &[u8]) -> bool {
    let in_container = match bytes {
        [b'R', b'I', b'F', b'F', _, _, _, _, rest @ ..] => rest.starts_with(b"WEBP"),
        // AVIF, HEIF and JPEG 2000.
        [_, _, _, _, kind @ ..] => kind.starts_with(b"ftyp") || kind.starts_with(b"jP  "),
        _ => false,
    };
    let is_targa = name.to_ascii_lowercase().ends_with(".tga")
        && matches!(bytes, [_, 0 | 1, 1..=3 | 9..=11, ..])
        && bytes.len() >= 18;
    in_container || is_targa || BEGINNINGS.iter().any(|start| bytes.starts_with(start))
}

/// Reports whether an image is a PNG or JPEG with colours, which a map of heights has not.
pub(crate) fn has_colors(bytes: &[u8]) -> bool {
    match bytes {
        // The colour type is in the header, behind width, height and depth.
        [0x89, b'P', b'N', b'G', ..] => {
            bytes.get(25).is_some_and(|&kind| matches!(kind, 2 | 3 | 6))
        }
        [0xff, 0xd8, 0xff, ..] => jpeg_components(bytes) == Some(3),
        _ => false,
    }
}

/// Returns the number of components in the frame header of a JPEG.
fn jpeg_components(bytes: &[u8]) -> Option<u8> {
    let mut at = 2;
    loop {
        let &[0xff, marker] = bytes.get(at..at + 2)? else { return None };
        let is_frame = (0xc0..=0xcf).contains(&marker) && ![0xc4, 0xc8, 0xcc].contains(&marker);
        if is_frame {
            return bytes.get(at + 9).copied();
        }
        at += match marker {
            // Fill bytes before a marker.
            0xff => 1,
            _ => 2 + usize::from(u16::from_be_bytes(*bytes.get(at + 2..)?.first_chunk()?)).max(2),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_told_from_other_files() {
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
