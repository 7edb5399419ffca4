//! Triangle strips on the GPU, with restart.

use glam::DVec3;
use meshlod::Mesh;
use meshlod::picture::PictureError;
use meshlod::strip::Strips;
use wgpu::{Buffer, BufferUsages, IndexFormat, RenderPass};

use super::build::{middle, smooth_attributes};
use super::pipelines::{MaterialBinding, MeshPipelines};
use crate::gpu::buffers::buffer_of;
use crate::placement::{CLAY, Placement, linear};
use crate::renderer::Renderer;
use crate::{Gpu, ViewError};

/// Strips of a mesh on the GPU: one index for every entry, and a restart between strips.
///
/// All levels of a skip strip use the vertices of the finest one, so that only indices are sent
/// when the level changes.
#[derive(Debug)]
pub struct GpuStrips {
    gpu: Gpu,
    origin: [f64; 3],
    positions: Buffer,
    attributes: Buffer,
    indices: Buffer,
    entries: u32,
    material: MaterialBinding,
}

impl GpuStrips {
    /// Uploads the vertices of a mesh, with smooth normals, and strips of it or of one of its
    /// levels.
    ///
    /// # Errors
    /// An invalid mesh, or one beyond the limits of the GPU.
    pub fn new(renderer: &Renderer, mesh: &Mesh, strips: &Strips) -> Result<Self, ViewError> {
        mesh.validate().map_err(PictureError::from)?;
        let gpu = renderer.gpu();
        let origin = DVec3::from(middle(mesh));
        let place = |p: &[f64; 3]| -> [f32; 3] { (DVec3::from(*p) - origin).as_vec3().into() };
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(place).collect();
        let attributes = smooth_attributes(mesh);
        gpu.check_buffer("the attributes of strips", 20 * attributes.len() as u64)?;
        let fetched = |label, bytes| buffer_of(gpu, label, bytes, BufferUsages::VERTEX);
        let mut this = Self {
            gpu: gpu.clone(),
            origin: origin.into(),
            positions: fetched("positions", bytemuck::cast_slice(&positions)),
            attributes: fetched("attributes", bytemuck::cast_slice(&attributes)),
            indices: buffer_of(gpu, "strips", &[], BufferUsages::INDEX),
            entries: 0,
            material: MaterialBinding::plain(renderer, linear(CLAY)),
        };
        this.set(strips)?;
        Ok(this)
    }

    /// Replaces the strips by others over the same vertices.
    ///
    /// # Errors
    /// Strips beyond the limits of the GPU.
    ///
    /// # Panics
    /// If the strips have a vertex that the mesh does not.
    pub fn set(&mut self, strips: &Strips) -> Result<(), ViewError> {
        let vertices = (self.positions.size() / 12) as usize;
        assert!(strips.vertices().iter().all(|v| v.index() < vertices), "vertices of the mesh");
        let indices = strips.with_restarts();
        self.gpu.check_buffer("the strips", 4 * indices.len() as u64)?;
        let bytes = bytemuck::cast_slice(&indices);
        self.indices = buffer_of(&self.gpu, "strips", bytes, BufferUsages::INDEX);
        self.entries = indices.len() as u32;
        Ok(())
    }

    /// Returns the point of the world that positions are relative to.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Returns the number of indices that are sent, restarts included.
    pub fn entries(&self) -> usize {
        self.entries as usize
    }

    /// Draws the strips.
    pub fn draw(&self, renderer: &Renderer, pass: &mut RenderPass<'_>, placement: &Placement) {
        pass.set_pipeline(&renderer.pipelines::<MeshPipelines>().strips);
        pass.set_bind_group(0, &placement.bind_group, &[]);
        pass.set_bind_group(1, &self.material.bind_group, &[]);
        pass.set_vertex_buffer(0, self.positions.slice(..));
        pass.set_vertex_buffer(1, self.attributes.slice(..));
        pass.set_index_buffer(self.indices.slice(..), IndexFormat::Uint32);
        pass.draw_indexed(0..self.entries, 0, 0..1);
    }
}
