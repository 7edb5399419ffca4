//! Shaders, the layouts of pipelines, and compute pipelines.

use wgpu::{
    BindGroupLayout, ComputePipeline, ComputePipelineDescriptor, PipelineLayout,
    PipelineLayoutDescriptor, ShaderModule, ShaderModuleDescriptor, ShaderSource,
};

use super::Gpu;

/// Compiles a shader in WGSL.
pub(crate) fn shader(gpu: &Gpu, label: &str, source: &str) -> ShaderModule {
    gpu.device.create_shader_module(ShaderModuleDescriptor {
        label: Some(label),
        source: ShaderSource::Wgsl(source.into()),
    })
}

/// Creates the layout of a pipeline from those of its bind groups.
pub(crate) fn pipeline_layout(
    gpu: &Gpu,
    label: &str,
    layouts: &[&BindGroupLayout],
) -> PipelineLayout {
    let layouts: Vec<_> = layouts.iter().map(|&layout| Some(layout)).collect();
    gpu.device.create_pipeline_layout(&PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &layouts,
        immediate_size: 0,
    })
}

/// Compiles one entry point of a compute shader.
pub(crate) fn compute_pipeline(
    gpu: &Gpu,
    label: &str,
    source: &str,
    entry: &str,
    layouts: &[&BindGroupLayout],
) -> ComputePipeline {
    gpu.device.create_compute_pipeline(&ComputePipelineDescriptor {
        label: Some(label),
        layout: Some(&pipeline_layout(gpu, label, layouts)),
        module: &shader(gpu, label, source),
        entry_point: Some(entry),
        compilation_options: Default::default(),
        cache: None,
    })
}
