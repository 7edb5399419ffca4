//! Images of a scene in several sizes, for clients that load what the screen needs.

use std::collections::BTreeSet;

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use meshlod_io::gltf::{ImageSizes, SizedImage};
use meshlod_io::{Image, Scene};
use meshlod_picture::{Averaging, Picture, Texture};
use rayon::prelude::*;

use crate::jobs::{About, Remark, Watch};

/// Longest side of the smallest size, in pixels: some 4 KB as JPEG.
const SMALLEST_SIDE: u32 = 128;

/// Quality of JPEGs of colours and of normals and the like, from 1 to 100: that of tiles.
const COLOR_QUALITY: u8 = 85;
const VALUE_QUALITY: u8 = 92;

/// Halves the images of a scene down to 128 pixels; the largest size is the image itself.
///
/// Smaller sizes are JPEGs, or PNGs where an image is not opaque. Colours are averaged in linear
/// light, everything else by value. Images that are small enough are left out, and so are those that
/// cannot be decoded, such as KTX2, with a remark.
///
/// Cost: decodes every image, on all threads.
pub fn image_sizes(scene: &Scene, watch: &dyn Watch) -> Vec<ImageSizes> {
    watch.stage("halving images");
    let colors = color_images(scene);
    let of_image = |(at, image): (usize, &Image)| {
        let made = sizes(image, colors.contains(&at));
        made.map(|sizes| sizes.map(|sizes| ImageSizes { image: at, sizes }))
    };
    let made: Vec<_> = scene.images.par_iter().enumerate().map(of_image).collect();
    let told = made.into_iter().zip(&scene.images).filter_map(|(made, image)| match made {
        Ok(sizes) => sizes,
        Err(reason) => {
            let text = format_args!("image {:?} stays as it is: {reason}", image.name);
            watch.remark(&Remark::new(About::Input, text));
            None
        }
    });
    told.collect()
}

/// Lists the images that some material shows as colours.
fn color_images(scene: &Scene) -> BTreeSet<usize> {
    let of_material = scene.materials.iter();
    let shown = of_material.flat_map(|own| [own.base_color_image, own.shading.emission_image]);
    shown.flatten().collect()
}

/// Returns the sizes of an image, largest first; `None` if it is small enough or missing.
fn sizes(image: &Image, is_color: bool) -> Result<Option<Vec<SizedImage>>, String> {
    let header = image.header();
    let size = header.and_then(|header| header.pixels);
    if image.bytes.is_empty() || size.is_some_and(is_small) {
        return Ok(None);
    }
    let averaging = if is_color { Averaging::Light } else { Averaging::Values };
    let texture = Texture::decode_averaged(&image.bytes, averaging);
    let texture = texture.map_err(|error| error.to_string())?;
    let own = SizedImage { size: texture.image_size(), bytes: image.bytes.clone() };
    let mut sizes = vec![own];
    for (width, height, texels) in texture.levels() {
        if sizes[sizes.len() - 1].size == [width, height] {
            continue;
        }
        let bytes = encode([width, height], texels, is_color)?;
        sizes.push(SizedImage { size: [width, height], bytes });
        if is_small([width, height]) {
            break;
        }
    }
    Ok((sizes.len() > 1).then_some(sizes))
}

fn is_small(size: [u32; 2]) -> bool {
    size.iter().all(|&side| side <= SMALLEST_SIDE)
}

fn encode(size: [u32; 2], texels: &[[u8; 4]], is_color: bool) -> Result<Vec<u8>, String> {
    let [width, height] = size;
    let sides = size.map(|side| u16::try_from(side).ok());
    match sides {
        [Some(width), Some(height)] if texels.iter().all(|texel| texel[3] == 255) => {
            jpeg([width, height], texels, is_color)
        }
        _ => {
            let picture = Picture::new(width, height, texels.as_flattened().to_vec());
            picture.map(|picture| picture.png()).map_err(|error| error.to_string())
        }
    }
}

fn jpeg(size: [u16; 2], texels: &[[u8; 4]], is_color: bool) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let quality = if is_color { COLOR_QUALITY } else { VALUE_QUALITY };
    let mut encoder = Encoder::new(&mut bytes, quality);
    // The channels of values have nothing in common that could be halved.
    encoder.set_sampling_factor(match is_color {
        true => SamplingFactor::R_4_2_0,
        false => SamplingFactor::R_4_4_4,
    });
    let rgb: Vec<u8> = texels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
    let encoded = encoder.encode(&rgb, size[0], size[1], ColorType::Rgb);
    encoded.map(|()| bytes).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Material;

    fn picture(side: u32, alpha: u8) -> Image {
        let rgba = [200, 100, 50, alpha].repeat((side * side) as usize);
        let bytes = Picture::new(side, side, rgba).unwrap().png();
        Image { name: format!("{side}.png"), bytes }
    }

    #[test]
    fn images_are_halved_to_128_pixels() {
        let images = vec![picture(512, 255), picture(300, 9), picture(128, 255), Image::default()];
        let material = Material { base_color_image: Some(0), ..Material::default() };
        let scene = Scene { images, materials: vec![material], ..Scene::default() };
        let made = image_sizes(&scene, &());
        let sides = |sizes: &ImageSizes| sizes.sizes.iter().map(|s| s.size[0]).collect::<Vec<_>>();
        assert_eq!(made.iter().map(|sizes| sizes.image).collect::<Vec<_>>(), [0, 1]);
        assert_eq!(sides(&made[0]), [512, 256, 128]);
        assert_eq!(sides(&made[1]), [300, 150, 75]);
        assert_eq!(made[0].sizes[0].bytes, scene.images[0].bytes, "the largest is the image");
        for (sizes, alpha) in made.iter().zip([255, 9]) {
            let last = Texture::decode(&sizes.sizes[2].bytes).unwrap();
            let (width, height, texels) = last.levels().next().unwrap();
            assert_eq!([width, height], sizes.sizes[2].size);
            let off = |i: usize| texels[0][i].abs_diff([200, 100, 50, alpha][i]);
            assert!((0..4).all(|i| off(i) <= 4), "{:?}", texels[0]);
        }
    }

    #[test]
    fn what_cannot_be_decoded_is_told_and_left_out() {
        #[derive(Default)]
        struct Heard(std::sync::Mutex<Vec<String>>);
        impl Watch for Heard {
            fn remark(&self, remark: &Remark) {
                self.0.lock().unwrap().push(remark.to_string());
            }
        }
        let broken = Image { name: "a.png".into(), bytes: picture(512, 255).bytes[..90].to_vec() };
        let scene = Scene { images: vec![broken], ..Scene::default() };
        let heard = Heard::default();
        assert!(image_sizes(&scene, &heard).is_empty());
        let told = heard.0.into_inner().unwrap();
        assert!(told.len() == 1 && told[0].contains("\"a.png\" stays as it is"), "{told:?}");
    }
}
