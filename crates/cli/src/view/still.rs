//! One picture by the GPU.

use std::path::Path;

use meshlod::multires::Focus;
use meshlod::picture::{Background, Camera, Picture, Style, View};
use meshlod::{Mesh, ReadOptions};
use meshlod_view::stage::{Display, Loaded, Subject};
use meshlod_view::{
    Canvas, CutQuery, CutTolerance, Gpu, Renderer, TargetFormat, ViewError, render, view_camera,
};

use crate::session::failure::Failure;

/// File that is drawn as it is stored.
pub struct Stored {
    pub picture: Picture,
    /// Faces that were drawn.
    pub faces: usize,
}

/// Returns true for files that the GPU draws as they are stored.
pub fn is_stored(path: &Path) -> bool {
    let suffix = path.extension().and_then(|suffix| suffix.to_str()).unwrap_or_default();
    ["mlod", "mlq", "mlz"].iter().any(|known| suffix.eq_ignore_ascii_case(known))
}

/// Draws a mesh in a style of pictures.
pub fn mesh(mesh: &Mesh, camera: &Camera, style: &Style<'_>) -> Result<Picture, Failure> {
    let gpu = Gpu::headless().map_err(Failure::new)?;
    render(&gpu, mesh, camera, style).map_err(Failure::new)
}

/// Draws a compressed mesh from its compressed positions, and of levels of detail what one pixel
/// needs.
pub fn stored(
    path: &Path,
    size: [u32; 2],
    view: &View,
    display: &Display,
) -> Result<Stored, Failure> {
    let loaded = Loaded::read(path, &ReadOptions::default()).map_err(Failure::new)?;
    let camera = Camera::fit_mesh(&loaded.mesh, view);
    let gpu = Gpu::headless().map_err(Failure::new)?;
    draw(&gpu, &loaded, &camera, size, display).map_err(|error| Failure::at(path, error))
}

fn draw(
    gpu: &Gpu,
    loaded: &Loaded,
    camera: &Camera,
    size: [u32; 2],
    display: &Display,
) -> Result<Stored, ViewError> {
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let canvas = Canvas::new(gpu, size)?;
    let mut subject = Subject::new(&renderer, loaded)?;
    if let Subject::Levels(levels) = &mut subject {
        let camera = view_camera(camera, size);
        let tolerance = CutTolerance::Pixels { camera, pixels: 1.0 };
        levels.ask(CutQuery { focus: Focus::Everything, tolerance });
        levels.finish()?;
    }
    let placement = renderer.placement();
    placement.set(camera, size, subject.origin(), &subject.display(display).shade());
    let backdrop = renderer.backdrop(Background::default());
    canvas.draw(|pass| {
        subject.draw(&renderer, pass, &placement, display);
        if let Some(backdrop) = &backdrop {
            renderer.draw_backdrop(pass, backdrop);
        }
    });
    Ok(Stored { picture: canvas.read()?, faces: subject.faces() })
}
