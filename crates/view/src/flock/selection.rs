//! Choice of levels on the GPU.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use meshlod::flock::levels::LevelTable;
use meshlod::flock::select::{Budget, ChainLevels, InstanceLevel};
use meshlod::flock::{Flock, FlockCamera};
use wgpu::{BindGroup, Buffer, BufferUsages, CommandEncoder, Features, RenderPass};

use super::atlas::AtlasBinding;
use super::choice::{ChoicePipelines, MemberBuffers};
use super::drawn::{GpuFlock, bind, bind_impostors};
use super::hiz::{self, HiZ};
use super::instances::Instance;
use super::model::{FlockLevels, LevelDraw};
use crate::gpu::bindings::bind_buffers;
use crate::gpu::buffers::{blank_buffer, buffer_of, uniform_of};
use crate::gpu::read::read_buffer;
use crate::placement::Placement;
use crate::renderer::Renderer;
use crate::{Gpu, ViewError};

/// Flock whose levels are chosen on the GPU, and drawn without a word from the CPU.
///
/// The rule is that of the policy `screen-error`, with the impostors of
/// [`Budget::impostors_below_px`] where the flock has views of one. Members outside the frustum,
/// and those that a [`HiZ`] hides, are not drawn. Counts by level, their sums, and the members in
/// the order of their levels take three dispatches; a material is then one multi-draw.
#[derive(Debug)]
pub struct GpuSelection {
    gpu: Gpu,
    model: Arc<FlockLevels>,
    atlas: Option<Arc<AtlasBinding>>,
    table: Arc<LevelTable>,
    pipelines: ChoicePipelines,
    /// Levels for all distances, as they are uploaded.
    rule: Vec<u32>,
    by_distance: ChainLevels,
    view: Buffer,
    rule_buffer: Buffer,
    slots: Buffer,
    arguments: Buffer,
    plan: BindGroup,
    /// Bindings of the rule without depths.
    open: BindGroup,
    members: MemberBuffers,
    origin: [f64; 3],
    /// Leave out the faces that members turn away, by the facing chains. No picture changes.
    pub facing: bool,
}

/// `View` of flock_choose.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct ViewUniforms {
    eye: [f32; 3],
    members: u32,
    right: [f32; 3],
    radius: f32,
    up: [f32; 3],
    levels: u32,
    forward: [f32; 3],
    flags: u32,
    tangents: [f32; 2],
    margins: [f32; 2],
    impostors: [f32; 2],
    draws: u32,
    pad: u32,
}

/// Members that a workgroup handles.
const GROUP: u32 = 256;

/// Factor by which an impostor must be larger than the limit before it gets a level again, as in
/// [`Budget::impostors_below_px`].
const HYSTERESIS: f32 = 1.1;

/// Bytes of the arguments of an indexed indirect draw.
const ARGUMENTS: u64 = 20;

impl GpuSelection {
    /// Creates the selection pass for a flock built from the same table. There are no members yet.
    ///
    /// # Errors
    /// A GPU without indirect draws that begin at any instance: choose levels by a `Selector`
    /// there.
    pub fn new(
        renderer: &Renderer,
        flock: &GpuFlock,
        table: &Arc<LevelTable>,
    ) -> Result<Self, ViewError> {
        let gpu = renderer.gpu();
        check_features(gpu)?;
        let model = flock.model.clone();
        let pipelines = ChoicePipelines::new(gpu);
        let by_distance = ChainLevels::new();
        let rule = rule(&by_distance, table);
        let (stored, filled) = (BufferUsages::STORAGE, BufferUsages::COPY_DST);
        let rule_buffer = buffer_of(gpu, "rule", bytemuck::cast_slice(&rule), stored | filled);
        let view = uniform_of(gpu, "choice", &ViewUniforms::zeroed());
        let zeros = vec![0u32; 2 * (model.levels + 1)];
        let slots = buffer_of(gpu, "slots", bytemuck::cast_slice(&zeros), stored | filled);
        let (plan, arguments) = plan_of(gpu, &pipelines, &model);
        let (camera, pyramid) = (hiz::no_camera(gpu), buffer_of(gpu, "no depths", &[], stored));
        let open = [&rule_buffer, &camera, &pyramid];
        Ok(Self {
            gpu: gpu.clone(),
            atlas: flock.atlas.clone(),
            table: table.clone(),
            members: MemberBuffers::new(gpu, &pipelines, &view, &slots, 0),
            open: bind_buffers(gpu, &pipelines.rule_layout, &open),
            model,
            pipelines,
            rule,
            by_distance,
            view,
            rule_buffer,
            slots,
            arguments,
            plan,
            origin: [0.0; 3],
            facing: true,
        })
    }

