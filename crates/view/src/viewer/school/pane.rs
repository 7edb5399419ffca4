//! School as a texture that the window shows.

use eframe::egui_wgpu::RenderState;
use egui::TextureId;
use meshlod::picture::Picture;

use crate::{Canvas, Renderer, SchoolShow, ViewError};

/// Canvas on which every frame is drawn, and its texture.
#[derive(Debug, Default)]
pub(crate) struct SchoolPane {
    canvas: Option<Canvas>,
    texture: Option<TextureId>,
}

impl SchoolPane {
    /// Draws a frame of a size in pixels, no side of which may be 0, and returns its texture.
    pub fn draw(
        &mut self,
        show: &SchoolShow,
        renderer: &Renderer,
        state: &RenderState,
        size: [u32; 2],
    ) -> Result<Option<TextureId>, ViewError> {
        if self.canvas.as_ref().is_none_or(|canvas| canvas.size() != size) {
            let canvas = Canvas::new(renderer.gpu(), size)?;
            self.register(&canvas, state);
            self.canvas = Some(canvas);
        }
        if let Some(canvas) = &self.canvas {
            canvas.draw(|pass| show.draw(renderer, pass));
        }
        Ok(self.texture)
    }

    /// Returns the texture of the last frame.
    pub fn texture(&self) -> Option<TextureId> {
        self.texture
    }

    /// Reads the pixels of the last frame; `None` before the first one.
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
