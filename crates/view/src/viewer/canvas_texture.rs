//! Canvas as a texture that panels show.

use eframe::egui_wgpu::RenderState;
use egui::TextureId;
use meshlod::picture::Picture;

use crate::{Canvas, Renderer, ViewError};

/// Canvas that is made anew when its size or format changes, under one texture of the panels.
#[derive(Debug, Default)]
pub(crate) struct CanvasTexture {
    canvas: Option<Canvas>,
    texture: Option<TextureId>,
}

impl CanvasTexture {
    /// Returns a canvas of a size in pixels for a renderer; no side may be 0.
    pub fn canvas(
        &mut self,
        renderer: &Renderer,
        state: &RenderState,
        size: [u32; 2],
    ) -> Result<&Canvas, ViewError> {
        let format = renderer.format();
        let fits = |canvas: &Canvas| canvas.size() == size && canvas.format() == format;
        let canvas = match self.canvas.take().filter(fits) {
            Some(canvas) => canvas,
            None => {
                let canvas = Canvas::with_format(renderer.gpu(), size, format)?;
                self.register(&canvas, state);
                canvas
            }
        };
        Ok(self.canvas.insert(canvas))
    }

    /// Returns the texture; `None` before the first canvas.
    pub fn texture(&self) -> Option<TextureId> {
        self.texture
    }

    /// Reads the pixels; `None` before the first canvas.
    pub fn read(&self) -> Result<Option<Picture>, ViewError> {
        self.canvas.as_ref().map(Canvas::read).transpose()
    }

    fn register(&mut self, canvas: &Canvas, state: &RenderState) {
        let (view, filter) = (canvas.panel_view(), wgpu::FilterMode::Linear);
        let mut panels = state.renderer.write();
        match self.texture {
            Some(id) => {
                panels.update_egui_texture_from_wgpu_texture(&state.device, &view, filter, id);
            }
            None => {
                let id = panels.register_native_texture(&state.device, &view, filter);
                self.texture = Some(id);
            }
        }
    }
}
