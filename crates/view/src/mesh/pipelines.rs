//! Pipelines and materials of meshes.

use bytemuck::{Pod, Zeroable};
use wgpu::{
    BindGroup, BindGroupLayout, Buffer, BufferUsages, RenderPipeline, Sampler, ShaderStages,
};

use super::colors::SurfaceMaterial;
use super::vertex::VERTEX_BUFFERS;
use crate::gpu::bindings::{STORAGE, bind_buffers, bind_image, layout_for};
use crate::gpu::buffers::{uniform_of, upload_sliced};
use crate::gpu::texture;
use crate::renderer::{PipelineBuild, Pipelines, Renderer};

/// Pipelines of meshes.
#[derive(Debug)]
pub(crate) struct MeshPipelines {
    /// Vertices fetched by index.
    pub fetched: RenderPipeline,
    /// Strips with restart, their vertices fetched by index.
    pub strips: RenderPipeline,
    /// Corners pulled from storage, face by face.
    pub pulled: RenderPipeline,
    pub storage_layout: BindGroupLayout,
}

/// Material of a mesh, bound to its texture.
#[derive(Clone, Debug)]
pub(crate) struct MaterialBinding {
    pub bind_group: BindGroup,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct MaterialUniforms {
    base_color: [f32; 4],
    has_texture: u32,
    is_single_sided: u32,
    padding: [u32; 2],
}

impl Pipelines for MeshPipelines {
    fn compile(renderer: &Renderer) -> Self {
        let source =
            concat!(include_str!("../shaders/draw.wgsl"), include_str!("../shaders/mesh.wgsl"));
        let shader = renderer.shader("mesh", source);
        let storage_layout = layout_for(renderer.gpu(), ShaderStages::VERTEX, &[STORAGE; 4]);
        let basic = [&renderer.draw_layout, &renderer.material_layout];
        let fetched = PipelineBuild {
            layouts: &basic,
            buffers: &VERTEX_BUFFERS,
            ..PipelineBuild::new("mesh", &shader)
        };
        let topology = wgpu::PrimitiveTopology::TriangleStrip;
        let strips = PipelineBuild { topology, label: "strips", ..fetched.clone() };
        let pulled = PipelineBuild {
            label: "faces",
            entries: ["pulled", "shaded"],
            layouts: &[basic[0], basic[1], &storage_layout],
            buffers: &[],
            ..fetched.clone()
        };
        let [fetched, strips, pulled] =
            [&fetched, &strips, &pulled].map(|build| renderer.pipeline(build));
        Self { fetched, strips, pulled, storage_layout }
    }
}

impl MaterialBinding {
    pub(crate) fn new(renderer: &Renderer, material: &SurfaceMaterial<'_>) -> Self {
        Self::with_sampler(renderer, material, &renderer.sampler)
    }

    /// Binds a material to its own sampler.
    pub(crate) fn with_sampler(
        renderer: &Renderer,
        material: &SurfaceMaterial<'_>,
        sampler: &Sampler,
    ) -> Self {
        let gpu = renderer.gpu();
        let [r, g, b] = material.base_color;
        let uniforms = MaterialUniforms {
            base_color: [r, g, b, 1.0],
            has_texture: material.texture.is_some().into(),
            is_single_sided: material.is_single_sided.into(),
            padding: [0; 2],
        };
        let buffer = uniform_of(gpu, "material", &uniforms);
        let image = match &material.texture {
            Some(image) => texture::upload(gpu, image),
            None => texture::white(gpu),
        };
        let view = image.create_view(&Default::default());
        let bind_group = bind_image(gpu, &renderer.material_layout, &buffer, &view, sampler);
        Self { bind_group }
    }

    /// Creates a material of one linear colour.
    pub(crate) fn plain(renderer: &Renderer, base_color: [f32; 3]) -> Self {
        let material = SurfaceMaterial { base_color, texture: None, is_single_sided: false };
        Self::new(renderer, &material)
    }
}

/// Binds positions, attributes and indices for drawing face by face, with sRGB colours of the
/// faces; `None` if a buffer is beyond what the GPU binds as storage.
pub(crate) fn bind_faces(
    renderer: &Renderer,
    buffers: [&Buffer; 3],
    colors: &[u32],
) -> Option<BindGroup> {
    let gpu = renderer.gpu();
    let limit = gpu.device.limits().max_storage_buffer_binding_size;
    if buffers.iter().any(|buffer| buffer.size() > limit) {
        return None;
    }
    let colors = upload_sliced(gpu, "colours", bytemuck::cast_slice(colors), BufferUsages::STORAGE);
    let pipelines = renderer.pipelines::<MeshPipelines>();
    let [positions, attributes, indices] = buffers;
    let all = [positions, attributes, indices, &colors];
    Some(bind_buffers(gpu, &pipelines.storage_layout, &all))
}
