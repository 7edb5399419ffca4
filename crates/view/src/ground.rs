//! Soft shadow on the ground below a thing.
//!
//! The light is the sky: the shadow is a blurred picture from above, so that it stays where it is
//! when the camera moves. It is drawn once for each thing, not for each frame.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use meshlod::mesh::Bounds;
use meshlod::picture::{Camera, Lighting, UpAxis};
use wgpu::{
    AddressMode, BindGroup, BlendState, Buffer, CommandEncoder, CompareFunction, PrimitiveTopology,
    RenderPass, RenderPipeline, TextureFormat, TextureUsages, TextureView,
};

use crate::gpu::bindings::bind_image;
use crate::gpu::buffers::uniform_of;
use crate::gpu::texture::{sampler, texture_2d};
use crate::placement::{Placement, clip_from_local};
use crate::renderer::{PipelineBuild, Pipelines, Renderer};
use crate::{Canvas, Gpu, Shade, TargetFormat, ViewError};

/// Shader of shadows, which also blurs them.
const SHADER: &str = include_str!("shaders/ground.wgsl");

/// Shadow of a thing on the ground.
#[derive(Debug)]
pub struct Ground {
    origin: DVec3,
    middle: DVec3,
    half: f64,
    axes: [Vec3; 2],
    /// Placement of the ground in the picture.
    place: Buffer,
    bind_group: BindGroup,
    pipelines: Arc<GroundPipelines>,
    format: TargetFormat,
}

/// Pipelines of shadows.
#[derive(Debug)]
struct GroundPipelines {
    /// Draws the ground with its shadow.
    shadow: RenderPipeline,
    /// Blurs a map of coverage along one axis.
    blur: RenderPipeline,
}

/// `Place` of ground.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct PlaceUniforms {
    clip_from_local: [[f32; 4]; 4],
    middle: [f32; 3],
    half: f32,
    right: [f32; 3],
    opacity: f32,
    ahead: [f32; 3],
    step: f32,
}

/// Side of the map in pixels: a shadow is blurred anyway.
const SIDE: u32 = 256;

/// Side of the ground, in diagonals of the thing's footprint.
const ROOM: f64 = 1.7;

/// Rounds of blur, with the distance of their taps in pixels.
const BLURS: [f32; 3] = [1.0, 2.0, 3.5];

const BLUR_FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

const OPACITY: f32 = 0.45;

impl Ground {
    /// Draws the shadow of a thing within `bounds` that `draw` draws with a placement; `origin` is
    /// the thing's.
    ///
    /// # Errors
    /// As [`Canvas::new`].
    pub fn new(
        renderer: &Renderer,
        bounds: &Bounds,
        up: UpAxis,
        origin: [f64; 3],
        draw: impl FnOnce(&mut RenderPass<'_>, &Placement),
    ) -> Result<Self, ViewError> {
        let (axis, [right, ahead]) = match up {
            UpAxis::Y => (1, [Vec3::X, Vec3::NEG_Z]),
            UpAxis::Z => (2, [Vec3::X, Vec3::Y]),
        };
        let mut middle = DVec3::from(bounds.center());
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3].map(|k| bounds.max[k] - bounds.min[k]);
        let half =
            (0.5 * ROOM * a.hypot(b)).max(bounds.diagonal() * 1e-3).max(f64::MIN_POSITIVE.sqrt());
        middle[axis] = bounds.min[axis];

        let canvas = Canvas::with_format(renderer.gpu(), [SIDE; 2], renderer.format())?;
        let placement = renderer.placement();
        let above = camera_above(bounds, middle, half, axis, ahead);
        let shade = Shade { lighting: Lighting::Unlit, ..Shade::default() };
        placement.set(&above, [SIDE; 2], origin, &shade);
        canvas.draw(|pass| draw(pass, &placement));
        let pipelines = renderer.pipelines::<GroundPipelines>();
        let map = blurred(renderer.gpu(), &pipelines.blur, canvas.resolved());

        let place = uniform_of(renderer.gpu(), "ground", &PlaceUniforms::zeroed());
        let bind_group = bind_map(renderer.gpu(), &pipelines.shadow, &place, &map);
        Ok(Self {
            origin: DVec3::from(origin),
            middle,
            half,
            axes: [right, ahead],
            place,
            bind_group,
            pipelines,
            format: renderer.format(),
        })
    }

