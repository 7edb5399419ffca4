//! Pipelines and materials of meshes.

use bytemuck::{Pod, Zeroable};
use wgpu::{
    BindGroup, BindGroupLayout, BindingResource, BufferUsages, RenderPipeline, Sampler,
    ShaderStages, VertexBufferLayout, VertexStepMode, vertex_attr_array,
};

use super::colors::SurfaceMaterial;
use crate::renderer::{PipelineBuild, Renderer, bind_group, buffer_of, layout, storage};
use crate::texture;

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

/// Layout of positions, then of attributes.
pub(crate) const VERTEX_BUFFERS: [VertexBufferLayout<'static>; 2] = [
    VertexBufferLayout {
        array_stride: 12,
        step_mode: VertexStepMode::Vertex,
        attributes: &vertex_attr_array![0 => Float32x3],
    },
    VertexBufferLayout {
        array_stride: 20,
        step_mode: VertexStepMode::Vertex,
        attributes: &vertex_attr_array![1 => Snorm16x4, 2 => Unorm8x4, 3 => Float32x2],
    },
];

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

impl Renderer {
    /// Returns the pipelines of meshes.
    pub(crate) fn meshes(&self) -> &MeshPipelines {
        self.meshes.get_or_init(|| {
            let source =
                concat!(include_str!("../shaders/draw.wgsl"), include_str!("../shaders/mesh.wgsl"));
            let shader = self.shader("mesh", source.into());
            let storages = [(ShaderStages::VERTEX, storage()); 4];
            let storage_layout = layout(&self.gpu().device, &storages);
            let basic = [&self.draw_layout, &self.material_layout];
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
                [&fetched, &strips, &pulled].map(|build| self.pipeline(build));
            MeshPipelines { fetched, strips, pulled, storage_layout }
        })
    }
}

impl MaterialBinding {
    pub(crate) fn new(renderer: &Renderer, material: &SurfaceMaterial<'_>) -> Self {
        Self::with_sampler(renderer, material, &renderer.sampler)
    }

    /// Binds a material to a sampler of its own.
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
        let buffer =
            buffer_of(gpu, "material", bytemuck::bytes_of(&uniforms), BufferUsages::UNIFORM);
        let image = match &material.texture {
            Some(image) => texture::upload(gpu, image),
            None => texture::white(gpu),
        };
        let view = image.create_view(&Default::default());
        let bind_group = bind_group(
            &gpu.device,
            &renderer.material_layout,
            [
                buffer.as_entire_binding(),
                BindingResource::TextureView(&view),
                BindingResource::Sampler(sampler),
            ],
        );
        Self { bind_group }
    }

    /// Creates a material of one linear colour.
    pub(crate) fn plain(renderer: &Renderer, base_color: [f32; 3]) -> Self {
        let material = SurfaceMaterial { base_color, texture: None, is_single_sided: false };
        Self::new(renderer, &material)
    }
}
