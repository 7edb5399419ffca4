//! Helpers of the tests on the GPU.
#![allow(dead_code)]

pub mod compressed;

use std::sync::OnceLock;

use meshlod::Mesh;
use meshlod::picture::{Camera, Picture, Style};
use meshlod_view::{Canvas, Gpu, GpuMesh, Renderer, Shade, TargetFormat};

/// Opens the GPU, once; `None`, and a line that says so, if there is none.
///
/// With `MESHLOD_REQUIRE_GPU` set, there must be one.
pub fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    let gpu = GPU.get_or_init(|| match Gpu::headless() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            let is_required = std::env::var_os("MESHLOD_REQUIRE_GPU").is_some();
            assert!(!is_required, "{error}");
            None
        }
    });
    if gpu.is_none() {
        eprintln!("skipped: no GPU; apt-get install mesa-vulkan-drivers gives a software one");
    }
    gpu.as_ref()
}

/// Draws a mesh on the GPU in a style of `picture`.
pub fn draw(gpu: &Gpu, mesh: &Mesh, camera: &Camera, style: &Style<'_>) -> Picture {
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let drawn = GpuMesh::new(&renderer, mesh, &style.paint, style.normals).unwrap();
    let canvas = Canvas::new(gpu, style.size).unwrap();
    let placement = renderer.placement();
    let shade = Shade {
        lighting: style.lighting,
        back_faces: style.back_faces,
        wireframe: style.wireframe,
        face_colors: matches!(
            style.paint,
            meshlod::picture::Paint::FaceColors(_) | meshlod::picture::Paint::FaceValues(_)
        ),
        ..Shade::default()
    };
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
    canvas.read().unwrap()
}

/// Share of the pixels whose colours differ by more than `levels` of 255 in a channel, and the mean
/// difference.
pub fn difference(a: &Picture, b: &Picture, levels: u8) -> (f64, f64) {
    let pixels = a.rgba().chunks_exact(4).zip(b.rgba().chunks_exact(4));
    let (mut far, mut sum) = (0usize, 0usize);
    for (a, b) in pixels {
        let most = (0..4).map(|k| a[k].abs_diff(b[k])).max().unwrap_or(0);
        far += usize::from(most > levels);
        sum += usize::from(most);
    }
    let count = (a.rgba().len() / 4) as f64;
    (far as f64 / count, sum as f64 / count)
}
