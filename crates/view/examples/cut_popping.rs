//! Measures how much the picture of a model in its own textures jumps while a cut follows an orbit,
//! at once and with vertices that move.
//!
//! `cargo run --release -p meshlod-view --example cut_popping -- MODEL.mlod…`. Between two pictures
//! the camera stands still: it is the later one's. Cuts change by a degree at a pixel, in pictures
//! of 512 by 512. Differences are sums over pixels, for each triangle whose slot changes.

use std::error::Error;
use std::path::Path;
use std::time::Duration;

use meshlod::ReadOptions;
use meshlod::multires::Focus;
use meshlod::picture::{Camera, Picture, flip};
use meshlod_view::stage::{Loaded, LoadedContent};
use meshlod_view::{
    Canvas, CutFollower, CutQuery, CutTolerance, FollowOptions, Gpu, GpuCut, Placement, Renderer,
    Shade, TargetFormat, Transition, view_camera,
};

type Failure = Box<dyn Error>;

const SIZE: [u32; 2] = [512, 512];
const FOV_RAD: f64 = std::f64::consts::FRAC_PI_4;
const STEPS: u32 = 40;

/// Time that a vertex moves, and between two pictures of it.
const MOTION: Duration = Duration::from_millis(250);
const FRAME: Duration = Duration::from_micros(16_667);

fn main() -> Result<(), Failure> {
    let gpu = Gpu::headless()?;
    println!("| 40° at 1 px, 512 x 512 | changed triangles | at once: FLIP | first frame: FLIP |");
    println!("|---|--:|--:|--:|");
    std::env::args().skip(1).try_for_each(|path| {
        let [pop, first, changed] = measure(&gpu, Path::new(&path))?;
        let name = Path::new(&path).file_stem().unwrap_or_default().to_string_lossy();
        println!("| {name} | {changed} | {:.3} | {:.3} |", pop / changed, first / changed);
        Ok(())
    })
}

/// Returns the differences over an orbit from each cut to the next, those from each cut to the
/// first frame of the motion, and the number of triangles that changed.
fn measure(gpu: &Gpu, path: &Path) -> Result<[f64; 3], Failure> {
    let loaded = Loaded::read(path, &ReadOptions::default())?;
    let LoadedContent::Levels(model) = &loaded.content else { return Err("no levels".into()) };
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut film = Film {
        cut: GpuCut::new(&renderer, model)?,
        placement: renderer.placement(),
        canvas: Canvas::new(gpu, SIZE)?,
        renderer,
    };
    let options = FollowOptions { changes: None, motion: Some(MOTION) };
    let mut follower = CutFollower::start(model.clone(), options);
    let (look, diagonal) = (loaded.bounds.center(), loaded.bounds.diagonal());
    let distance = 0.6 * diagonal / (FOV_RAD / 2.0).tan();
    let mut sums = [0.0; 3];
    for step in 0..=STEPS {
        let (sin, cos) = f64::from(step).to_radians().sin_cos();
        let eye = [look[0] + distance * sin, look[1], look[2] + distance * cos];
        let camera = Camera::look_at(eye, look, [0.0, 1.0, 0.0], FOV_RAD);
        let before = film.picture(&camera)?;
        let tolerance = CutTolerance::Pixels { camera: view_camera(&camera, SIZE), pixels: 1.0 };
        follower.ask(CutQuery { focus: Focus::Everything, tolerance });
        let mut changed = film.take(&mut follower)?;
        follower.advance(FRAME);
        changed += film.take(&mut follower)?;
        let first = film.picture(&camera)?;
        follower.advance(MOTION);
        changed += film.take(&mut follower)?;
        let after = film.picture(&camera)?;
        // The first cut comes from the coarsest level.
        if step > 0 {
            let found = [difference(&before, &after)?, difference(&before, &first)?, changed];
            sums.iter_mut().zip(found).for_each(|(sum, more)| *sum += more);
        }
    }
    Ok(sums)
}

/// A cut and where it is drawn.
struct Film {
    renderer: Renderer,
    canvas: Canvas,
    placement: Placement,
    cut: GpuCut,
}

impl Film {
    /// Applies the next step of a follower if it is ready, and returns the number of changed slots.
    fn take(&mut self, follower: &mut CutFollower) -> Result<f64, Failure> {
        let mut changed = 0;
        while let Some(step) = follower.wait() {
            let step = step?;
            changed += step.patches.len();
            self.cut.apply(&step, Transition::Immediate);
        }
        Ok(changed as f64)
    }

    fn picture(&self, camera: &Camera) -> Result<Picture, Failure> {
        self.placement.set(camera, SIZE, self.cut.origin(), &Shade::default());
        self.canvas.draw(|pass| self.cut.draw(&self.renderer, pass, &self.placement));
        Ok(self.canvas.read()?)
    }
}

fn difference(before: &Picture, after: &Picture) -> Result<f64, Failure> {
    Ok(flip(before, after)?.iter().map(|&error| f64::from(error)).sum())
}
