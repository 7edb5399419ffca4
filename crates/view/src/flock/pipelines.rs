//! Pipelines of flocks.

use wgpu::{
    BindGroupLayout, BindingType, ComputePipeline, ComputePipelineDescriptor,
    PipelineLayoutDescriptor, RenderPipeline, SamplerBindingType, ShaderModuleDescriptor,
    ShaderSource, ShaderStages, TextureSampleType, TextureViewDimension, VertexAttribute,
    VertexBufferLayout, VertexStepMode, vertex_attr_array,
};

use super::instances::Instance;
use crate::Gpu;
use crate::mesh::VERTEX_BUFFERS;
use crate::renderer::{PipelineBuild, Renderer, layout, uniform};

/// Pipelines of flocks.
#[derive(Debug)]
pub(crate) struct FlockPipelines {
    /// Members with levels: vertices, attributes, then instances.
    pub members: RenderPipeline,
    /// Impostors: instances alone, six vertices each.
    pub impostors: RenderPipeline,
    /// Layout of an atlas: its measures, its image, a sampler.
    pub atlas_layout: BindGroupLayout,
}

/// Functions that all shaders of flocks share.
pub(super) const SHARED: &str = include_str!("../shaders/flock.wgsl");

const DRAW: &str = include_str!("../shaders/draw.wgsl");
const MESH: &str = include_str!("../shaders/mesh.wgsl");
const MEMBERS: &str = include_str!("../shaders/flock_members.wgsl");
const IMPOSTORS: &str = include_str!("../shaders/flock_impostors.wgsl");

/// Position and heading of an instance, after those of vertices, and without any.
const AFTER_VERTICES: [VertexAttribute; 2] = vertex_attr_array![4 => Float32x3, 5 => Float32x3];
const ALONE: [VertexAttribute; 2] = vertex_attr_array![0 => Float32x3, 1 => Float32x3];

impl Renderer {
    /// Returns the pipelines of flocks.
    pub(crate) fn flocks(&self) -> &FlockPipelines {
        self.flocks.get_or_init(|| {
            let layouts = [&self.draw_layout, &self.material_layout];
            let shader = self.shader("flock", [DRAW, MESH, SHARED, MEMBERS].concat());
            let [positions, attributes] = VERTEX_BUFFERS;
            let members = self.pipeline(&PipelineBuild {
                entries: ["member", "swimming"],
                layouts: &layouts,
                buffers: &[positions, attributes, instances(&AFTER_VERTICES)],
                ..PipelineBuild::new("flock", &shader)
            });
            let samples = format!("const SAMPLES = {}u;\n", self.format().samples);
            let source = [&samples, DRAW, SHARED, IMPOSTORS].concat();
            let shader = self.shader("impostors", source);
            let atlas_layout = atlas_layout(&self.gpu().device);
            let layouts = [&self.draw_layout, &atlas_layout];
            let impostors = self.pipeline(&PipelineBuild {
                entries: ["corner", "card"],
                layouts: &layouts,
                buffers: &[instances(&ALONE)],
                ..PipelineBuild::new("impostors", &shader)
            });
            FlockPipelines { members, impostors, atlas_layout }
        })
    }
}

/// Returns the layout of a buffer of instances.
fn instances(attributes: &[VertexAttribute]) -> VertexBufferLayout<'_> {
    let array_stride = size_of::<Instance>() as u64;
    VertexBufferLayout { array_stride, step_mode: VertexStepMode::Instance, attributes }
}

fn atlas_layout(device: &wgpu::Device) -> BindGroupLayout {
    let image = BindingType::Texture {
        sample_type: TextureSampleType::Float { filterable: true },
        view_dimension: TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = BindingType::Sampler(SamplerBindingType::Filtering);
    let (both, fragment) = (ShaderStages::VERTEX_FRAGMENT, ShaderStages::FRAGMENT);
    layout(device, &[(both, uniform()), (fragment, image), (fragment, sampler)])
}

/// Compiles a compute shader.
pub(crate) fn compute_pipeline(
    gpu: &Gpu,
    label: &str,
    source: &str,
    entry: &str,
    layouts: &[&BindGroupLayout],
) -> ComputePipeline {
    let device = &gpu.device;
    let module = device.create_shader_module(ShaderModuleDescriptor {
        label: Some(label),
        source: ShaderSource::Wgsl(source.into()),
    });
    let layouts: Vec<_> = layouts.iter().map(|&layout| Some(layout)).collect();
    let layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &layouts,
        immediate_size: 0,
    });
    device.create_compute_pipeline(&ComputePipelineDescriptor {
        label: Some(label),
        layout: Some(&layout),
        module: &module,
        entry_point: Some(entry),
        compilation_options: Default::default(),
        cache: None,
    })
}
