//! Gradient or colour behind everything that a pass draws.

use meshlod::picture::Background;
use wgpu::{BindGroup, CompareFunction, RenderPass, RenderPipeline};

use super::{PipelineBuild, Pipelines, Renderer};
use crate::gpu::bindings::bind_buffers;
use crate::gpu::buffers::uniform_of;

/// Gradient or colour behind everything that a pass draws.
#[derive(Debug)]
pub struct Backdrop {
    bind_group: BindGroup,
}

/// Pipeline of backdrops.
struct BackdropPipeline(RenderPipeline);

impl Pipelines for BackdropPipeline {
    fn compile(renderer: &Renderer) -> Self {
        let source = include_str!("../shaders/background.wgsl");
        let shader = renderer.shader("background", source);
        Self(renderer.pipeline(&PipelineBuild {
            entries: ["corner", "fill"],
            layouts: &[&renderer.draw_layout],
            depth: (CompareFunction::GreaterEqual, false),
            ..PipelineBuild::new("background", &shader)
        }))
    }
}

impl Renderer {
    /// Creates a backdrop; `None` for a transparent one.
    pub fn backdrop(&self, background: Background) -> Option<Backdrop> {
        let [top, bottom] = match background {
            Background::Transparent => return None,
            Background::Plain(color) => [color; 2],
            Background::Gradient { top, bottom } => [top, bottom],
        };
        let colors = [top, bottom].map(|[r, g, b]| [r, g, b, 255].map(|x| f32::from(x) / 255.0));
        let buffer = uniform_of(self.gpu(), "backdrop", &colors);
        Some(Backdrop { bind_group: bind_buffers(self.gpu(), &self.draw_layout, &[&buffer]) })
    }

    /// Fills everything that nothing else covers.
    pub fn draw_backdrop(&self, pass: &mut RenderPass<'_>, backdrop: &Backdrop) {
        pass.set_pipeline(&self.pipelines::<BackdropPipeline>().0);
        pass.set_bind_group(0, &backdrop.bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}
