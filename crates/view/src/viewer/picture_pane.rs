//! The stage as a texture that panels show.

use std::sync::Arc;

use eframe::egui_wgpu::RenderState;
use egui::TextureId;
use meshlod::picture::{Camera, Picture};

use super::canvas_texture::CanvasTexture;
use crate::stage::{Display, Stage, SubjectId};
use crate::{Gpu, Renderer, TargetFormat, ViewError};

/// Picture of the stage, drawn again only after a change.
///
/// A new large model is drawn as a draft first, with one sample a pixel and without its shadow, and
/// in full in the next frame.
#[derive(Debug, Default)]
pub(crate) struct PicturePane {
    canvas: CanvasTexture,
    drawn: Option<Drawn>,
}

/// State on which a picture depends.
#[derive(Clone, Debug, PartialEq)]
struct Drawn {
    size: [u32; 2],
    camera: Camera,
    display: Display,
    shown: Vec<SubjectId>,
    /// Number of changes of subjects.
    changes: u64,
    is_draft: bool,
}

/// Renderers of final pictures and of drafts.
#[derive(Debug)]
pub(crate) struct PaneRenderers {
    pub full: Arc<Renderer>,
    /// One sample a pixel.
    pub draft: Renderer,
}

/// Faces above which a new model is drawn as a draft first.
const DRAFT_FACES: usize = 200_000;

impl PaneRenderers {
    pub fn new(gpu: &Gpu) -> Self {
        let draft = TargetFormat { samples: 1, ..TargetFormat::CANVAS };
        Self {
            full: Arc::new(Renderer::new(gpu, TargetFormat::CANVAS)),
            draft: Renderer::new(gpu, draft),
        }
    }
}

impl PicturePane {
    /// Draws the stage if it has changed, and returns its texture; `None` for a picture without
    /// pixels. `changes` must differ whenever subjects have changed.
    pub fn draw(
        &mut self,
        stage: &mut Stage,
        renderers: &PaneRenderers,
        state: &RenderState,
        size: [u32; 2],
        changes: u64,
    ) -> Result<Option<TextureId>, ViewError> {
        if size.contains(&0) {
            return Ok(self.canvas.texture());
        }
        let shown: Vec<_> = stage.shown().collect();
        let is_new = self.drawn.as_ref().is_none_or(|drawn| drawn.shown != shown);
        let is_draft = is_new && stage.faces() > DRAFT_FACES;
        let (camera, display) = (stage.rig.camera(), stage.display);
        let wanted = Drawn { size, camera, display, shown, changes, is_draft };
        if self.drawn.as_ref() == Some(&wanted) {
            return Ok(self.canvas.texture());
        }
        let renderer = if is_draft { &renderers.draft } else { &*renderers.full };
        if !is_draft {
            stage.prepare(renderer)?;
        }
        let canvas = self.canvas.canvas(renderer, state, size)?;
        canvas.draw(|pass| stage.draw(renderer, pass, size));
        self.drawn = Some(wanted);
        Ok(self.canvas.texture())
    }

    /// Returns true if the picture is a draft, to be drawn again at once.
    pub fn is_draft(&self) -> bool {
        self.drawn.as_ref().is_some_and(|drawn| drawn.is_draft)
    }

    /// Returns true if the picture shows all changes of subjects and is no draft.
    pub fn is_final(&self, changes: u64) -> bool {
        self.drawn.as_ref().is_some_and(|drawn| drawn.changes == changes && !drawn.is_draft)
    }

    /// Reads the pixels of the picture; `None` before the first one.
    pub fn read(&self) -> Result<Option<Picture>, ViewError> {
        self.canvas.read()
    }
}
