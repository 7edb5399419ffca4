//! Pipelines for one kind of target.
//!
//! Each kind of drawing has its own type of [`Pipelines`]; the renderer compiles each type once and
//! knows none of them.

mod backdrop;
mod build;
mod cache;
mod target;

use std::any::Any;
use std::sync::Arc;

use wgpu::{AddressMode, BindGroupLayout, RenderPipeline, Sampler, ShaderModule, ShaderStages};

pub use self::backdrop::Backdrop;
pub(crate) use self::build::PipelineBuild;
use self::cache::TypedCache;
pub use self::target::TargetFormat;
use crate::Gpu;
use crate::gpu::bindings::{IMAGE, SAMPLER, UNIFORM, layout_for};
use crate::gpu::shaders::shader;
use crate::gpu::texture::sampler;

/// Pipelines that draw into render passes of one format.
///
/// They are compiled on first use.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    format: TargetFormat,
    pub(crate) draw_layout: BindGroupLayout,
    pub(crate) material_layout: BindGroupLayout,
    pub(crate) sampler: Sampler,
    compiled: TypedCache,
}

/// Pipelines of one kind of drawing, with the layouts of their bindings.
pub(crate) trait Pipelines: Any + Send + Sync {
    /// Compiles the pipelines.
    fn compile(renderer: &Renderer) -> Self;
}

impl Renderer {
    /// Creates a renderer for passes of a format.
    pub fn new(gpu: &Gpu, format: TargetFormat) -> Self {
        let material = [UNIFORM, IMAGE, SAMPLER];
        Self {
            gpu: gpu.clone(),
            format,
            draw_layout: layout_for(gpu, ShaderStages::VERTEX_FRAGMENT, &[UNIFORM]),
            material_layout: layout_for(gpu, ShaderStages::FRAGMENT, &material),
            sampler: sampler(gpu, AddressMode::Repeat, 8),
            compiled: TypedCache::default(),
        }
    }

    /// Returns the GPU.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Returns the format of the passes.
    pub fn format(&self) -> TargetFormat {
        self.format
    }

    /// Returns pipelines, after compiling them on the first request.
    pub(crate) fn pipelines<P: Pipelines>(&self) -> Arc<P> {
        self.compiled.get(|| P::compile(self))
    }

    pub(crate) fn shader(&self, label: &str, source: &str) -> ShaderModule {
        shader(&self.gpu, label, source)
    }

    /// Compiles a pipeline that draws into the format.
    pub(crate) fn pipeline(&self, build: &PipelineBuild<'_>) -> RenderPipeline {
        build.compile(&self.gpu, self.format)
    }
}
