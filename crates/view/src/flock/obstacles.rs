//! Obstacles of a flock.

use meshlod::Mesh;
use meshlod::flock::FlockCamera;
use meshlod::flock::draw::STONE;
use meshlod::picture::{Normals, Paint};
use wgpu::RenderPass;

use crate::placement::{Placement, Shade};
use crate::renderer::Renderer;
use crate::{GpuMesh, ViewError};

/// Obstacles that a flock swims round, of stone.
#[derive(Debug)]
pub struct GpuObstacles {
    all: Vec<PlacedObstacle>,
}

#[derive(Debug)]
struct PlacedObstacle {
    mesh: GpuMesh,
    placement: Placement,
    /// Offset from where the mesh is.
    offset: [f64; 3],
}

impl GpuObstacles {
    /// Uploads the meshes of obstacles.
    ///
    /// # Errors
    /// An invalid mesh, and one beyond the limits of the GPU.
    pub fn new(renderer: &Renderer, meshes: &[Mesh]) -> Result<Self, ViewError> {
        let stone = STONE.map(|x| (x * 255.0).round() as u8);
        let placed = |mesh: &Mesh| {
            let mut mesh = mesh.clone();
            (mesh.attributes, mesh.materials) = (None, None);
            let mesh = GpuMesh::new(renderer, &mesh, &Paint::Plain(stone), Normals::Smooth)?;
            Ok(PlacedObstacle { mesh, placement: renderer.placement(), offset: [0.0; 3] })
        };
        Ok(Self { all: meshes.iter().map(placed).collect::<Result<_, ViewError>>()? })
    }

    /// Moves an obstacle, in body lengths; one that does not exist stays away.
    pub fn translate(&mut self, obstacle: usize, by: [f64; 3]) {
        if let Some(PlacedObstacle { offset, .. }) = self.all.get_mut(obstacle) {
            offset.iter_mut().zip(by).for_each(|(offset, by)| *offset += by);
        }
    }

    /// Sets the camera, the size of the picture in pixels, and the look.
    pub fn set(&self, camera: &FlockCamera, size: [u32; 2], shade: &Shade) {
        for PlacedObstacle { mesh, placement, offset } in &self.all {
            let origin = mesh.origin();
            let origin = [0, 1, 2].map(|axis| origin[axis] + offset[axis]);
            placement.set(&camera.for_picture(), size, origin, shade);
        }
    }

    /// Draws all obstacles.
    pub fn draw(&self, renderer: &Renderer, pass: &mut RenderPass<'_>) {
        for PlacedObstacle { mesh, placement, .. } in &self.all {
            mesh.draw(renderer, pass, placement);
        }
    }
}
