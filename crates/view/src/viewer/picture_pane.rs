//! The stage as a texture that panels show.

use eframe::egui_wgpu::RenderState;
use egui::TextureId;
use meshlod::picture::{Camera, Picture};

use crate::stage::{Display, Stage};
use crate::{Canvas, Renderer, ViewError};

/// Picture of the stage, drawn again only when something has changed.
#[derive(Debug, Default)]
pub(crate) struct PicturePane {
    canvas: Option<Canvas>,
    texture: Option<TextureId>,
    drawn: Option<Drawn>,
}

/// What a picture depends on.
#[derive(Clone, Debug, PartialEq)]
struct Drawn {
    size: [u32; 2],
    camera: Camera,
    display: Display,
    /// Number of changes of subjects so far.
    changes: u64,
}

impl PicturePane {
    /// Draws the stage if it has changed, and returns its texture; `None` for a picture without
    /// pixels. `changes` must differ whenever subjects have changed.
    pub fn draw(
        &mut self,
        stage: &mut Stage,
        renderer: &Renderer,
        state: &RenderState,
        size: [u32; 2],
        changes: u64,
    ) -> Result<Option<TextureId>, ViewError> {
        if size.contains(&0) {
            return Ok(self.texture);
        }
        let wanted = Drawn { size, camera: stage.rig.camera(), display: stage.display, changes };
        if self.drawn.as_ref() == Some(&wanted) {
            return Ok(self.texture);
        }
        if self.canvas.as_ref().is_none_or(|canvas| canvas.size() != size) {
            let canvas = Canvas::new(renderer.gpu(), size)?;
            self.register(&canvas, state);
            self.canvas = Some(canvas);
        }
        stage.prepare(renderer)?;
        if let Some(canvas) = &self.canvas {
            canvas.draw(|pass| stage.draw(renderer, pass, size));
        }
        self.drawn = Some(wanted);
        Ok(self.texture)
    }

    /// Reads the pixels of the picture; `None` before the first one.
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
