//! Pipelines for one kind of target.

use std::sync::OnceLock;

use bytemuck::Zeroable;
use meshlod::picture::Background;
use wgpu::util::DeviceExt;
use wgpu::{
    AddressMode, BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout,
    BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, BufferBindingType,
    BufferDescriptor, BufferUsages, ColorTargetState, CompareFunction, Device, FilterMode,
    PipelineLayoutDescriptor, PrimitiveState, PrimitiveTopology, RenderPass, RenderPipeline,
    RenderPipelineDescriptor, Sampler, SamplerBindingType, SamplerDescriptor, ShaderModule,
    ShaderModuleDescriptor, ShaderSource, ShaderStages, TextureSampleType, TextureViewDimension,
    VertexBufferLayout,
};

use crate::cut::CutPipelines;
use crate::flock::FlockPipelines;
use crate::mesh::MeshPipelines;
use crate::placement::{DrawUniforms, Placement};
use crate::quantized::SchemePipelines;
use crate::{Gpu, TargetFormat};

/// Pipelines that draw into render passes of one format.
///
/// They are compiled when they are first needed.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    format: TargetFormat,
    pub(crate) draw_layout: BindGroupLayout,
    pub(crate) material_layout: BindGroupLayout,
    pub(crate) sampler: Sampler,
    pub(crate) meshes: OnceLock<MeshPipelines>,
    pub(crate) schemes: OnceLock<SchemePipelines>,
    pub(crate) cuts: OnceLock<CutPipelines>,
    pub(crate) flocks: OnceLock<FlockPipelines>,
    background: OnceLock<RenderPipeline>,
}

/// Gradient or colour behind everything that a pass draws.
#[derive(Debug)]
pub struct Backdrop {
    bind_group: BindGroup,
}

