//! Cuts of a multiresolution model on the GPU: the index buffer is patched where the cut changes.

mod dirty;
mod follower;
mod vertices;

use meshlod::multires::Hierarchy;
use wgpu::{BindGroup, Buffer, BufferDescriptor, BufferUsages, IndexFormat, RenderPass};

use self::dirty::DirtyRanges;
pub use self::follower::{CutError, CutFollower, CutQuery, CutStep, CutTolerance};
pub use self::vertices::CutVertices;
use crate::mesh::{MaterialBinding, bind_faces};
use crate::placement::{CLAY, Placement, linear};
use crate::renderer::{Renderer, buffer_of};
use crate::{Gpu, ViewError};

/// Cut on the GPU: vertices of all levels, and the triangles of the current cut by slot.
///
/// A vertex is 12 bytes of position and 20 of attributes, as in a [`GpuMesh`](crate::GpuMesh): models
/// with texture coordinates fill them by wedge, bare ones have a computed normal only.
#[derive(Debug)]
pub struct GpuCut {
    gpu: Gpu,
    origin: [f64; 3],
    positions: Buffer,
    attributes: Buffer,
    indices: Buffer,
    material: MaterialBinding,
    storage: Option<BindGroup>,
    /// Copy of the index buffer; empty slots have no extent.
    slots: Vec<[u32; 3]>,
    /// Slots whose triangles are still dissolving.
    fade: Option<Fade>,
    faces: usize,
    uploaded: u64,
}

/// Triangles that come and go in a dithered transition.
#[derive(Debug)]
struct Fade {
    /// Triangles that go, and those that come.
    buffers: [Buffer; 2],
    counts: [u32; 2],
    /// Changes that the main buffer gets when it is over.
    changes: Vec<(u32, [u32; 3])>,
}

/// Way in which a cut changes on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transition {
    /// At once.
    #[default]
    Immediate,
    /// Old triangles dissolve into new ones, in a pattern of pixels, until [`GpuCut::finish_fade`].
    Dithered,
}

/// Slot without a triangle.
const EMPTY: [u32; 3] = [0; 3];

