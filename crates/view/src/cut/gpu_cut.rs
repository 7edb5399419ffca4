//! The buffers of a cut, and how they are changed and drawn.

use wgpu::{BindGroup, Buffer, BufferUsages, IndexFormat, RenderPass};

use super::fade::Fade;
use super::fields::{MovedVertex, VertexFields};
use super::groups::Group;
use super::list::TriangleList;
use super::model::CutModel;
use super::pipelines::CutPipelines;
use super::places::Places;
use super::query::CutStep;
use super::scatter::Scatter;
use super::slots::CutPatch;
use super::staged::Staged;
use crate::gpu::buffers::buffer_of;
use crate::mesh::{MaterialBinding, bind_faces};
use crate::placement::Placement;
use crate::renderer::Renderer;
use crate::{Gpu, ViewError};

/// Cut on the GPU: vertices of all levels, and the triangles of the current cut by mesh, material
/// and slot.
///
/// A vertex is 12 bytes of position and 20 of attributes, as in a [`GpuMesh`](crate::GpuMesh): one
/// for each wedge of the model.
#[derive(Debug)]
pub struct GpuCut {
    gpu: Gpu,
    origin: [f64; 3],
    positions: Buffer,
    attributes: Buffer,
    lists: Vec<TriangleList>,
    materials: Vec<MaterialBinding>,
    places: Places,
    place_buffer: Buffer,
    has_uv: bool,
    /// Pass that moves vertices; `None` if the buffers are too large for it.
    scatter: Option<Scatter>,
    /// Slots whose triangles are still dissolving.
    fade: Option<Fade>,
    faces: usize,
    uploaded: u64,
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

impl GpuCut {
    /// Uploads the vertices and materials of a model, with room for the triangles of any cut if
    /// they are one group.
    ///
    /// # Errors
    /// A model beyond the limits of the GPU, or a paint that does not match it.
    pub fn new(renderer: &Renderer, model: &CutModel) -> Result<Self, ViewError> {
        let gpu = renderer.gpu();
        let fields = VertexFields::new(model);
        let (positions, attributes) = fields.all(model);
        let faces = model.levels().most_faces();
        gpu.check_buffer("the vertices of all levels", 20 * attributes.len() as u64)?;
        gpu.check_buffer("the faces of the finest level", 12 * faces as u64)?;
        let usage = BufferUsages::VERTEX | BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let upload = |label, bytes: &[u8]| buffer_of(gpu, label, bytes, usage);
        let groups = &model.groups.all;
        let room = faces / groups.len();
        let places = model.places.for_gpu(model.origin());
        let place_bytes = bytemuck::cast_slice(&places);
        let positions = upload("positions of all levels", bytemuck::cast_slice(&positions));
        let attributes = upload("attributes of all levels", bytemuck::cast_slice(&attributes));
        Ok(Self {
            gpu: gpu.clone(),
            origin: model.origin().into(),
            scatter: Scatter::new(gpu, [&positions, &attributes]),
            positions,
            attributes,
            lists: groups.iter().map(|&group| TriangleList::new(gpu, group, room)).collect(),
            materials: model.materials(renderer)?,
            places: model.places.clone(),
            place_buffer: buffer_of(gpu, "places", place_bytes, BufferUsages::VERTEX),
            has_uv: fields.has_uv(),
            fade: None,
            faces: 0,
            uploaded: 0,
        })
    }

    /// Returns the point of the world that positions are relative to.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Returns the number of triangles of the cut; those of a mesh at several places count once.
    pub fn faces(&self) -> usize {
        self.faces
    }

    /// Returns true if vertices have texture coordinates.
    pub fn has_uv(&self) -> bool {
        self.has_uv
    }

    /// Returns the size of the cut in the index buffers, in bytes.
    pub fn index_bytes(&self) -> u64 {
        self.lists.iter().map(|list| 12 * list.slots.len() as u64).sum()
    }

    /// Returns the size of all buffers, in bytes.
    pub fn bytes(&self) -> u64 {
        let indices: u64 = self.lists.iter().map(|list| list.buffer.size()).sum();
        self.positions.size() + self.attributes.size() + indices
    }

    /// Returns the bytes uploaded since the last call.
    pub fn take_uploaded(&mut self) -> u64 {
        std::mem::take(&mut self.uploaded)
    }

    /// Forgets the cut, so that the steps of another [`CutFollower`](super::CutFollower) can
    /// follow. The last step must have left no vertex on its way.
    pub fn clear(&mut self) {
        self.fade = None;
        self.faces = 0;
        self.lists.iter_mut().for_each(|list| list.slots.clear());
    }

    /// Takes a step of a [`CutFollower`](super::CutFollower), and uploads only its changes.
    ///
    /// A transition that is still going on ends first.
    pub fn apply(&mut self, step: &CutStep, transition: Transition) {
        self.finish_fade();
        self.faces = step.faces;
        // The first cut comes from nothing.
        let is_first = self.lists.iter().all(|list| list.slots.is_empty());
        if transition == Transition::Immediate || is_first {
            return self.send(&step.patches, &step.moved);
        }
        let fade = Fade::new(&self.gpu, &self.lists, &step.patches);
        let emptied = |&patch: &CutPatch| CutPatch { vertices: None, ..patch };
        let emptied: Vec<_> = step.patches.iter().map(emptied).collect();
        self.uploaded += fade.bytes();
        self.send(&emptied, &step.moved);
        self.fade = (!emptied.is_empty()).then_some(fade);
    }