impl Renderer {
    /// Creates a renderer for passes of a format.
    pub fn new(gpu: &Gpu, format: TargetFormat) -> Self {
        let device = &gpu.device;
        let both = ShaderStages::VERTEX_FRAGMENT;
        let image = BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable: true },
            view_dimension: TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = BindingType::Sampler(SamplerBindingType::Filtering);
        let fragment = ShaderStages::FRAGMENT;
        Self {
            gpu: gpu.clone(),
            format,
            draw_layout: layout(device, &[(both, uniform())]),
            material_layout: layout(
                device,
                &[(fragment, uniform()), (fragment, image), (fragment, sampler)],
            ),
            sampler: device.create_sampler(&SamplerDescriptor {
                address_mode_u: AddressMode::Repeat,
                address_mode_v: AddressMode::Repeat,
                mag_filter: FilterMode::Linear,
                min_filter: FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                anisotropy_clamp: 8,
                ..Default::default()
            }),
            meshes: OnceLock::new(),
            schemes: OnceLock::new(),
            cuts: OnceLock::new(),
            flocks: OnceLock::new(),
            background: OnceLock::new(),
        }
    }

    /// Returns the GPU.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Returns the format of the passes.
    pub fn format(&self) -> TargetFormat {
        self.format
    }

    /// Creates a placement, which must be set before it is used.
    pub fn placement(&self) -> Placement {
        let buffer = self.gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("placement"),
            contents: bytemuck::bytes_of(&DrawUniforms::zeroed()),
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
        });
        let bind_group =
            bind_group(&self.gpu.device, &self.draw_layout, [buffer.as_entire_binding()]);
        Placement { buffer, bind_group, queue: self.gpu.queue.clone() }
    }

    /// Creates a backdrop; `None` for a transparent one.
    pub fn backdrop(&self, background: Background) -> Option<Backdrop> {
        let [top, bottom] = match background {
            Background::Transparent => return None,
            Background::Plain(color) => [color; 2],
            Background::Gradient { top, bottom } => [top, bottom],
        };
        let colors = [top, bottom].map(|[r, g, b]| [r, g, b, 255].map(|x| f32::from(x) / 255.0));
        let buffer = self.gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("backdrop"),
            contents: bytemuck::bytes_of(&colors),
            usage: BufferUsages::UNIFORM,
        });
        let bind_group =
            bind_group(&self.gpu.device, &self.draw_layout, [buffer.as_entire_binding()]);
        Some(Backdrop { bind_group })
    }

    /// Fills everything that nothing else covers.
    pub fn draw_backdrop(&self, pass: &mut RenderPass<'_>, backdrop: &Backdrop) {
        pass.set_pipeline(self.background_pipeline());
        pass.set_bind_group(0, &backdrop.bind_group, &[]);
        pass.draw(0..3, 0..1);
    }

    fn background_pipeline(&self) -> &RenderPipeline {
        self.background.get_or_init(|| {
            let shader = self.shader("background", include_str!("shaders/background.wgsl").into());
            let build = PipelineBuild {
                entries: ["corner", "fill"],
                layouts: &[&self.draw_layout],
                depth: (CompareFunction::GreaterEqual, false),
                ..PipelineBuild::new("background", &shader)
            };
            self.pipeline(&build)
        })
    }

    pub(crate) fn shader(&self, label: &str, source: String) -> ShaderModule {
        self.gpu.device.create_shader_module(ShaderModuleDescriptor {
            label: Some(label),
            source: ShaderSource::Wgsl(source.into()),
        })
    }

    /// Compiles a pipeline that draws into the format.
    pub(crate) fn pipeline(&self, build: &PipelineBuild<'_>) -> RenderPipeline {
        let device = &self.gpu.device;
        let layouts: Vec<_> = build.layouts.iter().map(|&layout| Some(layout)).collect();
        let layout = (!layouts.is_empty()).then(|| {
            device.create_pipeline_layout(&PipelineLayoutDescriptor {
                label: Some(build.label),
                bind_group_layouts: &layouts,
                immediate_size: 0,
            })
        });
        let buffers: Vec<_> = build.buffers.iter().cloned().map(Some).collect();
        let (compare, write) = build.depth;
        device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some(build.label),
            layout: layout.as_ref(),
            vertex: wgpu::VertexState {
                module: build.shader,
                entry_point: Some(build.entries[0]),
                compilation_options: Default::default(),
                buffers: &buffers,
            },
            primitive: PrimitiveState {
                topology: build.topology,
                strip_index_format: (build.topology == PrimitiveTopology::TriangleStrip)
                    .then_some(build.strip_indices),
                cull_mode: build.cull,
                ..Default::default()
            },
            depth_stencil: Some(self.format.depth_state(compare, write)),
            multisample: self.format.multisample(),
            fragment: Some(wgpu::FragmentState {
                module: build.shader,
                entry_point: Some(build.entries[1]),
                compilation_options: Default::default(),
                targets: &[Some(ColorTargetState {
                    format: self.format.color,
                    blend: build.blend,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

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
    pub strip_indices: wgpu::IndexFormat,
    /// Comparison of depths, and whether they are written.
    pub depth: (CompareFunction, bool),
    pub cull: Option<wgpu::Face>,
    pub blend: Option<wgpu::BlendState>,
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
            strip_indices: wgpu::IndexFormat::Uint32,
            depth: (CompareFunction::Greater, true),
            cull: None,
            blend: None,
        }
    }
}

pub(crate) fn uniform() -> BindingType {
    buffer_binding(BufferBindingType::Uniform)
}

pub(crate) fn storage() -> BindingType {
    buffer_binding(BufferBindingType::Storage { read_only: true })
}

pub(crate) fn buffer_binding(ty: BufferBindingType) -> BindingType {
    BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

/// Creates a layout of bindings that are numbered from 0.
pub(crate) fn layout(device: &Device, bindings: &[(ShaderStages, BindingType)]) -> BindGroupLayout {
    let entry = |(binding, &(visibility, ty)): (u32, &(ShaderStages, BindingType))| {
        BindGroupLayoutEntry { binding, visibility, ty, count: None }
    };
    let entries: Vec<_> = (0..).zip(bindings).map(entry).collect();
    device.create_bind_group_layout(&BindGroupLayoutDescriptor { label: None, entries: &entries })
}

/// Creates a bind group of bindings that are numbered from 0.
pub(crate) fn bind_group<'a>(
    device: &Device,
    layout: &BindGroupLayout,
    resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
) -> BindGroup {
    let entry = |(binding, resource)| BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    device.create_bind_group(&BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// Creates a buffer with contents. An empty one gets 16 bytes, since none may be empty.
pub(crate) fn buffer_of(
    gpu: &Gpu,
    label: &str,
    contents: &[u8],
    usage: BufferUsages,
) -> wgpu::Buffer {
    if contents.is_empty() {
        return gpu.device.create_buffer(&BufferDescriptor {
            label: Some(label),
            size: 16,
            usage,
            mapped_at_creation: false,
        });
    }
    let descriptor = wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage };
    gpu.device.create_buffer_init(&descriptor)
}
