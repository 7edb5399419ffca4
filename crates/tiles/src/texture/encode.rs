//! Texels as image files.

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use meshlod_io::Image;
use meshlod_picture::Picture;

use super::decoded::Role;

/// Quality of JPEGs of colours, from 1 to 100.
const COLOR_QUALITY: u8 = 85;

/// Quality of JPEGs of normals and the like, whose errors show as dents.
const VALUE_QUALITY: u8 = 92;

/// Texels in memory, row after row from the top.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Texels {
    pub size: [u32; 2],
    pub rgba: Vec<[u8; 4]>,
}

/// Encodes texels as JPEG, or as PNG if their opacity is used; `name` is that of the image they are
/// from.
pub(super) fn encode(name: &str, role: Role, texels: &Texels) -> Image {
    let is_opaque = || texels.rgba.iter().all(|texel| texel[3] == 255);
    let (suffix, bytes) = match role == Role::ColorAndOpacity && !is_opaque() {
        true => ("png", png(texels)),
        false => ("jpg", jpeg(role, texels)),
    };
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    Image { name: format!("{stem}.{suffix}"), bytes }
}

fn png(texels: &Texels) -> Vec<u8> {
    let [width, height] = texels.size;
    let rgba = texels.rgba.as_flattened().to_vec();
    Picture::new(width, height, rgba).expect("an atlas is not large").png()
}

fn jpeg(role: Role, texels: &Texels) -> Vec<u8> {
    let mut bytes = Vec::new();
    let quality = if role == Role::Values { VALUE_QUALITY } else { COLOR_QUALITY };
    // Optimized tables would take a scan for each channel, which some decoders get wrong where
    // colours are halved (zune-jpeg 0.5.15 does, its issue 419).
    let mut encoder = Encoder::new(&mut bytes, quality);
    // The channels of values have nothing in common that could be halved.
    encoder.set_sampling_factor(match role {
        Role::Values => SamplingFactor::R_4_4_4,
        _ => SamplingFactor::R_4_2_0,
    });
    let rgb: Vec<u8> = texels.rgba.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
    let [width, height] = texels.size.map(|side| side as u16);
    encoder.encode(&rgb, width, height, ColorType::Rgb).expect("an atlas is not large");
    bytes
}

#[cfg(test)]
mod tests {
    use meshlod_picture::Texture;

    use super::*;

    #[test]
    fn a_gradient_comes_back() {
        let texel = |i: u32| [(4 * (i % 50)) as u8, (6 * (i / 50)) as u8, 128, 255];
        let texels = Texels { size: [50, 40], rgba: (0..2000).map(texel).collect() };
        for role in [Role::Color, Role::Values] {
            let image = encode("gradient", role, &texels);
            let texture = Texture::decode(&image.bytes).unwrap();
            let back = texture.levels().next().unwrap().2;
            let pairs = back.as_flattened().iter().zip(texels.rgba.as_flattened());
            let worst = pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            assert!(worst <= 10, "{role:?}: {worst}");
        }
    }

    #[test]
    fn opacity_makes_a_png_only_where_it_is_used() {
        for (role, alpha, name) in [
            (Role::Color, 9, "a.b.jpg"),
            (Role::Values, 9, "a.b.jpg"),
            (Role::ColorAndOpacity, 255, "a.b.jpg"),
            (Role::ColorAndOpacity, 9, "a.b.png"),
        ] {
            let texels = Texels { size: [3, 2], rgba: vec![[200, 100, 50, alpha]; 6] };
            let image = encode("a.b.webp", role, &texels);
            assert_eq!(image.name, name);
            let texture = Texture::decode(&image.bytes).unwrap();
            let (width, height, back) = texture.levels().next().unwrap();
            assert_eq!([width, height], [3, 2]);
            let off = |i: usize| back[0][i].abs_diff(texels.rgba[0][i]);
            assert!((0..3).all(|i| off(i) <= 4), "{:?}", back[0]);
            assert_eq!(back[0][3], if name.ends_with("png") { 9 } else { 255 });
        }
    }
}
