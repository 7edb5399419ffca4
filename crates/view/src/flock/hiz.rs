//! Pyramid of depths of a frame, by which the next frame leaves out hidden members.

use bytemuck::{Pod, Zeroable};
use meshlod::flock::FlockCamera;
use wgpu::{
    BindGroup, BindGroupLayout, Buffer, BufferUsages, CommandEncoder, ComputePipeline,
    ShaderStages, TextureSampleType, TextureView,
};

use crate::gpu::bindings::{
    STORAGE, UNIFORM, WRITTEN, bind_buffers, bind_group, layout_for, texture,
};
use crate::gpu::buffers::{blank_buffer, buffer_of, uniform_of};
use crate::gpu::shaders::compute_pipeline;
use crate::{Gpu, ViewError};

/// Pyramid of the farthest depths in blocks of a picture, the finest of two by two pixels.
///
/// It holds the farthest of *all* samples of a block, so a member whose bounding ball is behind it
/// was in no sample of that frame. Members that a frame newly uncovers are drawn in the next one.
#[derive(Debug)]
pub struct HiZ {
    gpu: Gpu,
    size: [u32; 2],
    samples: u32,
    gather: ComputePipeline,
    halve: ComputePipeline,
    depth_layout: BindGroupLayout,
    /// Bindings and number of workgroups for making each level.
    steps: Vec<(BindGroup, [u32; 2])>,
    /// Camera of the depths, and where the next one waits for them.
    pub(super) camera: Buffer,
    next_camera: Buffer,
    pub(super) pyramid: Buffer,
}

/// `Step` of hiz.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct StepUniforms {
    size: [u32; 2],
    from_size: [u32; 2],
    at: u32,
    first: u32,
}

/// `Seen` of flock_choose.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(super) struct SeenUniforms {
    eye: [f32; 3],
    near: f32,
    right: [f32; 3],
    depth: u32,
    up: [f32; 3],
    pad: u32,
    forward: [f32; 3],
    pad2: u32,
    tangents: [f32; 2],
    size: [f32; 2],
}

const SHADER: &str = include_str!("../shaders/hiz.wgsl");

impl HiZ {
    /// Creates a pyramid for depths of a size in pixels, with a number of samples a pixel; it hides
    /// nothing yet.
    ///
    /// # Errors
    /// A size beyond the limits of the GPU.
    pub fn new(gpu: &Gpu, size: [u32; 2], samples: u32) -> Result<Self, ViewError> {
        let size = size.map(|side| side.max(1));
        let steps = steps(size);
        let entries = steps.last().map_or(0, |s| s.at + s.size[0] * s.size[1]);
        gpu.check_storage("the pyramid of depths", 4 * u64::from(entries))?;
        let (bytes, usage) = (4 * u64::from(entries), BufferUsages::STORAGE);
        let pyramid = blank_buffer(gpu, "pyramid of depths", bytes, usage);
        let step_layout = layout_for(gpu, ShaderStages::COMPUTE, &[UNIFORM, WRITTEN]);
        let depths = texture(TextureSampleType::Depth, samples > 1);
        let depth_layout = layout_for(gpu, ShaderStages::COMPUTE, &[depths]);
        let depth = if samples > 1 { "texture_depth_multisampled_2d" } else { "texture_depth_2d" };
        let source = format!("alias Depth = {depth};\nconst SAMPLES = {samples}u;\n{SHADER}");
        let made = |entry: &str, layouts: &[&BindGroupLayout]| {
            compute_pipeline(gpu, "pyramid of depths", &source, entry, layouts)
        };
        let bind = |step: &StepUniforms| {
            let buffer = uniform_of(gpu, "step", step);
            let bindings = bind_buffers(gpu, &step_layout, &[&buffer, &pyramid]);
            (bindings, step.size.map(|side| side.div_ceil(8)))
        };
        Ok(Self {
            gpu: gpu.clone(),
            size,
            samples,
            gather: made("gather", &[&step_layout, &depth_layout]),
            halve: made("halve", &[&step_layout]),
            steps: steps.iter().map(bind).collect(),
            depth_layout,
            camera: no_camera(gpu),
            next_camera: no_camera(gpu),
            pyramid,
        })
    }

