//! Pipelines and buffers of a choice of levels on the GPU.

use meshlod::flock::levels::NEAREST_FACING;
use meshlod::flock::select::ChainLevels;
use wgpu::{BindGroup, BindGroupLayout, Buffer, BufferUsages, ComputePipeline, ShaderStages};

use super::hiz;
use super::instances::Instance;
use super::pipelines::SHARED;
use crate::Gpu;
use crate::gpu::bindings::{STORAGE, UNIFORM, WRITTEN, bind_buffers, layout_for};
use crate::gpu::buffers::blank_buffer;
use crate::gpu::shaders::compute_pipeline;

/// Buffers with room for a number of members.
#[derive(Debug)]
pub(super) struct MemberBuffers {
    pub uploaded: Vec<Instance>,
    pub count: u32,
    pub room: usize,
    pub source: Buffer,
    pub chosen: Buffer,
    pub instances: Buffer,
    pub common: BindGroup,
    pub scatter: BindGroup,
}

/// Pipelines of a choice, and the layouts of their bindings.
#[derive(Debug)]
pub(super) struct ChoicePipelines {
    pub choose: ComputePipeline,
    pub plan: ComputePipeline,
    pub scatter: ComputePipeline,
    pub common_layout: BindGroupLayout,
    pub rule_layout: BindGroupLayout,
    pub plan_layout: BindGroupLayout,
    pub scatter_layout: BindGroupLayout,
}

const SHADER: &str = include_str!("../shaders/flock_choose.wgsl");

impl MemberBuffers {
    pub fn new(
        gpu: &Gpu,
        pipelines: &ChoicePipelines,
        view: &Buffer,
        slots: &Buffer,
        room: usize,
    ) -> Self {
        let made = |label, bytes: usize, usage: BufferUsages| {
            let size = (room.max(1) * bytes) as u64;
            blank_buffer(gpu, label, size, usage | BufferUsages::STORAGE)
        };
        let bytes = size_of::<Instance>();
        let source = made("members", bytes, BufferUsages::COPY_DST);
        let chosen = made("chosen levels", 8, BufferUsages::COPY_SRC);
        let instances = made("sorted members", bytes, BufferUsages::VERTEX);
        let common = [view, &source, &chosen, slots];
        Self {
            uploaded: Vec::with_capacity(room),
            count: 0,
            room,
            common: bind_buffers(gpu, &pipelines.common_layout, &common),
            scatter: bind_buffers(gpu, &pipelines.scatter_layout, &[&instances]),
            source,
            chosen,
            instances,
        }
    }
}

impl ChoicePipelines {
    pub fn new(gpu: &Gpu) -> Self {
        let layout = |bindings: &[_]| layout_for(gpu, ShaderStages::COMPUTE, bindings);
        let common_layout = layout(&[UNIFORM, STORAGE, WRITTEN, WRITTEN]);
        let rule_layout = hiz::choice_layout(gpu);
        let plan_layout = layout(&[STORAGE, WRITTEN]);
        let scatter_layout = layout(&[WRITTEN]);
        let source = [constants().as_str(), SHARED, SHADER].concat();
        let made = |entry, second| {
            compute_pipeline(gpu, "choice of levels", &source, entry, &[&common_layout, second])
        };
        Self {
            choose: made("choose", &rule_layout),
            plan: made("plan", &plan_layout),
            scatter: made("scatter", &scatter_layout),
            common_layout,
            rule_layout,
            plan_layout,
            scatter_layout,
        }
    }
}

/// Returns the constants of [`ChainLevels`] and of facing chains for the shader.
fn constants() -> String {
    format!(
        "const LEAST = {:e}f;\nconst MOST = {:e}f;\nconst DROPPED_BITS = {}u;\n\
         const ENTRIES = {}u;\nconst NEAREST_FACING = {:e}f;\n",
        ChainLevels::LEAST,
        ChainLevels::MOST,
        ChainLevels::DROPPED_BITS,
        ChainLevels::new().entries().len(),
        NEAREST_FACING,
    )
}
