//! Pipelines of flocks.

use wgpu::{
    BindGroupLayout, RenderPipeline, ShaderStages, VertexAttribute, VertexBufferLayout,
    VertexStepMode, vertex_attr_array,
};

use super::instances::Instance;
use crate::gpu::bindings::{IMAGE, SAMPLER, UNIFORM, layout};
use crate::mesh::VERTEX_BUFFERS;
use crate::renderer::{PipelineBuild, Pipelines, Renderer};

/// Pipelines of flocks.
#[derive(Debug)]
pub(super) struct FlockPipelines {
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

impl Pipelines for FlockPipelines {
    fn compile(renderer: &Renderer) -> Self {
        let shader = renderer.shader("flock", &[DRAW, MESH, SHARED, MEMBERS].concat());
        let [positions, attributes] = VERTEX_BUFFERS;
        let members = renderer.pipeline(&PipelineBuild {
            entries: ["member", "swimming"],
            layouts: &[&renderer.draw_layout, &renderer.material_layout],
            buffers: &[positions, attributes, instances(&AFTER_VERTICES)],
            ..PipelineBuild::new("flock", &shader)
        });
        let samples = format!("const SAMPLES = {}u;\n", renderer.format().samples);
        let source = [&samples, DRAW, SHARED, IMPOSTORS].concat();
        let shader = renderer.shader("impostors", &source);
        let (both, fragment) = (ShaderStages::VERTEX_FRAGMENT, ShaderStages::FRAGMENT);
        let atlas = [(both, UNIFORM), (fragment, IMAGE), (fragment, SAMPLER)];
        let atlas_layout = layout(renderer.gpu(), &atlas);
        let impostors = renderer.pipeline(&PipelineBuild {
            entries: ["corner", "card"],
            layouts: &[&renderer.draw_layout, &atlas_layout],
            buffers: &[instances(&ALONE)],
            ..PipelineBuild::new("impostors", &shader)
        });
        Self { members, impostors, atlas_layout }
    }
}

/// Returns the layout of a buffer of instances.
fn instances(attributes: &[VertexAttribute]) -> VertexBufferLayout<'_> {
    let array_stride = size_of::<Instance>() as u64;
    VertexBufferLayout { array_stride, step_mode: VertexStepMode::Instance, attributes }
}
