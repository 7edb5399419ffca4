//! Textures on the GPU.

use meshlod::picture::Texture as Image;
use wgpu::{
    AddressMode, Extent3d, FilterMode, MipmapFilterMode, Sampler, SamplerDescriptor, Texture,
    TextureDescriptor, TextureDimension, TextureFormat, TextureUsages,
};

use super::Gpu;

/// Creates a sampler that filters between texels and between levels, with an address mode for both
/// axes and an anisotropy from 1 (off) to 16.
pub(crate) fn sampler(gpu: &Gpu, address: AddressMode, anisotropy: u16) -> Sampler {
    gpu.device.create_sampler(&SamplerDescriptor {
        address_mode_u: address,
        address_mode_v: address,
        mag_filter: FilterMode::Linear,
        min_filter: FilterMode::Linear,
        mipmap_filter: MipmapFilterMode::Linear,
        anisotropy_clamp: anisotropy,
        ..Default::default()
    })
}

/// Creates a texture of one level.
pub(crate) fn texture_2d(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    format: TextureFormat,
    samples: u32,
    usage: TextureUsages,
) -> Texture {
    gpu.device.create_texture(&TextureDescriptor {
        label: None,
        size: Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples,
        dimension: TextureDimension::D2,
        format,
        usage,
        // Panels show targets as they are, without decoding sRGB.
        view_formats: &[format.remove_srgb_suffix()],
    })
}

/// Uploads an image with its mipmaps. Levels beyond the limit of the GPU are left out.
pub(crate) fn upload(gpu: &Gpu, image: &Image) -> Texture {
    let limit = gpu.device.limits().max_texture_dimension_2d;
    let fits = |&(width, height, _): &(u32, u32, &[[u8; 4]])| width.max(height) <= limit;
    let levels: Vec<_> = image.levels().filter(fits).collect();
    upload_levels(gpu, &levels)
}

/// Uploads an image as sRGB: width, height and texels of its levels, at least one, the finest
/// first.
pub(crate) fn upload_levels(gpu: &Gpu, levels: &[(u32, u32, &[[u8; 4]])]) -> Texture {
    let (width, height, _) = levels[0];
    let texture = gpu.device.create_texture(&TextureDescriptor {
        label: Some("image"),
        size: Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format: TextureFormat::Rgba8UnormSrgb,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, &(width, height, texels)) in levels.iter().enumerate() {
        let to = wgpu::TexelCopyTextureInfo { mip_level: level as u32, ..texture.as_image_copy() };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: None,
        };
        let size = Extent3d { width, height, depth_or_array_layers: 1 };
        gpu.queue.write_texture(to, texels.as_flattened(), layout, size);
    }
    texture
}

/// Creates a texture of one white texel.
pub(crate) fn white(gpu: &Gpu) -> Texture {
    let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
    let texture = texture_2d(gpu, [1, 1], TextureFormat::Rgba8UnormSrgb, 1, usage);
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4), rows_per_image: None };
    let size = Extent3d { width: 1, height: 1, depth_or_array_layers: 1 };
    gpu.queue.write_texture(texture.as_image_copy(), &[255; 4], layout, size);
    texture
}
