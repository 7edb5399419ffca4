//! Draws a cut of a multiresolution model into a render pass of one's own, and follows a camera.
//!
//! `cargo run --release -p meshlod-view --example cut` writes cut.png.

use std::sync::Arc;

use meshlod::model::SceneLayout;
use meshlod::multires::{Focus, Forest, Hierarchy, Implicit, ViewCamera};
use meshlod::picture::{Background, Camera, Wireframe};
use meshlod::samples;
use meshlod_view::{
    Canvas, CutFollower, CutModel, CutQuery, CutTolerance, FollowOptions, Gpu, GpuCut, Renderer,
    Shade, TargetFormat, Transition,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // All levels of a mesh. `meshlod::multires::ModelFile` reads them from a file.
    let mut knot = samples::knot(200_000);
    knot.attributes = None;
    let forest = Forest::new(&knot, &meshlod::Options::default())?;
    let levels = Hierarchy::from(Implicit::new(&forest)?);
    let model = Arc::new(CutModel::new(levels, &SceneLayout::default())?);

    // Bring your own device, queue and target; this canvas is one without a window.
    let gpu = Gpu::headless()?;
    let size = [960, 540];
    let canvas = Canvas::new(&gpu, size)?;
    let renderer = Renderer::new(&gpu, TargetFormat::CANVAS);

    // The vertices of all levels are uploaded once; a thread follows the camera with a cut.
    let mut cut = GpuCut::new(&renderer, &model)?;
    let options = FollowOptions { changes: Some(20_000), motion: None };
    let mut follower = CutFollower::start(model, options);
    let placement = renderer.placement();
    let backdrop = renderer.backdrop(Background::default());

    for frame in 0..30 {
        let angle = f64::from(frame).to_radians();
        let eye = [3.5 * angle.sin(), 1.0, 3.5 * angle.cos()];
        let (look, up, fov_rad) = ([0.0; 3], [0.0, 1.0, 0.0], 0.7);

        // What the camera needs within one pixel, as far as the frame's share of changes goes.
        let camera = ViewCamera { eye, look, up, fov_rad, viewport: size };
        let tolerance = CutTolerance::Pixels { camera, pixels: 1.0 };
        follower.ask(CutQuery { focus: Focus::Frustum(camera), tolerance });
        // A window would `poll`, and draw the last cut while this one is not ready.
        let step = follower.wait().ok_or("the thread has ended")??;
        cut.apply(&step, Transition::Immediate);

        let camera = Camera::look_at(eye, look, up, fov_rad);
        let shade = Shade { wireframe: Some(Wireframe::default()), ..Shade::default() };
        placement.set(&camera, size, cut.origin(), &shade);
        canvas.draw(|pass| {
            cut.draw_faces(&renderer, pass, &placement);
            if let Some(backdrop) = &backdrop {
                renderer.draw_backdrop(pass, backdrop);
            }
        });
        println!("frame {frame}: {} faces, {} bytes sent", step.faces, cut.take_uploaded());
    }
    std::fs::write("cut.png", canvas.read()?.png())?;
    Ok(())
}