impl GpuCut {
    /// Uploads the vertices of a model, with room for the triangles of any cut.
    ///
    /// # Errors
    /// A model beyond the limits of the GPU.
    pub fn new(
        renderer: &Renderer,
        model: &Hierarchy,
        vertices: &CutVertices,
    ) -> Result<Self, ViewError> {
        let gpu = renderer.gpu();
        let index_bytes = 12 * model.most_faces() as u64;
        gpu.check_buffer("the vertices of all levels", 20 * vertices.attributes.len() as u64)?;
        gpu.check_buffer("the faces of the finest level", index_bytes)?;
        let usage = BufferUsages::VERTEX | BufferUsages::STORAGE;
        let positions = bytemuck::cast_slice(&vertices.positions);
        let attributes = bytemuck::cast_slice(&vertices.attributes);
        let mut this = Self {
            gpu: gpu.clone(),
            origin: vertices.origin,
            positions: buffer_of(gpu, "positions of all levels", positions, usage),
            attributes: buffer_of(gpu, "attributes of all levels", attributes, usage),
            indices: gpu.device.create_buffer(&BufferDescriptor {
                label: Some("cut"),
                size: index_bytes.max(16),
                usage: BufferUsages::INDEX | BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            material: MaterialBinding::plain(renderer, linear(CLAY)),
            storage: None,
            slots: Vec::new(),
            fade: None,
            faces: 0,
            uploaded: 0,
        };
        let buffers = [&this.positions, &this.attributes, &this.indices];
        this.storage = bind_faces(renderer, buffers, &[u32::MAX]);
        Ok(this)
    }

    /// Returns the point of the world that positions are relative to.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Returns the number of triangles of the cut.
    pub fn faces(&self) -> usize {
        self.faces
    }

    /// Returns the size of the cut in the index buffer, in bytes.
    pub fn index_bytes(&self) -> u64 {
        12 * self.slots.len() as u64
    }

    /// Returns the size of all buffers, in bytes.
    pub fn bytes(&self) -> u64 {
        self.positions.size() + self.attributes.size() + self.indices.size()
    }

    /// Returns the bytes that have been uploaded since this was last asked.
    pub fn take_uploaded(&mut self) -> u64 {
        std::mem::take(&mut self.uploaded)
    }

    /// Takes a step of a [`CutFollower`]: only the slots that changed are uploaded.
    ///
    /// A transition that is still going on ends first.
    pub fn apply(&mut self, step: &CutStep, transition: Transition) {
        self.finish_fade();
        self.faces = step.faces;
        let changes = step.patches.iter().map(|&(slot, nodes)| (slot, nodes.unwrap_or(EMPTY)));
        // The first cut comes from nothing.
        if transition == Transition::Immediate || self.slots.is_empty() {
            self.write(changes);
            return;
        }
        let changes: Vec<_> = changes.collect();
        let old = |&(slot, _): &(u32, _)| self.slots.get(slot as usize).copied().unwrap_or(EMPTY);
        let is_real = |nodes: &[u32; 3]| *nodes != EMPTY;
        let going: Vec<_> = changes.iter().map(old).filter(is_real).collect();
        let coming: Vec<_> = changes.iter().map(|&(_, nodes)| nodes).filter(is_real).collect();
        let buffer = |triangles: &[[u32; 3]]| {
            buffer_of(&self.gpu, "fade", bytemuck::cast_slice(triangles), BufferUsages::INDEX)
        };
        let buffers = [buffer(&going), buffer(&coming)];
        let counts = [&going, &coming].map(|triangles| 3 * triangles.len() as u32);
        self.uploaded += 12 * (going.len() + coming.len()) as u64;
        self.write(changes.iter().map(|&(slot, _)| (slot, EMPTY)));
        self.fade = Some(Fade { buffers, counts, changes });
    }

    /// Returns true while old triangles dissolve into new ones.
    pub fn is_fading(&self) -> bool {
        self.fade.is_some()
    }

    /// Ends a transition.
    pub fn finish_fade(&mut self) {
        if let Some(fade) = self.fade.take() {
            self.write(fade.changes.into_iter());
        }
    }

    /// Draws the cut, without triangles that come or go.
    pub fn draw(&self, renderer: &Renderer, pass: &mut RenderPass<'_>, placement: &Placement) {
        self.bind(renderer, pass, placement);
        pass.set_index_buffer(self.indices.slice(..), IndexFormat::Uint32);
        pass.draw_indexed(0..3 * self.slots.len() as u32, 0, 0..1);
    }

    /// Draws the triangles that go and those that come. The placements differ in
    /// [`Shade::shown`](crate::Shade::shown): t - 1 for those that go, t for those that come, where
    /// t rises from 0 to 1.
    pub fn draw_fade(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        placements: [&Placement; 2],
    ) {
        let Some(fade) = &self.fade else { return };
        for ((buffer, &count), placement) in fade.buffers.iter().zip(&fade.counts).zip(placements) {
            self.bind(renderer, pass, placement);
            pass.set_index_buffer(buffer.slice(..), IndexFormat::Uint32);
            pass.draw_indexed(0..count, 0, 0..1);
        }
    }

    /// Draws the cut face by face, with a wireframe if the placement has one.
    pub fn draw_faces(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        placement: &Placement,
    ) {
        let Some(storage) = &self.storage else { return self.draw(renderer, pass, placement) };
        pass.set_pipeline(&renderer.meshes().pulled);
        pass.set_bind_group(0, &placement.bind_group, &[]);
        pass.set_bind_group(1, &self.material.bind_group, &[]);
        pass.set_bind_group(2, storage, &[]);
        pass.draw(0..3 * self.slots.len() as u32, 0..1);
    }

    fn bind(&self, renderer: &Renderer, pass: &mut RenderPass<'_>, placement: &Placement) {
        pass.set_pipeline(&renderer.meshes().fetched);
        pass.set_bind_group(0, &placement.bind_group, &[]);
        pass.set_bind_group(1, &self.material.bind_group, &[]);
        pass.set_vertex_buffer(0, self.positions.slice(..));
        pass.set_vertex_buffer(1, self.attributes.slice(..));
    }

    /// Writes triangles into slots, and uploads what is around them.
    fn write(&mut self, changes: impl Iterator<Item = (u32, [u32; 3])>) {
        let mut dirty = DirtyRanges::default();
        for (slot, nodes) in changes {
            if slot as usize >= self.slots.len() {
                self.slots.resize(slot as usize + 1, EMPTY);
            }
            self.slots[slot as usize] = nodes;
            dirty.add(slot);
        }
        self.make_room();
        for range in dirty.ranges() {
            let bytes = bytemuck::cast_slice(&self.slots[range.clone()]);
            self.gpu.queue.write_buffer(&self.indices, 12 * range.start as u64, bytes);
            self.uploaded += bytes.len() as u64;
        }
    }

    /// Makes the index buffer larger if a cut has more slots than the finest level has faces.
    fn make_room(&mut self) {
        if self.index_bytes() <= self.indices.size() {
            return;
        }
        let usage = BufferUsages::INDEX | BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let room = self.slots.len() / 4;
        self.slots.resize(self.slots.len() + room, EMPTY);
        self.indices = buffer_of(&self.gpu, "cut", bytemuck::cast_slice(&self.slots), usage);
        self.slots.truncate(self.slots.len() - room);
        self.uploaded += self.indices.size();
        // It was bound to the old buffer; a wireframe is drawn without its lines from here on.
        self.storage = None;
    }
}
