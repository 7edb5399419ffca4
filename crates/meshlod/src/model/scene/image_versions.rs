//! Smaller versions of an image, for the parts of a file that come early.

use meshlod_picture::{Averaging, Picture, Texture};

/// A version of an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ImageVersion {
    /// Longest side in texels; `u32::MAX` of an image that cannot be decoded.
    pub side: u32,
    pub bytes: Vec<u8>,
    /// True if this is a smaller PNG in place of the image.
    pub is_preview: bool,
}

/// A version takes at most this fraction of the bytes of the next larger one, as its reciprocal. So
/// all previews together take less than a third of the images, but for the smallest.
const STEP: usize = 4;
/// Longest side of the smallest preview, at most. There is one in any case, if it takes fewer bytes.
const LEAST_SIDE: u32 = 16;

/// Returns an image as its only version; none of an image without bytes.
pub(super) fn whole(bytes: &[u8]) -> Vec<ImageVersion> {
    match bytes {
        [] => Vec::new(),
        _ => vec![ImageVersion { side: u32::MAX, bytes: bytes.to_vec(), is_preview: false }],
    }
}

/// Returns the versions of an image, from the smallest to the image itself; none of an image without
/// bytes. Texels are averaged in linear light if the image has colours.
///
/// Cost: decoding the image, and encoding about a third of its texels, of 2^24 at most.
pub(super) fn versions(bytes: &[u8], is_color: bool) -> Vec<ImageVersion> {
    let mut versions = whole(bytes);
    let Some(whole) = versions.first_mut() else { return versions };
    let averaging = if is_color { Averaging::Light } else { Averaging::Values };
    let Ok(texture) = Texture::decode_averaged(bytes, averaging) else { return versions };
    let levels: Vec<_> = texture.levels().collect();
    whole.side = texture.image_size().into_iter().max().unwrap_or(u32::MAX);
    // Of an image that was made smaller to decode it, the first level is a version, too.
    let is_whole = texture.image_size() == [levels[0].0, levels[0].1];
    for &(width, height, texels) in &levels[usize::from(is_whole)..] {
        let (last, side) = (&versions[versions.len() - 1], width.max(height));
        // Such a PNG would hardly be small enough: it takes a fourth of a byte for each texel.
        if last.side <= LEAST_SIDE || width as usize * height as usize > last.bytes.len() {
            continue;
        }
        let rgba = texels.as_flattened().to_vec();
        let Ok(picture) = Picture::new(width, height, rgba) else { continue };
        let bytes = picture.png();
        let step = if side <= LEAST_SIDE { 1 } else { STEP };
        if step * bytes.len() < last.bytes.len() {
            versions.push(ImageVersion { side, bytes, is_preview: true });
        }
    }
    versions.reverse();
    versions
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise, whose PNG is as large as its texels, over a gradient of alpha.
    fn noise(width: u32, height: u32) -> Vec<u8> {
        let mut state = 1u64;
        let texels = (0..width * height).flat_map(|i| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let [r, g, b] = [56, 48, 40].map(|shift| (state >> shift) as u8);
            [r, g, b, (i % width * 255 / width) as u8]
        });
        Picture::new(width, height, texels.collect()).unwrap().png()
    }

    #[test]
    fn each_version_is_a_fraction_of_the_next() {
        let image = noise(300, 200);
        for is_color in [false, true] {
            let versions = versions(&image, is_color);
            assert!(versions.len() >= 3, "{}", versions.len());
            assert!(versions[0].side <= LEAST_SIDE && versions[0].is_preview);
            let last = versions.last().unwrap();
            assert!(last.bytes == image && last.side == 300 && !last.is_preview);
            for pair in versions.windows(2) {
                assert!(pair[0].side < pair[1].side);
                let step = if pair[0].side <= LEAST_SIDE { 1 } else { STEP };
                assert!(step * pair[0].bytes.len() < pair[1].bytes.len());
                let texture = Texture::decode(&pair[0].bytes).unwrap();
                let (width, height, _) = texture.levels().next().unwrap();
                assert_eq!(width.max(height), pair[0].side);
            }
        }
    }

    #[test]
    fn means_are_of_light_for_colours_and_of_values_for_data() {
        // Columns of black and white.
        let texels = (0..64 * 64)
            .flat_map(|i: u32| [[0; 3], [255; 3]][i as usize % 2].into_iter().chain([200]));
        let mut image = Picture::new(64, 64, texels.collect()).unwrap().png();
        // Made large, so that it has previews.
        image.resize(20_000, 0);
        let first = |is_color| {
            let version = versions(&image, is_color)[0].bytes.clone();
            Texture::decode(&version).unwrap().levels().next().unwrap().2[0]
        };
        assert_eq!([first(false), first(true)], [[128, 128, 128, 200], [188, 188, 188, 200]]);
    }

    #[test]
    fn what_is_no_image_has_itself_only() {
        assert_eq!(versions(&[], true), []);
        let one = ImageVersion { side: u32::MAX, bytes: b"KTX".to_vec(), is_preview: false };
        assert_eq!(versions(b"KTX", false), [one]);
    }
}