    /// Uploads positions and headings of all members. Allocates only where there are more than
    /// ever.
    ///
    /// # Errors
    /// More members than the GPU can bind as storage; those of before stay.
    pub fn upload(&mut self, flock: &Flock) -> Result<(), ViewError> {
        let members = &flock.members;
        let count = members.len();
        let bytes = (count * size_of::<Instance>()) as u64;
        self.gpu.check_storage("the flock's members", bytes)?;
        let most = u64::from(self.gpu.device.limits().max_compute_workgroups_per_dimension);
        if count as u64 > most * u64::from(GROUP) {
            let limit = most * u64::from(GROUP) * size_of::<Instance>() as u64;
            return Err(ViewError::TooLarge { what: "the flock's members", needed: bytes, limit });
        }
        if count > self.members.room {
            let Self { gpu, pipelines, view, slots, .. } = self;
            self.members = MemberBuffers::new(gpu, pipelines, view, slots, count);
        }
        let uploaded = &mut self.members.uploaded;
        uploaded.clear();
        uploaded.extend((0..count).map(|i| Instance {
            position: members.position(i).to_array(),
            heading: members.heading(i).to_array(),
        }));
        self.members.count = count as u32;
        if count > 0 {
            let bytes = bytemuck::cast_slice(uploaded);
            self.gpu.queue.write_buffer(&self.members.source, 0, bytes);
        }
        Ok(())
    }

