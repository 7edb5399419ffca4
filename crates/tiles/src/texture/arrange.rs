//! Choice between an atlas and whole images, and the texels of either.

use meshlod_io::Image;
use meshlod_picture::Texture;

use super::atlas::{Atlas, Sampled};
use super::charts::Chart;
use super::encode::{Texels, encode};
use super::layers::Layer;
use crate::plan::Look;

/// Largest side of a texture of a tile, which every GPU can show.
const MOST_SIDE: u32 = 4096;

/// Least longer side of what an image is halved to: below there is nothing to save.
const LEAST_SIDE: u32 = 64;

/// Most often that the images of a material are taken to be smaller by halves than the largest.
const MOST_SMALLER: u32 = 3;

/// Packs charts of a material for its largest image, halved as often as is asked for, or more often
/// where the atlas would be too large. Returns `None` if the images had better stay whole.
pub(super) fn arrange(charts: &[&Chart], layers: &[Layer], halvings: u32) -> Option<Atlas> {
    let largest = largest(layers)?;
    if charts.iter().any(|chart| chart.repeats()) {
        return None;
    }
    let grain = layers.iter().map(|layer| factor(&layer.texture, largest)).max()?;
    let mut level = level(largest, halvings);
    loop {
        let source = size_at(largest, level);
        let atlas = Atlas::pack(charts, source, grain);
        if area(atlas.size()) >= area(source) {
            return None;
        }
        if atlas.size().iter().all(|&side| side <= MOST_SIDE) {
            return Some(atlas);
        }
        level += 1;
    }
}

/// Cuts the image of a tile out of one of the layers that an atlas was arranged for.
pub(super) fn cut(look: &Look, layer: &Layer, layers: &[Layer], atlas: &Atlas) -> Image {
    let texture = &layer.texture;
    let factor = largest(layers).map_or(1, |largest| factor(texture, largest));
    let needed = atlas.source().map(|side| side / factor);
    let is_enough = |level: &u32| (0..2).all(|axis| size_at(texture, *level)[axis] >= needed[axis]);
    let levels = texture.levels().count() as u32;
    let level = (1..levels).take_while(is_enough).last().unwrap_or(0);
    // The mean of the whole image disturbs the JPEG of its parts least.
    let blank = sampled(texture, levels - 1).texels[0];
    let texels = atlas.cut(&sampled(texture, level), factor, blank);
    encode(&look.images[layer.image].name, layer.role, &texels)
}

/// Returns how often an image is halved that stays whole.
pub(super) fn whole_level(texture: &Texture, halvings: u32) -> u32 {
    let is_large = |level: &u32| size_at(texture, *level).iter().any(|&side| side > MOST_SIDE);
    let least = (0..).take_while(is_large).count() as u32;
    level(texture, halvings).max(least)
}

/// Encodes a whole image at a level; it stays as it is if that takes fewer bytes.
pub(super) fn whole(look: &Look, layer: &Layer, level: u32) -> Image {
    let Sampled { size, texels } = sampled(&layer.texture, level);
    let own = &look.images[layer.image];
    let encoded = encode(&own.name, layer.role, &Texels { size, rgba: texels.to_vec() });
    let is_same = layer.texture.image_size() == size;
    if is_same && own.bytes.len() <= encoded.bytes.len() { own.clone() } else { encoded }
}

/// Returns the image with the most texels, the last one of several.
fn largest(layers: &[Layer]) -> Option<&Texture> {
    let layer = layers.iter().max_by_key(|layer| area(size_at(&layer.texture, 0)))?;
    Some(&layer.texture)
}

/// Returns by which power of two an image is smaller than the largest.
fn factor(texture: &Texture, largest: &Texture) -> u32 {
    let [own, largest] = [texture, largest].map(|texture| size_at(texture, 0));
    let is_smaller = |by: &u32| (0..2).all(|axis| largest[axis] >> by >= own[axis]);
    1 << (1..=MOST_SMALLER).take_while(is_smaller).count()
}

