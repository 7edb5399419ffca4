//! One picture, as `meshlod::picture` draws it, on the GPU.

use meshlod::Mesh;
use meshlod::multires::ViewCamera;
use meshlod::picture::{Camera, Paint, Picture, Style};

use crate::{Canvas, Gpu, GpuMesh, Renderer, Shade, TargetFormat, ViewError};

/// Draws a picture of a mesh in a style of [`meshlod::picture::render`].
///
/// Pixels on surfaces are the same within a few levels of 255; along edges the samples differ, four
/// to a pixel whatever the style asks for. A mesh beyond the storage limits of the GPU is drawn
/// without a wireframe and without colours of faces.
///
/// # Errors
/// As [`GpuMesh::new`]; a size beyond the limits of the GPU; a GPU that was lost.
pub fn render(
    gpu: &Gpu,
    mesh: &Mesh,
    camera: &Camera,
    style: &Style<'_>,
) -> Result<Picture, ViewError> {
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let canvas = Canvas::new(gpu, style.size)?;
    let Style { paint, normals, single_sided, .. } = style;
    let drawn = GpuMesh::with_sides(&renderer, mesh, paint, *normals, single_sided)?;
    let shade = Shade::of(style);
    let placement = renderer.placement();
    placement.set(camera, style.size, drawn.origin(), &shade);
    let backdrop = renderer.backdrop(style.background);
    canvas.draw(|pass| {
        if shade.wireframe.is_some() || shade.face_colors {
            drawn.draw_faces(&renderer, pass, &placement);
        } else {
            drawn.draw(&renderer, pass, &placement);
        }
        if let Some(backdrop) = &backdrop {
            renderer.draw_backdrop(pass, backdrop);
        }
    });
    canvas.read()
}

impl Shade {
    /// Returns the look of a style of pictures.
    pub fn of(style: &Style<'_>) -> Self {
        Self {
            lighting: style.lighting,
            back_faces: style.back_faces,
            wireframe: style.wireframe,
            face_colors: matches!(style.paint, Paint::FaceColors(_) | Paint::FaceValues(_)),
            ..Self::default()
        }
    }
}

/// Converts a camera of pictures to one of [`meshlod::multires`] queries with the same view, for a
/// picture of a width and height in pixels.
pub fn view_camera(camera: &Camera, size: [u32; 2]) -> ViewCamera {
    let [_, up, forward] = camera.axes();
    let eye = camera.eye();
    let [width, height] = size.map(f64::from);
    // The field of view is that of the shorter side; queries want the vertical one.
    let tangent = camera.tan_half_fov() * height / width.min(height);
    ViewCamera {
        eye,
        look: [0, 1, 2].map(|k| eye[k] + forward[k]),
        up,
        fov_rad: 2.0 * tangent.atan(),
        viewport: size,
    }
}
