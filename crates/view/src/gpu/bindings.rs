//! Types of bindings, their layouts, and groups of them.

use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    BindGroupLayoutEntry, BindingResource, BindingType, Buffer, BufferBindingType, Sampler,
    SamplerBindingType, ShaderStages, TextureSampleType, TextureView, TextureViewDimension,
};

use super::Gpu;

/// Uniform buffer.
pub(crate) const UNIFORM: BindingType = buffer(BufferBindingType::Uniform);

/// Storage buffer that shaders only read.
pub(crate) const STORAGE: BindingType = buffer(BufferBindingType::Storage { read_only: true });

/// Storage buffer that shaders write.
pub(crate) const WRITTEN: BindingType = buffer(BufferBindingType::Storage { read_only: false });

/// Colour texture that is sampled with filtering.
pub(crate) const IMAGE: BindingType = texture(TextureSampleType::Float { filterable: true }, false);

/// Sampler with filtering.
pub(crate) const SAMPLER: BindingType = BindingType::Sampler(SamplerBindingType::Filtering);

const fn buffer(ty: BufferBindingType) -> BindingType {
    BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

/// Returns the type of a two-dimensional texture.
pub(crate) const fn texture(sample_type: TextureSampleType, multisampled: bool) -> BindingType {
    BindingType::Texture { sample_type, view_dimension: TextureViewDimension::D2, multisampled }
}

/// Creates a layout of bindings numbered from 0.
pub(crate) fn layout(gpu: &Gpu, bindings: &[(ShaderStages, BindingType)]) -> BindGroupLayout {
    let entry = |(binding, &(visibility, ty)): (u32, &(ShaderStages, BindingType))| {
        BindGroupLayoutEntry { binding, visibility, ty, count: None }
    };
    let entries: Vec<_> = (0..).zip(bindings).map(entry).collect();
    let descriptor = BindGroupLayoutDescriptor { label: None, entries: &entries };
    gpu.device.create_bind_group_layout(&descriptor)
}

/// Creates a layout of bindings numbered from 0, all for the same stages.
pub(crate) fn layout_for(
    gpu: &Gpu,
    stages: ShaderStages,
    types: &[BindingType],
) -> BindGroupLayout {
    layout(gpu, &types.iter().map(|&ty| (stages, ty)).collect::<Vec<_>>())
}

/// Creates a bind group of bindings numbered from 0.
pub(crate) fn bind_group<'a>(
    gpu: &Gpu,
    layout: &BindGroupLayout,
    resources: impl IntoIterator<Item = BindingResource<'a>>,
) -> BindGroup {
    let entry = |(binding, resource)| BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    gpu.device.create_bind_group(&BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// Creates a bind group of whole buffers.
pub(crate) fn bind_buffers(gpu: &Gpu, layout: &BindGroupLayout, buffers: &[&Buffer]) -> BindGroup {
    bind_group(gpu, layout, buffers.iter().map(|buffer| buffer.as_entire_binding()))
}

/// Creates a bind group of a buffer with parameters, an image, and its sampler.
pub(crate) fn bind_image(
    gpu: &Gpu,
    layout: &BindGroupLayout,
    parameters: &Buffer,
    image: &TextureView,
    sampler: &Sampler,
) -> BindGroup {
    let image = BindingResource::TextureView(image);
    let resources = [parameters.as_entire_binding(), image, BindingResource::Sampler(sampler)];
    bind_group(gpu, layout, resources)
}
