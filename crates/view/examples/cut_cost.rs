//! Measures what a cut costs the processor and sends to the GPU while a camera orbits, at once and
//! with vertices that move, and looks for cracks in it.
//!
//! `cargo run --release -p meshlod-view --example cut_cost -- MODEL.mlod [PIXELS] [VIEWS]`

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use meshlod::ReadOptions;
use meshlod::mesh::Bounds;
use meshlod::multires::{Focus, Query, Tolerance, UpdateLimits, ViewCamera};
use meshlod::picture::{Antialiasing, Background, Camera, Picture, Style};
use meshlod_view::stage::{Loaded, LoadedContent};
use meshlod_view::{
    Canvas, CutFollower, CutModel, CutQuery, CutTolerance, FollowOptions, Gpu, GpuCut, Renderer,
    Shade, TargetFormat, Transition,
};

const SIZE: [u32; 2] = [1920, 1080];
const CRACK_SIZE: [u32; 2] = [2048, 2048];
const FOV_RAD: f64 = 0.8;

struct Orbit {
    middle: [f64; 3],
    radius: f64,
}

impl Orbit {
    fn eye(&self, degrees: f64, height: f64) -> [f64; 3] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let [x, y, z] = self.middle;
        [x + self.radius * sin, y + height * self.radius, z + self.radius * cos]
    }

    fn camera(&self, eye: [f64; 3]) -> Camera {
        Camera::look_at(eye, self.middle, [0.0, 1.0, 0.0], FOV_RAD)
    }
}

const FRAME: Duration = Duration::from_micros(16_667);
const FRAMES: u32 = 200;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("name a .mlod file")?;
    let pixels: f64 = arguments.next().map_or(Ok(1.0), |pixels| pixels.parse())?;
    let views: u32 = arguments.next().map_or(Ok(0), |views| views.parse())?;
    let loaded = Loaded::read(Path::new(&path), &ReadOptions::default())?;
    let LoadedContent::Levels(model) = loaded.content else { return Err("no levels".into()) };
    let gpu = Gpu::headless()?;
    println!("{}", gpu.name());
    let renderer = Renderer::new(&gpu, TargetFormat::CANVAS);
    let bounds = loaded.bounds;
    let orbit = Orbit { middle: bounds.center(), radius: 1.1 * bounds.diagonal() };
    println!("| changes | faces | cut, ms | of it at most | upload, ms | sent, % | at most |");
    println!("|---|--:|--:|--:|--:|--:|--:|");
    for (name, motion) in [("at once", None), ("moving", Some(Duration::from_millis(250)))] {
        let mut cut = GpuCut::new(&renderer, &model)?;
        let options = FollowOptions { changes: None, motion };
        let mut follower = CutFollower::start(model.clone(), options);
        let figures = follow(&gpu, &mut cut, &mut follower, &orbit, pixels)?;
        let columns = [0, 1, 2].map(|column| {
            let mut all: Vec<f64> = figures.iter().map(|figures| figures[column]).collect();
            all.sort_by(f64::total_cmp);
            [all[all.len() / 2], all[all.len() - 1]]
        });
        let [[step, longest], [upload, _], [sent, most]] = columns;
        let faces = cut.faces();
        print!("| {name} | {faces} | {step:.3} | {longest:.2} | {upload:.3} ");
        println!("| {sent:.3} | {most:.3} |");
    }
    let mut cut = GpuCut::new(&renderer, &model)?;
    look_for_cracks(&gpu, &renderer, &mut cut, &model, &orbit, &bounds, views)
}

