//! Flock whose levels were chosen on the CPU.

use std::sync::Arc;

use glam::Vec3;
use meshlod::flock::levels::{Impostor, LevelTable, Look};
use meshlod::flock::select::InstanceLevel;
use meshlod::flock::{Flock, FlockCamera};
use wgpu::{Buffer, BufferUsages, IndexFormat, RenderPass};

use super::atlas::AtlasBinding;
use super::instances::{Instance, LevelSlots, SortedInstances};
use super::model::FlockLevels;
use super::pipelines::FlockPipelines;
use crate::gpu::buffers::blank_buffer;
use crate::placement::Placement;
use crate::renderer::Renderer;
use crate::{Gpu, ViewError};

/// Flock of one model on the GPU: every member an instance of the level that was chosen for it.
///
/// Each level in use is one instanced draw for each of its materials; impostors are one more.
#[derive(Debug)]
pub struct GpuFlock {
    gpu: Gpu,
    pub(super) model: Arc<FlockLevels>,
    pub(super) atlas: Option<Arc<AtlasBinding>>,
    sorted: SortedInstances,
    instances: Buffer,
    /// Slot of impostors in the frame.
    impostor_slot: usize,
    origin: Vec3,
}

impl GpuFlock {
    /// Uploads the levels of a model, with the colours that
    /// [`FlockPainter`](meshlod::flock::draw::FlockPainter) gives it. There are no members yet.
    ///
    /// # Errors
    /// Materials that do not match the table, and a table beyond the limits of the GPU.
    pub fn new(renderer: &Renderer, table: &LevelTable, look: &Look) -> Result<Self, ViewError> {
        let model = FlockLevels::new(renderer, table, look)?;
        Ok(Self::of(renderer.gpu(), Arc::new(model), None))
    }

    /// Takes the views of an impostor for members that are impostors; without, they are drawn with
    /// the coarsest level of the whole chain.
    ///
    /// # Errors
    /// An atlas beyond the limits of the GPU.
    pub fn with_impostor(self, renderer: &Renderer, views: &Impostor) -> Result<Self, ViewError> {
        let atlas = Some(Arc::new(AtlasBinding::new(renderer, views)?));
        Ok(Self { atlas, ..self })
    }

    /// Returns a second flock of the same model, without members. They share the levels on the GPU.
    pub fn sharing(&self) -> Self {
        Self::of(&self.gpu, self.model.clone(), self.atlas.clone())
    }

    fn of(gpu: &Gpu, model: Arc<FlockLevels>, atlas: Option<Arc<AtlasBinding>>) -> Self {
        Self {
            gpu: gpu.clone(),
            impostor_slot: model.levels,
            model,
            atlas,
            sorted: SortedInstances::default(),
            instances: instance_buffer(gpu, 0),
            origin: Vec3::ZERO,
        }
    }

    /// Sorts the members by level and uploads them; `levels` has an entry for every member.
    ///
    /// Members whose position is not finite are not drawn. Allocates only where there are more
    /// members than ever before. Cost: O(members + levels).
    ///
    /// # Errors
    /// More members than the GPU can hold in one buffer.
    pub fn set(
        &mut self,
        flock: &Flock,
        levels: &[InstanceLevel],
        camera: &FlockCamera,
    ) -> Result<(), ViewError> {
        let model = &*self.model;
        let has_atlas = self.atlas.is_some();
        self.impostor_slot = if has_atlas { model.levels } else { model.coarsest };
        self.origin = camera.eye();
        let slots =
            LevelSlots { levels: model.levels, impostors: self.impostor_slot, origin: self.origin };
        // Before anything changes: what does not fit leaves the last frame as it was.
        let needed = (flock.members.len() * size_of::<Instance>()) as u64;
        self.gpu.check_buffer("the flock's members", needed)?;
        self.sorted.sort(&flock.members, levels, &slots);
        let bytes: &[u8] = bytemuck::cast_slice(&self.sorted.instances);
        if bytes.len() as u64 > self.instances.size() {
            // Room for all, so that members that come into view need no other buffer.
            self.instances = instance_buffer(&self.gpu, flock.members.len());
        }
        if !bytes.is_empty() {
            self.gpu.queue.write_buffer(&self.instances, 0, bytes);
        }
        Ok(())
    }

    /// Returns the point that members are relative to, for
    /// [`Placement::set`](crate::Placement::set): the eye of the camera of [`GpuFlock::set`].
    pub fn origin(&self) -> [f64; 3] {
        self.origin.as_dvec3().to_array()
    }

    /// Returns the number of members that are drawn.
    pub fn members(&self) -> usize {
        self.sorted.instances.len()
    }

    /// Returns the number of triangles that are drawn.
    pub fn triangles(&self) -> u64 {
        let of_draws = self.model.draws.iter().map(|draw| {
            u64::from(draw.indices.len() as u32 / 3) * self.sorted.of(draw.level).len() as u64
        });
        let impostors = match self.atlas {
            Some(_) => self.sorted.of(self.impostor_slot).len() as u64,
            None => 0,
        };
        of_draws.sum::<u64>() + impostors * InstanceLevel::IMPOSTOR_TRIANGLES as u64
    }

    /// Draws all members.
    pub fn draw(&self, renderer: &Renderer, pass: &mut RenderPass<'_>, placement: &Placement) {
        if self.sorted.instances.is_empty() {
            return;
        }
        bind(&self.model, &self.instances, renderer, pass, placement);
        let mut bound = None;
        for draw in &self.model.draws {
            let instances = self.sorted.of(draw.level);
            if instances.is_empty() {
                continue;
            }
            if bound.replace(draw.material) != Some(draw.material) {
                pass.set_bind_group(1, &self.model.materials[draw.material].bind_group, &[]);
            }
            pass.draw_indexed(draw.indices.clone(), 0, instances);
        }
        let impostors = self.sorted.of(self.model.levels);
        if let Some(atlas) = self.atlas.as_ref().filter(|_| !impostors.is_empty()) {
            bind_impostors(atlas, &self.instances, renderer, pass);
            pass.draw(0..6, impostors);
        }
    }
}

/// Creates a buffer with room for a number of instances.
fn instance_buffer(gpu: &Gpu, instances: usize) -> Buffer {
    let size = (instances.max(1) * size_of::<Instance>()) as u64;
    blank_buffer(gpu, "flock members", size, BufferUsages::VERTEX | BufferUsages::COPY_DST)
}

/// Binds the pipeline and the buffers of members with levels; materials are bound by each draw.
pub(super) fn bind(
    model: &FlockLevels,
    instances: &Buffer,
    renderer: &Renderer,
    pass: &mut RenderPass<'_>,
    placement: &Placement,
) {
    pass.set_pipeline(&renderer.pipelines::<FlockPipelines>().members);
    pass.set_bind_group(0, &placement.bind_group, &[]);
    pass.set_vertex_buffer(0, model.positions.slice(..));
    pass.set_vertex_buffer(1, model.attributes.slice(..));
    pass.set_vertex_buffer(2, instances.slice(..));
    pass.set_index_buffer(model.indices.slice(..), IndexFormat::Uint32);
}

/// Binds the pipeline, the atlas and the instances of impostors.
pub(super) fn bind_impostors(
    atlas: &AtlasBinding,
    instances: &Buffer,
    renderer: &Renderer,
    pass: &mut RenderPass<'_>,
) {
    pass.set_pipeline(&renderer.pipelines::<FlockPipelines>().impostors);
    pass.set_bind_group(1, &atlas.bind_group, &[]);
    pass.set_vertex_buffer(0, instances.slice(..));
}
