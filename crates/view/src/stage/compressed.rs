//! Compressed geometry on a stage, drawn from its stored bits.

use meshlod::codec::Compressed;
use meshlod::mesh::Bounds;
use wgpu::RenderPass;

use crate::{GpuCompressed, Placement, Renderer, ViewError};

/// Compressed mesh on the GPU: its positions are never decoded, except by the shader that draws
/// them.
#[derive(Debug)]
pub struct CompressedSubject {
    mesh: GpuCompressed,
    pub(super) bounds: Bounds,
    pub(super) vertices: usize,
}

impl CompressedSubject {
    pub(super) fn new(
        renderer: &Renderer,
        compressed: &Compressed,
        bounds: Bounds,
    ) -> Result<Self, ViewError> {
        let mesh = GpuCompressed::new(renderer, compressed)?;
        Ok(Self { mesh, bounds, vertices: compressed.vertices() })
    }

    /// Returns the mesh on the GPU.
    pub fn mesh(&self) -> &GpuCompressed {
        &self.mesh
    }

    pub(super) fn draw(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        placement: &Placement,
    ) {
        self.mesh.draw(renderer, pass, placement);
    }
}
