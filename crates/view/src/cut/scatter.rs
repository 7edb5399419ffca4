//! Moved vertices, sent in one piece and scattered by the GPU.

use wgpu::{
    BindGroupLayout, Buffer, BufferUsages, CommandEncoder, ComputePassDescriptor, ComputePipeline,
    ShaderStages,
};

use super::fields::MovedVertex;
use crate::Gpu;
use crate::gpu::bindings::{STORAGE, WRITTEN, bind_buffers, layout_for};
use crate::gpu::buffers::buffer_of;
use crate::gpu::shaders::compute_pipeline;

/// Pass that writes moved vertices into the buffers of all levels.
///
/// A copy for each of them costs the processor a quarter of a microsecond, and they are rarely
/// neighbours.
#[derive(Debug)]
pub(super) struct Scatter {
    layout: BindGroupLayout,
    pipeline: ComputePipeline,
}

/// Most workgroups along one axis.
const MOST_GROUPS: u32 = 65_535;
const GROUP: u32 = 64;

impl Scatter {
    /// Most vertices of one call: they are 36 MiB, which every GPU binds.
    pub(super) const MOST: usize = 1 << 20;

    /// Compiles the pass; `None` if the buffers are beyond what the GPU binds as storage.
    pub(super) fn new(gpu: &Gpu, buffers: [&Buffer; 2]) -> Option<Self> {
        let limit = gpu.device.limits().max_storage_buffer_binding_size;
        if buffers.iter().any(|buffer| buffer.size() > limit) {
            return None;
        }
        let layout = layout_for(gpu, ShaderStages::COMPUTE, &[STORAGE, WRITTEN, WRITTEN]);
        let source = include_str!("../shaders/cut_moved.wgsl");
        let pipeline = compute_pipeline(gpu, "moved vertices", source, "scatter", &[&layout]);
        Some(Self { layout, pipeline })
    }

    /// Records the writing of vertices, each of which may come once. Returns the bytes sent.
    pub(super) fn write(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        moved: &[MovedVertex],
        buffers: [&Buffer; 2],
    ) -> u64 {
        let mut words: Vec<u32> = Vec::with_capacity(9 * moved.len());
        for MovedVertex { vertex, now } in moved {
            words.push(*vertex);
            words.extend(now.position.map(f32::to_bits));
            words.extend_from_slice(bytemuck::cast_slice(&[now.attributes]));
        }
        let sent = buffer_of(gpu, "moved", bytemuck::cast_slice(&words), BufferUsages::STORAGE);
        let [positions, attributes] = buffers;
        let bound = bind_buffers(gpu, &self.layout, &[&sent, positions, attributes]);
        let groups = (moved.len() as u32).div_ceil(GROUP);
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &bound, &[]);
        pass.dispatch_workgroups(groups.min(MOST_GROUPS), groups.div_ceil(MOST_GROUPS), 1);
        drop(pass);
        4 * words.len() as u64
    }
}