    /// Returns true while old triangles dissolve into new ones.
    pub fn is_fading(&self) -> bool {
        self.fade.is_some()
    }

    /// Ends a transition.
    pub fn finish_fade(&mut self) {
        if let Some(fade) = self.fade.take() {
            self.send(&fade.changes, &[]);
        }
    }

    /// Draws the cut, without triangles that come or go.
    pub fn draw(&self, renderer: &Renderer, pass: &mut RenderPass<'_>, placement: &Placement) {
        self.bind(renderer, pass, placement);
        for list in self.lists.iter().filter(|list| !list.slots.is_empty()) {
            pass.set_bind_group(1, self.material(&list.group), &[]);
            pass.set_index_buffer(list.buffer.slice(..), IndexFormat::Uint32);
            let places = self.places.of(list.group.mesh);
            pass.draw_indexed(0..3 * list.slots.len() as u32, 0, places);
        }
    }

    /// Draws old triangles, which disappear, and new ones, which appear. The placements differ in
    /// [`Shade::shown`](crate::Shade::shown): t - 1 for old triangles, t for new ones, where t
    /// rises from 0 to 1.
    pub fn draw_fade(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        placements: [&Placement; 2],
    ) {
        let Some(fade) = &self.fade else { return };
        for (side, placement) in fade.sides.iter().zip(placements) {
            self.bind(renderer, pass, placement);
            pass.set_index_buffer(side.buffer.slice(..), IndexFormat::Uint32);
            for (group, range) in &side.ranges {
                let group = &self.lists[*group as usize].group;
                pass.set_bind_group(1, self.material(group), &[]);
                pass.draw_indexed(range.clone(), 0, self.places.of(group.mesh));
            }
        }
    }

    /// Draws the cut face by face, with a wireframe if the placement has one. A cut that is too
    /// large for that is drawn without.
    pub fn draw_faces(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        placement: &Placement,
    ) {
        let storages: Option<Vec<&BindGroup>> =
            self.lists.iter().map(|list| self.storage(renderer, list)).collect();
        let Some(storages) = storages else { return self.draw(renderer, pass, placement) };
        pass.set_pipeline(&renderer.pipelines::<CutPipelines>().pulled);
        pass.set_bind_group(0, &placement.bind_group, &[]);
        pass.set_vertex_buffer(0, self.place_buffer.slice(..));
        let lists = self.lists.iter().zip(storages).filter(|(list, _)| !list.slots.is_empty());
        for (list, storage) in lists {
            pass.set_bind_group(1, self.material(&list.group), &[]);
            pass.set_bind_group(2, storage, &[]);
            pass.draw(0..3 * list.slots.len() as u32, self.places.of(list.group.mesh));
        }
    }

    fn bind(&self, renderer: &Renderer, pass: &mut RenderPass<'_>, placement: &Placement) {
        pass.set_pipeline(&renderer.pipelines::<CutPipelines>().fetched);
        pass.set_bind_group(0, &placement.bind_group, &[]);
        pass.set_vertex_buffer(0, self.positions.slice(..));
        pass.set_vertex_buffer(1, self.attributes.slice(..));
        pass.set_vertex_buffer(2, self.place_buffer.slice(..));
    }

    /// Returns the material of a group; the last one for a label beyond the materials.
    fn material(&self, group: &Group) -> &BindGroup {
        let last = self.materials.len() - 1;
        &self.materials[(group.material as usize).min(last)].bind_group
    }

    fn storage<'s>(&self, renderer: &Renderer, list: &'s TriangleList) -> Option<&'s BindGroup> {
        let buffers = [&self.positions, &self.attributes, &list.buffer];
        list.storage.get_or_init(|| bind_faces(renderer, buffers, &[u32::MAX])).as_ref()
    }

    /// Sends triangles for the slots of their groups, and vertices that have moved.
    fn send(&mut self, patches: &[CutPatch], moved: &[MovedVertex]) {
        if patches.is_empty() && moved.is_empty() {
            return;
        }
        let mut staged = Staged::default();
        for of_group in patches.chunk_by(|a, b| a.group == b.group) {
            let list = &mut self.lists[of_group[0].group as usize];
            self.uploaded += list.write(&self.gpu, of_group, &mut staged);
        }
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        match &self.scatter {
            Some(scatter) => {
                let buffers = [&self.positions, &self.attributes];
                for part in moved.chunks(Scatter::MOST) {
                    self.uploaded += scatter.write(&self.gpu, &mut encoder, part, buffers);
                }
            }
            None => self.stage_moved(moved, &mut staged),
        }
        self.uploaded += staged.record(&self.gpu, &mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
    }

    /// Stages vertices that have moved, those next to each other in one piece.
    fn stage_moved(&self, moved: &[MovedVertex], staged: &mut Staged) {
        for run in moved.chunk_by(|a, b| a.vertex + 1 == b.vertex) {
            let first = u64::from(run[0].vertex);
            let positions: Vec<_> = run.iter().map(|moved| moved.now.position).collect();
            let attributes: Vec<_> = run.iter().map(|moved| moved.now.attributes).collect();
            staged.add(&self.positions, 12 * first, bytemuck::cast_slice(&positions));
            staged.add(&self.attributes, 20 * first, bytemuck::cast_slice(&attributes));
        }
    }
}