    /// Takes the depths of the camera's whole picture, after the commands already in the encoder;
    /// once a frame.
    ///
    /// # Panics
    /// If the depths have another number of samples than the pyramid was made for, or fewer pixels.
    pub fn build(&self, encoder: &mut CommandEncoder, depths: &TextureView, camera: &FlockCamera) {
        let texture = depths.texture();
        assert_eq!(texture.sample_count(), self.samples, "samples a pixel");
        let [width, height] = self.size;
        assert!(texture.width() >= width && texture.height() >= height, "size of the depths");
        let seen = SeenUniforms::new(camera, self.size, self.steps.len() as u32);
        // The encoder may have a choice before this that needs the camera of the frame before.
        self.gpu.queue.write_buffer(&self.next_camera, 0, bytemuck::bytes_of(&seen));
        encoder.copy_buffer_to_buffer(&self.next_camera, 0, &self.camera, 0, self.camera.size());
        let view = wgpu::BindingResource::TextureView(depths);
        let depth = bind_group(&self.gpu, &self.depth_layout, [view]);
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for (level, (step, [columns, rows])) in self.steps.iter().enumerate() {
            pass.set_pipeline(if level == 0 { &self.gather } else { &self.halve });
            pass.set_bind_group(0, step, &[]);
            if level == 0 {
                pass.set_bind_group(1, &depth, &[]);
            }
            pass.dispatch_workgroups(*columns, *rows, 1);
        }
    }

    /// Forgets the depths, as after a cut: the next choice hides nothing.
    pub fn forget(&self, encoder: &mut CommandEncoder) {
        encoder.clear_buffer(&self.camera, 0, None);
    }
}

/// Returns a camera that has seen nothing.
pub(super) fn no_camera(gpu: &Gpu) -> Buffer {
    let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
    buffer_of(gpu, "camera of depths", bytemuck::bytes_of(&SeenUniforms::zeroed()), usage)
}

/// Returns the layout of the rule, the camera and the pyramid of depths for a choice.
pub(super) fn choice_layout(gpu: &Gpu) -> BindGroupLayout {
    layout_for(gpu, ShaderStages::COMPUTE, &[STORAGE, UNIFORM, STORAGE])
}

/// Returns how each level is made: blocks halve, rounded up, down to one.
fn steps(size: [u32; 2]) -> Vec<StepUniforms> {
    let mut steps: Vec<StepUniforms> = Vec::new();
    let (mut from_size, mut at, mut first) = (size, 0, 0);
    loop {
        let size = from_size.map(|side| side.div_ceil(2));
        steps.push(StepUniforms { size, from_size, at, first });
        if size == [1, 1] {
            return steps;
        }
        (from_size, first, at) = (size, at, at + size[0] * size[1]);
    }
}

impl SeenUniforms {
    fn new(camera: &FlockCamera, size: [u32; 2], depth: u32) -> Self {
        let [right, up, forward] = camera.axes().map(|axis| axis.to_array());
        Self {
            eye: camera.eye().to_array(),
            near: camera.for_picture().near() as f32,
            right,
            depth,
            up,
            pad: 0,
            forward,
            pad2: 0,
            tangents: camera.tangents(),
            size: size.map(|side| side as f32),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_follow_each_other_down_to_one_block() {
        let steps = steps([960, 540]);
        assert_eq!((steps[0].size, steps[1].size), ([480, 270], [240, 135]));
        assert_eq!(steps.last().unwrap().size, [1, 1]);
        for pair in steps.windows(2) {
            let [before, after] = [pair[0], pair[1]];
            assert_eq!((after.first, after.from_size), (before.at, before.size));
            assert_eq!(after.at, before.at + before.size[0] * before.size[1]);
        }
    }
}
