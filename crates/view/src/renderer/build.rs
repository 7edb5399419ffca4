//! Render pipelines: the settings in which they differ, and what they share.

use wgpu::{
    BindGroupLayout, BlendState, ColorTargetState, CompareFunction, Face, IndexFormat,
    PrimitiveState, PrimitiveTopology, RenderPipeline, RenderPipelineDescriptor, ShaderModule,
    VertexBufferLayout,
};

use super::target::TargetFormat;
use crate::Gpu;
use crate::gpu::shaders::pipeline_layout;

/// Settings in which pipelines differ.
#[derive(Clone, Debug)]
pub(crate) struct PipelineBuild<'a> {
    pub label: &'a str,
    pub shader: &'a ShaderModule,
    /// Entry points for vertices and fragments.
    pub entries: [&'a str; 2],
    /// Layouts of the bind groups; empty to derive them from the shader.
    pub layouts: &'a [&'a BindGroupLayout],
    pub buffers: &'a [VertexBufferLayout<'a>],
    pub topology: PrimitiveTopology,
    /// Format of the indices of strips, whose greatest value is a restart.
    pub strip_indices: IndexFormat,
    /// Comparison of depths, and whether they are written.
    pub depth: (CompareFunction, bool),
    pub cull: Option<Face>,
    pub blend: Option<BlendState>,
}

impl<'a> PipelineBuild<'a> {
    /// Returns a pipeline of opaque triangles that are seen from both sides.
    pub(crate) fn new(label: &'a str, shader: &'a ShaderModule) -> Self {
        Self {
            label,
            shader,
            entries: ["fetched", "shaded"],
            layouts: &[],
            buffers: &[],
            topology: PrimitiveTopology::TriangleList,
            strip_indices: IndexFormat::Uint32,
            depth: (CompareFunction::Greater, true),
            cull: None,
            blend: None,
        }
    }

    /// Compiles the pipeline for passes of a format.
    pub(super) fn compile(&self, gpu: &Gpu, format: TargetFormat) -> RenderPipeline {
        let layout =
            (!self.layouts.is_empty()).then(|| pipeline_layout(gpu, self.label, self.layouts));
        let buffers: Vec<_> = self.buffers.iter().cloned().map(Some).collect();
        let (compare, write) = self.depth;
        let is_strip = self.topology == PrimitiveTopology::TriangleStrip;
        gpu.device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some(self.label),
            layout: layout.as_ref(),
            vertex: wgpu::VertexState {
                module: self.shader,
                entry_point: Some(self.entries[0]),
                compilation_options: Default::default(),
                buffers: &buffers,
            },
            primitive: PrimitiveState {
                topology: self.topology,
                strip_index_format: is_strip.then_some(self.strip_indices),
                cull_mode: self.cull,
                ..Default::default()
            },
            depth_stencil: Some(format.depth_state(compare, write)),
            multisample: format.multisample(),
            fragment: Some(wgpu::FragmentState {
                module: self.shader,
                entry_point: Some(self.entries[1]),
                compilation_options: Default::default(),
                targets: &[Some(ColorTargetState {
                    format: format.color,
                    blend: self.blend,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