    /// Chooses a level for every member, once a frame; `depths` are those of the frame before.
    ///
    /// Of the budget, only its fineness and its limit for impostors count.
    pub fn choose(
        &mut self,
        encoder: &mut CommandEncoder,
        camera: &FlockCamera,
        budget: &Budget,
        depths: Option<&HiZ>,
    ) {
        self.set(camera, budget);
        let Self { pipelines, members, .. } = self;
        let hidden = depths.map(|depths| {
            let all = [&self.rule_buffer, &depths.camera, &depths.pyramid];
            bind_buffers(&self.gpu, &pipelines.rule_layout, &all)
        });
        encoder.clear_buffer(&self.slots, 0, None);
        let groups = members.count.div_ceil(GROUP);
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_bind_group(0, &members.common, &[]);
        let each = [
            (&pipelines.choose, hidden.as_ref().unwrap_or(&self.open), groups),
            (&pipelines.plan, &self.plan, 1),
            (&pipelines.scatter, &members.scatter, groups),
        ];
        for (pipeline, bindings, groups) in each {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, bindings, &[]);
            pass.dispatch_workgroups(groups, 1, 1);
        }
    }

    /// Uploads the camera and the rule of a frame.
    fn set(&mut self, camera: &FlockCamera, budget: &Budget) {
        self.origin = camera.eye().as_dvec3().to_array();
        let detail = if budget.detail > 0.0 { budget.detail } else { f32::MIN_POSITIVE };
        self.by_distance.fill_by_screen_error(&self.table, camera.pixels_at_one(), detail);
        for (to, level) in self.rule.iter_mut().zip(self.by_distance.entries()) {
            *to = u32::from(level.to_bits());
        }
        self.gpu.queue.write_buffer(&self.rule_buffer, 0, bytemuck::cast_slice(&self.rule));
        let below_px = budget.impostors_below_px.filter(|px| *px > 0.0 && self.atlas.is_some());
        let beyond = |px: f32| (camera.pixels_at_one() / px).powi(2);
        let [right, up, forward] = camera.axes().map(|axis| axis.to_array());
        let view = ViewUniforms {
            eye: camera.eye().to_array(),
            members: self.members.count,
            right,
            radius: self.table.radius,
            up,
            levels: self.model.levels as u32,
            forward,
            flags: self.facing.into(),
            tangents: camera.tangents(),
            margins: camera.tangents().map(|t| self.table.radius * (1.0 + t * t).sqrt()),
            impostors: below_px.map_or([f32::MAX; 2], |px| [beyond(px), beyond(px * HYSTERESIS)]),
            draws: self.model.draws.len() as u32,
            pad: 0,
        };
        self.gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
    }

    /// Returns the point that members are relative to, for
    /// [`Placement::set`](crate::Placement::set): the eye of the last choice.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Draws all members that were chosen to be drawn.
    pub fn draw(&self, renderer: &Renderer, pass: &mut RenderPass<'_>, placement: &Placement) {
        if self.members.count == 0 {
            return;
        }
        bind(&self.model, &self.members.instances, renderer, pass, placement);
        let draws = &self.model.draws;
        let mut first = 0;
        for of_material in draws.chunk_by(|a, b| a.material == b.material) {
            let material = &self.model.materials[of_material[0].material];
            pass.set_bind_group(1, &material.bind_group, &[]);
            let count = of_material.len() as u32;
            pass.multi_draw_indexed_indirect(&self.arguments, ARGUMENTS * first, count);
            first += u64::from(count);
        }
        if let Some(atlas) = &self.atlas {
            bind_impostors(atlas, &self.members.instances, renderer, pass);
            pass.draw_indirect(&self.arguments, ARGUMENTS * first);
        }
    }

    /// Reads the levels back, after all work submitted before: for tests and statistics.
    ///
    /// # Errors
    /// The device was lost.
    pub fn levels(&self) -> Result<Vec<InstanceLevel>, ViewError> {
        let bytes = 8 * u64::from(self.members.count);
        let chosen = read_buffer(&self.gpu, &self.members.chosen, bytes)?;
        let impostor = self.model.levels as u32;
        // Slot and rank of each member.
        let level =
            |bytes: &[u8]| match u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) {
                slot if slot == impostor => InstanceLevel::IMPOSTOR,
                slot if slot > impostor => InstanceLevel::HIDDEN,
                slot => InstanceLevel::drawn(slot as usize),
            };
        Ok(chosen.chunks_exact(8).map(level).collect())
    }
}

/// Fails on a GPU without the indirect draws that choosing on the GPU needs.
fn check_features(gpu: &Gpu) -> Result<(), ViewError> {
    if gpu.device.features().contains(Features::INDIRECT_FIRST_INSTANCE) {
        return Ok(());
    }
    let why = "it has no indirect draws that begin at any instance, which choosing levels on the \
               GPU needs; choose them on the CPU";
    Err(ViewError::Failed(why.into()))
}

/// Creates the buffer of the arguments of all draws, and the bindings of the shader that fills it.
fn plan_of(gpu: &Gpu, pipelines: &ChoicePipelines, model: &FlockLevels) -> (BindGroup, Buffer) {
    let of_draw =
        |draw: &LevelDraw| [draw.level as u32, draw.indices.start, draw.indices.len() as u32];
    let draws: Vec<[u32; 3]> = model.draws.iter().map(of_draw).collect();
    let draws = buffer_of(gpu, "draws", bytemuck::cast_slice(&draws), BufferUsages::STORAGE);
    let size = ARGUMENTS * (model.draws.len() as u64 + 1);
    let usage = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
    let arguments = blank_buffer(gpu, "arguments of draws", size, usage);
    (bind_buffers(gpu, &pipelines.plan_layout, &[&draws, &arguments]), arguments)
}

/// Returns the level for each distance, and the facing levels of each depth, as shaders read them.
fn rule(by_distance: &ChainLevels, table: &LevelTable) -> Vec<u32> {
    let levels = by_distance.entries().iter().map(|level| u32::from(level.to_bits()));
    let facing = table.facing.iter().flat_map(|depth| {
        let side = if depth.levels.is_empty() { 0 } else { depth.directions.len().isqrt() };
        [side as u32, depth.levels.start as u32]
    });
    levels.chain(facing).collect()
}
