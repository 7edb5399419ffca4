//! A matrix per part, folded into that of the camera.

use glam::{DMat4, DVec3};
use meshlod::picture::Camera;
use wgpu::{BindGroup, Buffer, BufferUsages, Queue};

use super::data::storage_of;
use super::pipelines::SchemePipelines;
use crate::gpu::bindings::bind_buffers;
use crate::placement::clip_from_world;
use crate::renderer::Renderer;

/// Matrices from the local cells of parts to clip space, for one camera [LCL10].
///
/// They are multiplied in `f64` and rounded to `f32` for each part alone, so a vertex on a border
/// may come out an ulp apart in two parts.
#[derive(Debug)]
pub struct PartMatrices {
    buffer: Buffer,
    bind_group: BindGroup,
    queue: Queue,
    /// Matrices from local cells to the world, relative to the origin.
    local: Vec<DMat4>,
    origin: [f64; 3],
}

impl PartMatrices {
    pub(super) fn new(
        renderer: &Renderer,
        origin: [f64; 3],
        offsets: &[[i32; 4]],
        cell: [f64; 3],
    ) -> Self {
        let cell = DVec3::from(cell);
        let matrix = |&[x, y, z, _]: &[i32; 4]| {
            let offset = DVec3::from([x, y, z].map(f64::from));
            DMat4::from_translation(cell * offset) * DMat4::from_scale(cell)
        };
        let local: Vec<DMat4> = offsets.iter().map(matrix).collect();
        let gpu = renderer.gpu();
        let bytes = vec![0; 64 * local.len()];
        let buffer = storage_of(gpu, &bytes, BufferUsages::COPY_DST);
        let pipelines = renderer.pipelines::<SchemePipelines>();
        let bind_group = bind_buffers(gpu, &pipelines.matrix_layout, &[&buffer]);
        Self { buffer, bind_group, queue: gpu.queue.clone(), local, origin }
    }

    /// Sets the camera and the size of the picture in pixels, and uploads a matrix for each part.
    pub fn set(&self, camera: &Camera, size: [u32; 2]) {
        let clip = clip_from_world(camera, size, self.origin);
        let folded = |local: &DMat4| (clip * *local).as_mat4().to_cols_array();
        let folded: Vec<[f32; 16]> = self.local.iter().map(folded).collect();
        self.queue.write_buffer(&self.buffer, 0, bytemuck::cast_slice(&folded));
    }

    pub(super) fn bind_group(&self) -> &BindGroup {
        &self.bind_group
    }
}