/// Orbits by a tenth of a degree a frame, and returns for each frame the milliseconds of the cut
/// and of its upload, and the percentage of the index buffers that was sent.
fn follow(
    gpu: &Gpu,
    cut: &mut GpuCut,
    follower: &mut CutFollower,
    orbit: &Orbit,
    pixels: f64,
) -> Result<Vec<[f64; 3]>, Box<dyn std::error::Error>> {
    let mut figures = Vec::new();
    for frame in 0..=FRAMES {
        let eye = orbit.eye(0.1 * f64::from(frame), 0.2);
        let (look, up) = (orbit.middle, [0.0, 1.0, 0.0]);
        let camera = ViewCamera { eye, look, up, fov_rad: FOV_RAD, viewport: SIZE };
        let tolerance = CutTolerance::Pixels { camera, pixels };
        // Vertices of the first cut arrive before the orbit begins.
        follower.advance(if frame == 1 { Duration::MAX } else { FRAME });
        follower.ask(CutQuery { focus: Focus::Everything, tolerance });
        let (mut steps, mut upload) = (0.0, 0.0);
        while let Some(step) = follower.wait() {
            let step = step?;
            steps += step.milliseconds;
            let start = Instant::now();
            cut.apply(&step, Transition::Immediate);
            upload += start.elapsed().as_secs_f64() * 1e3;
        }
        gpu.wait()?;
        let sent = 100.0 * cut.take_uploaded() as f64 / cut.index_bytes() as f64;
        if frame > 1 {
            figures.push([steps, upload, sent]);
        }
    }
    Ok(figures)
}

/// Draws cuts of many kinds from many sides, and counts the pixels with background that the
/// processor covers in full: its faces leave no gaps. Only single pixels are looked at, since
/// models have holes.
fn look_for_cracks(
    gpu: &Gpu,
    renderer: &Renderer,
    cut: &mut GpuCut,
    model: &Arc<CutModel>,
    orbit: &Orbit,
    bounds: &Bounds,
    views: u32,
) -> Result<(), Box<dyn std::error::Error>> {
    let canvas = Canvas::new(gpu, CRACK_SIZE)?;
    let placement = renderer.placement();
    let style = Style {
        size: CRACK_SIZE,
        background: Background::Transparent,
        antialiasing: Antialiasing::Sixteen,
        ..Style::default()
    };
    let mut follower = CutFollower::start(model.clone(), FollowOptions::default());
    let (mut cracks, mut gaps) = (0, 0);
    for view in 0..views {
        let turn = f64::from(view) * 137.5;
        let camera = orbit.camera(orbit.eye(turn, (turn * 0.7).sin() * 0.8));
        placement.set(&camera, CRACK_SIZE, cut.origin(), &Shade::default());
        let error = bounds.diagonal() * 10f64.powf(-2.0 - f64::from(view % 5) / 2.0);
        let focus = match view % 3 {
            0 => Focus::Everything,
            1 => Focus::Sphere { center: bounds.max, radius: 0.4 * bounds.diagonal() },
            _ => Focus::Box([bounds.min, orbit.middle]),
        };
        follower.ask(CutQuery { focus: focus.clone(), tolerance: CutTolerance::Uniform(error) });
        let step = follower.wait().ok_or("the thread has ended")??;
        cut.apply(&step, Transition::Immediate);
        canvas.draw(|pass| cut.draw(renderer, pass, &placement));
        let found = pinholes(&canvas.read()?);
        if found.is_empty() {
            continue;
        }
        let query = Query { focus, tolerance: Tolerance::Uniform(error) };
        let mut level = model.levels().cut();
        level.update(&query, &UpdateLimits::default())?;
        let mesh = level.level().mesh();
        let exact = meshlod::picture::render(&mesh, &camera, &style)?;
        let is_crack = |&[x, y]: &[u32; 2]| exact.pixel(x, y)[3] == 255;
        cracks += found.iter().filter(|at| is_crack(at)).count();
        gaps += found.len();
    }
    if views > 0 {
        println!("{views} cuts at 2048 x 2048: {cracks} cracks; {gaps} pixels looked at twice");
    }
    Ok(())
}

/// Returns the background pixels whose eight neighbours are all covered.
fn pinholes(picture: &Picture) -> Vec<[u32; 2]> {
    let [width, height] = [picture.width(), picture.height()];
    let alpha = |x: u32, y: u32| picture.pixel(x, y)[3];
    let is_pinhole = |x: u32, y: u32| {
        let around = (y - 1..=y + 1).flat_map(|v| (x - 1..=x + 1).map(move |u| (u, v)));
        alpha(x, y) < 255 && around.filter(|&(u, v)| alpha(u, v) == 255).count() == 8
    };
    let inside = (1..height - 1).flat_map(|y| (1..width - 1).map(move |x| [x, y]));
    inside.filter(|&[x, y]| is_pinhole(x, y)).collect()
}