    /// Returns the format of the passes that the shadow can be drawn into.
    pub fn format(&self) -> TargetFormat {
        self.format
    }

    /// Draws the shadow into a picture of a camera, after the backdrop.
    ///
    /// One ground is drawn once in a frame.
    pub fn draw(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        camera: &Camera,
        size: [u32; 2],
    ) {
        let [right, ahead] = self.axes;
        let uniforms = PlaceUniforms {
            clip_from_local: clip_from_local(camera, size, self.origin.into()).to_cols_array_2d(),
            middle: (self.middle - self.origin).as_vec3().into(),
            half: self.half as f32,
            right: right.into(),
            opacity: OPACITY,
            ahead: ahead.into(),
            step: 0.0,
        };
        renderer.gpu().queue.write_buffer(&self.place, 0, bytemuck::bytes_of(&uniforms));
        pass.set_pipeline(&self.pipelines.shadow);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.draw(0..4, 0..1);
    }
}

/// Returns a camera so far above the ground that its rays are nearly parallel.
fn camera_above(bounds: &Bounds, middle: DVec3, half: f64, axis: usize, ahead: Vec3) -> Camera {
    const AWAY: f64 = 50.0;
    let mut eye = middle;
    let height = (bounds.max[axis] - bounds.min[axis]) + AWAY * half;
    eye[axis] += height;
    let fov_rad = 2.0 * (half / height).atan();
    Camera::look_at(eye.into(), middle.into(), ahead.as_dvec3().into(), fov_rad)
}

impl Pipelines for GroundPipelines {
    fn compile(renderer: &Renderer) -> Self {
        Self { shadow: shadow_pipeline(renderer), blur: blur_pipeline(renderer) }
    }
}

fn shadow_pipeline(renderer: &Renderer) -> RenderPipeline {
    let shader = renderer.shader("ground", SHADER);
    renderer.pipeline(&PipelineBuild {
        entries: ["square", "shadow"],
        topology: PrimitiveTopology::TriangleStrip,
        depth: (CompareFunction::Greater, false),
        // Seen from below, the ground hides nothing.
        cull: Some(wgpu::Face::Front),
        blend: Some(BlendState::ALPHA_BLENDING),
        ..PipelineBuild::new("ground", &shader)
    })
}

/// Blurs a map of coverage.
fn blurred(gpu: &Gpu, pipeline: &RenderPipeline, map: &wgpu::Texture) -> TextureView {
    let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
    let mut from = map.create_view(&Default::default());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for step in BLURS {
        for along in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
            let uniforms = PlaceUniforms { ahead: along, step, ..PlaceUniforms::zeroed() };
            let place = uniform_of(gpu, "blur", &uniforms);
            let to = texture_2d(gpu, [SIDE; 2], BLUR_FORMAT, 1, usage);
            let to = to.create_view(&Default::default());
            let group = bind_map(gpu, pipeline, &place, &from);
            draw_blur(&mut encoder, pipeline, &group, &to);
            from = to;
        }
    }
    gpu.queue.submit([encoder.finish()]);
    from
}

fn blur_pipeline(renderer: &Renderer) -> RenderPipeline {
    let shader = renderer.shader("blur", SHADER);
    renderer.gpu().device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("blur"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("screen"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some("blur"),
            compilation_options: Default::default(),
            targets: &[Some(BLUR_FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Records one blur of a map into `to`.
fn draw_blur(
    encoder: &mut CommandEncoder,
    pipeline: &RenderPipeline,
    group: &BindGroup,
    to: &TextureView,
) {
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: to,
            depth_slice: None,
            resolve_target: None,
            ops: Default::default(),
        })],
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, group, &[]);
    pass.draw(0..3, 0..1);
}

/// Binds the place of the ground and a map of its shadow.
fn bind_map(gpu: &Gpu, pipeline: &RenderPipeline, place: &Buffer, map: &TextureView) -> BindGroup {
    let sampler = sampler(gpu, AddressMode::ClampToEdge, 1);
    bind_image(gpu, &pipeline.get_bind_group_layout(0), place, map, &sampler)
}
