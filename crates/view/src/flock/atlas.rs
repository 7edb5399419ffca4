//! Views of impostors on the GPU.

use bytemuck::{Pod, Zeroable};
use meshlod::flock::levels::Impostor;
use meshlod::picture::Picture;
use wgpu::{AddressMode, BindGroup};

use super::pipelines::FlockPipelines;
use crate::gpu::bindings::bind_image;
use crate::gpu::buffers::uniform_of;
use crate::gpu::texture;
use crate::placement::linear;
use crate::renderer::Renderer;
use crate::{Gpu, ViewError};

/// Atlas of impostors on the GPU.
#[derive(Debug)]
pub(super) struct AtlasBinding {
    pub bind_group: BindGroup,
}

/// `Atlas` of flock_impostors.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct AtlasUniforms {
    half_width: f32,
    views: f32,
    side_px: f32,
    padding: f32,
}

impl AtlasBinding {
    /// Uploads the views of an impostor with mipmaps.
    pub fn new(renderer: &Renderer, impostor: &Impostor) -> Result<Self, ViewError> {
        let gpu: &Gpu = renderer.gpu();
        let atlas = &impostor.atlas;
        let limit = u64::from(gpu.device.limits().max_texture_dimension_2d);
        let needed = u64::from(atlas.width().max(atlas.height()));
        if needed > limit {
            let [needed, limit] = [needed, limit].map(|side| 4 * side * side);
            return Err(ViewError::TooLarge { what: "the impostor's atlas", needed, limit });
        }
        let levels = mipmaps(atlas, impostor.side_px);
        let levels: Vec<_> = levels.iter().map(|(w, h, texels)| (*w, *h, &texels[..])).collect();
        let view = texture::upload_levels(gpu, &levels).create_view(&Default::default());
        let uniforms = AtlasUniforms {
            half_width: impostor.half_width,
            views: (atlas.width() / impostor.side_px) as f32,
            side_px: impostor.side_px as f32,
            padding: 0.0,
        };
        let buffer = uniform_of(gpu, "atlas", &uniforms);
        let sampler = texture::sampler(gpu, AddressMode::ClampToEdge, 1);
        let pipelines = renderer.pipelines::<FlockPipelines>();
        let layout = &pipelines.atlas_layout;
        Ok(Self { bind_group: bind_image(gpu, layout, &buffer, &view, &sampler) })
    }
}

/// Returns the levels of an atlas down to one texel a view: width, height and texels of each.
fn mipmaps(atlas: &Picture, side_px: u32) -> Vec<(u32, u32, Vec<[u8; 4]>)> {
    let texels = atlas.rgba().as_chunks().0.to_vec();
    let mut levels = vec![(atlas.width(), atlas.height(), texels)];
    for _ in 0..side_px.ilog2() {
        let (width, height, finer) = &levels[levels.len() - 1];
        let (across, down) = (width / 2, height / 2);
        let at = |x: u32, y: u32| finer[(y * width + x) as usize];
        let four = |x: u32, y: u32| {
            [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| at(2 * x + i, 2 * y + j))
        };
        let texels =
            (0..down).flat_map(|y| (0..across).map(move |x| [x, y])).map(|[x, y]| mean(four(x, y)));
        let texels = texels.collect();
        levels.push((across, down, texels));
    }
    levels
}

/// Returns the mean of four texels: of their opacity, and of their light as far as they are opaque.
fn mean(texels: [[u8; 4]; 4]) -> [u8; 4] {
    let opacity: u32 = texels.iter().map(|texel| u32::from(texel[3])).sum();
    let weight = |alpha: u8| if opacity > 0 { f32::from(alpha) / opacity as f32 } else { 0.25 };
    let mut light = [0.0f32; 3];
    for [r, g, b, alpha] in texels {
        for (sum, part) in light.iter_mut().zip(linear([r, g, b])) {
            *sum += weight(alpha) * part;
        }
    }
    let encoded = light.map(|x| {
        let x = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        (255.0 * x).round() as u8
    });
    [encoded[0], encoded[1], encoded[2], ((opacity + 2) / 4) as u8]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mipmaps_end_at_a_texel_a_view_and_keep_opacity() {
        let half = [[200, 100, 50, 255], [0, 0, 0, 0]].concat();
        let atlas = Picture::new(8, 8, half.repeat(32)).unwrap();
        let levels = mipmaps(&atlas, 4);
        assert_eq!(levels.iter().map(|level| level.0).collect::<Vec<_>>(), [8, 4, 2]);
        assert!(levels[2].2.iter().all(|texel| *texel == [200, 100, 50, 128]));
    }
}
