//! Pipelines of cuts, whose meshes are seen at one or more places.

use wgpu::RenderPipeline;

use super::gpu_place::PLACES;
use crate::mesh::{MeshPipelines, VERTEX_BUFFERS};
use crate::renderer::{PipelineBuild, Pipelines, Renderer};

/// Pipelines of cuts.
#[derive(Debug)]
pub(super) struct CutPipelines {
    /// Vertices fetched by index.
    pub(super) fetched: RenderPipeline,
    /// Corners pulled from storage, face by face.
    pub(super) pulled: RenderPipeline,
}

impl Pipelines for CutPipelines {
    fn compile(renderer: &Renderer) -> Self {
        let source = concat!(
            include_str!("../shaders/draw.wgsl"),
            include_str!("../shaders/mesh.wgsl"),
            include_str!("../shaders/cut.wgsl")
        );
        let shader = renderer.shader("cut", source);
        let [positions, attributes] = VERTEX_BUFFERS;
        let Renderer { draw_layout, material_layout, .. } = renderer;
        let fetched = PipelineBuild {
            entries: ["fetched_at", "shaded_at"],
            layouts: &[draw_layout, material_layout],
            buffers: &[positions, attributes, PLACES],
            ..PipelineBuild::new("cut", &shader)
        };
        let meshes = renderer.pipelines::<MeshPipelines>();
        let pulled = PipelineBuild {
            label: "faces of a cut",
            entries: ["pulled_at", "shaded_at"],
            layouts: &[draw_layout, material_layout, &meshes.storage_layout],
            buffers: &[PLACES],
            ..fetched.clone()
        };
        let [fetched, pulled] = [&fetched, &pulled].map(|build| renderer.pipeline(build));
        Self { fetched, pulled }
    }
}