/// Returns the level of a texture for an image halved some times, but not below [`LEAST_SIDE`].
fn level(texture: &Texture, halvings: u32) -> u32 {
    let [image, first] = [texture.image_size(), size_at(texture, 0)].map(|size| size[0]);
    let level = halvings.saturating_sub((image / first).ilog2());
    let is_enough = |level: &u32| size_at(texture, *level).iter().any(|&side| side >= LEAST_SIDE);
    (1..=level).take_while(is_enough).last().unwrap_or(0)
}

/// Returns the width and height of a texture at a level.
fn size_at(texture: &Texture, level: u32) -> [u32; 2] {
    let first = texture.levels().next().map_or([1; 2], |(width, height, _)| [width, height]);
    first.map(|side| side.checked_shr(level).unwrap_or(0).max(1))
}

/// Returns the texels of a texture at a level that it has.
fn sampled(texture: &Texture, level: u32) -> Sampled<'_> {
    let found = texture.levels().nth(level as usize);
    let (width, height, texels) = found.expect("levels go down to one texel");
    Sampled { size: [width, height], texels }
}

fn area(size: [u32; 2]) -> u64 {
    size.into_iter().map(u64::from).product()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::decoded::Role;
    use super::*;

    fn texture(size: [u32; 2]) -> Texture {
        Texture::new(size[0], size[1], &[9, 8, 7, 255].repeat((size[0] * size[1]) as usize))
            .unwrap()
    }

    fn layer(size: [u32; 2]) -> Layer {
        Layer { image: 0, role: Role::Color, texture: Arc::new(texture(size)) }
    }

    fn chart(side: f64) -> Chart {
        Chart { label: 0, bounds: [[0.0; 2], [side; 2]], shift: [0.0; 2] }
    }

    #[test]
    fn images_are_halved_but_not_to_nothing() {
        let texture = texture([512, 100]);
        let levels = [0, 1, 3, 4, 9].map(|halvings| level(&texture, halvings));
        assert_eq!(levels, [0, 1, 3, 3, 3]);
        assert_eq!(size_at(&texture, 3), [64, 12]);
        assert_eq!(level(&Texture::new(1, 1, &[0; 4]).unwrap(), 2), 0);
    }

    #[test]
    fn sides_that_are_too_long_are_halved_in_any_case() {
        assert_eq!(whole_level(&texture([9000, 2]), 0), 2);
        let atlas = arrange(&[&chart(0.9)], &[layer([8192, 64])], 0).unwrap();
        assert!(atlas.size().iter().all(|&side| side <= MOST_SIDE), "{:?}", atlas.size());
    }

    #[test]
    fn whole_images_stay_where_an_atlas_is_no_smaller() {
        let layers = [layer([256, 256])];
        assert_eq!(arrange(&[&chart(0.5)], &layers, 0).unwrap().size(), [132; 2]);
        assert!(arrange(&[&chart(1.0)], &layers, 0).is_none());
        assert!(arrange(&[&chart(1.5)], &layers, 0).is_none(), "it repeats");
        assert!(arrange(&[&chart(0.5)], &[], 0).is_none());
    }

    #[test]
    fn smaller_images_are_cut_smaller() {
        let layers = [layer([256, 256]), layer([64, 100])];
        let largest = largest(&layers).unwrap();
        assert_eq!([0, 1].map(|i| factor(&layers[i].texture, largest)), [1, 2]);
        let atlas = arrange(&[&chart(0.5)], &layers, 0).unwrap();
        let look = Look { images: vec![Image::default()], ..Look::default() };
        let sides = layers.each_ref().map(|layer| {
            let image = cut(&look, layer, &layers, &atlas);
            Texture::decode(&image.bytes).unwrap().image_size()
        });
        assert_eq!(sides, [[136; 2], [68; 2]]);
    }
}
