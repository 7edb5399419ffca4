//! Cost of a frame of a school on the GPU, with levels and without, at equal pictures.
//!
//! `cargo run --release -p meshlod-view --example flock_cost -- [--members N]` finds for each way
//! of choosing levels the coarsest that differs from full detail by a mean FLIP of at most .02, and
//! times all of them by turns. With `--budget` it only draws `ours` with that many triangles.

#[path = "../tests/common/school.rs"]
mod school;

use std::time::Instant;

use meshlod::flock::draw::WATER;
use meshlod::flock::select::{Budget, PolicyName, Selector};
use meshlod::flock::{Flock, FlockCamera};
use meshlod::picture::{Lighting, Picture, flip};
use meshlod_school::scene::ScenarioName;
use meshlod_view::{
    Backdrop, Canvas, Gpu, GpuFlock, GpuSelection, HiZ, Placement, Renderer, Shade, TargetFormat,
    ViewError,
};
use school::{SampleSchool, frame};

const SIZE: [u32; 2] = [960, 540];
/// Greatest mean FLIP against full detail.
const FLIP: f64 = 0.02;
/// Frames of full detail that take longer are not compared with.
const LONGEST_MS: f64 = 120_000.0;
/// Rounds in which all ways are timed by turns.
const ROUNDS: usize = 5;

/// Way of choosing levels, with its fineness: detail, or triangles of the budget.
#[derive(Clone, Copy)]
struct Arm {
    policy: PolicyName,
    on_gpu: bool,
    hides: bool,
    fineness: f64,
    impostors_below_px: Option<f32>,
}

/// All that a frame is drawn with.
struct Stage<'a> {
    gpu: &'a Gpu,
    school: &'a SampleSchool,
    renderer: Renderer,
    canvas: Canvas,
    placement: Placement,
    water: Backdrop,
    drawn: GpuFlock,
    choice: GpuSelection,
    depths: HiZ,
    flock: Flock,
    camera: FlockCamera,
}

/// Time of a frame in milliseconds, and its triangles.
struct Cost {
    choose_ms: f64,
    all_ms: f64,
    triangles: u64,
}

impl<'a> Stage<'a> {
    fn new(gpu: &'a Gpu, school: &'a SampleSchool, members: usize) -> Result<Self, ViewError> {
        let (flock, camera, _) = frame(ScenarioName::Ring, members, SIZE, 10);
        let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
        let drawn = GpuFlock::new(&renderer, &school.table, &school.look)?;
        let drawn = drawn.with_impostor(&renderer, &school.impostor)?;
        let choice = GpuSelection::new(&renderer, &drawn, &school.table)?;
        let mut canvas = Canvas::new(gpu, SIZE)?;
        canvas.keeps_depth = true;
        Ok(Self {
            gpu,
            school,
            canvas,
            placement: renderer.placement(),
            water: renderer.backdrop(WATER).expect("water is a gradient"),
            drawn,
            choice,
            depths: HiZ::new(gpu, SIZE, TargetFormat::CANVAS.samples)?,
            renderer,
            flock,
            camera,
        })
    }

    fn selector(&self, arm: &Arm) -> Selector {
        Selector::new(arm.policy, self.school.table.clone())
    }

    /// Chooses levels and draws a frame, and waits for it.
    fn draw(&mut self, arm: &Arm, selector: &mut Selector) -> Result<Cost, ViewError> {
        let budget = arm.budget();
        let start = Instant::now();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let origin = if arm.on_gpu {
            self.choice.upload(&self.flock)?;
            let depths = arm.hides.then_some(&self.depths);
            self.choice.choose(&mut encoder, &self.camera, &budget, depths);
            self.choice.origin()
        } else {
            let levels = selector.select(&self.flock, &self.camera, &budget);
            self.drawn.set(&self.flock, levels, &self.camera)?;
            self.drawn.origin()
        };
        let choose_ms = 1e3 * start.elapsed().as_secs_f64();
        let shade = Shade { lighting: Lighting::Headlight, ..Shade::default() };
        self.placement.set(&self.camera.for_picture(), SIZE, origin, &shade);
        let mut pass = self.canvas.pass(&mut encoder);
        if arm.on_gpu {
            self.choice.draw(&self.renderer, &mut pass, &self.placement);
        } else {
            self.drawn.draw(&self.renderer, &mut pass, &self.placement);
        }
        self.renderer.draw_backdrop(&mut pass, &self.water);
        drop(pass);
        if arm.hides {
            self.depths.build(&mut encoder, self.canvas.depth(), &self.camera);
        }
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait()?;
        let all_ms = 1e3 * start.elapsed().as_secs_f64();
        Ok(Cost { choose_ms, all_ms, triangles: self.drawn.triangles() })
    }

    /// Draws a frame and returns its mean FLIP against another.
    fn error(&mut self, arm: &Arm, full: &Picture) -> Result<f64, ViewError> {
        let mut selector = self.selector(arm);
        let cost = self.draw(arm, &mut selector)?;
        let errors = flip(full, &self.canvas.read()?)?;
        let error = errors.iter().map(|&e| f64::from(e)).sum::<f64>() / errors.len() as f64;
        let (name, fineness, ms) = (arm.name(), arm.fineness, cost.all_ms);
        eprintln!("{name} at {fineness:.3}: {} triangles, {ms:.0} ms, {error:.4}", cost.triangles);
        Ok(error)
    }

    /// Finds the coarsest fineness whose picture is near enough to full detail, from where the arm
    /// stands; `None` if even much finer ones are not.
    fn coarsest(&mut self, arm: Arm, full: &Picture) -> Result<Option<Arm>, ViewError> {
        let mut is_near =
            |fineness: f64| Ok::<_, ViewError>(self.error(&Arm { fineness, ..arm }, full)? <= FLIP);
        let [mut low, mut high] = [arm.fineness; 2];
        if is_near(high)? {
            while {
                low /= 2.0;
                is_near(low)?
            } {
                high = low;
            }
        } else {
            while {
                high *= 2.0;
                !is_near(high)?
            } {
                low = high;
                if high > 64.0 * arm.fineness {
                    return Ok(None);
                }
            }
        }
        while high / low > 1.1 {
            let fineness = (low * high).sqrt();
            if is_near(fineness)? { high = fineness } else { low = fineness }
        }
        Ok(Some(Arm { fineness: high, ..arm }))
    }
}

impl Arm {
    fn of(policy: PolicyName, impostors_below_px: Option<f32>) -> Self {
        Self { policy, on_gpu: false, hides: false, fineness: 1.0, impostors_below_px }
    }

    fn budget(&self) -> Budget {
        Budget {
            triangles: self.fineness as usize,
            detail: self.fineness as f32,
            impostors_below_px: self.impostors_below_px,
        }
    }

    fn name(&self) -> String {
        let by = if self.on_gpu { " on the GPU, facing" } else { "" };
        let hides = if self.hides { ", Hi-Z" } else { "" };
        let impostors = self.impostors_below_px;
        let impostors = impostors.map_or(String::new(), |px| format!(", impostors {px}"));
        format!("{}{by}{hides}{impostors}", self.policy.name())
    }
}

/// Finds the arms, times them by turns, and prints a row for each.
fn compare(
    gpu: &Gpu,
    school: &SampleSchool,
    members: usize,
    budget: Option<f64>,
) -> Result<(), ViewError> {
    let mut stage = Stage::new(gpu, school, members)?;
    let full = Arm::of(PolicyName::None, None);
    let mut selector = stage.selector(&full);
    let cost = stage.draw(&full, &mut selector)?;
    let picture = stage.canvas.read()?;
    let all = cost.triangles as f64;
    eprintln!("{members} members: {all} triangles in {:.0} ms", cost.all_ms);
    let is_slow = cost.all_ms > 10_000.0;
    if cost.all_ms > LONGEST_MS {
        println!("| {members} | none | | {all} | | | {:.0} | |", cost.all_ms);
        return Ok(());
    }
    let mut arms = vec![full];
    let limits = if is_slow { &[None, Some(12.0)][..] } else { &[None, Some(6.0), Some(12.0)] };
    if let Some(fineness) = budget {
        arms.push(Arm { fineness, ..Arm::of(PolicyName::Ours, None) });
    }
    for &px in limits.iter().filter(|_| budget.is_none()) {
        let by_budget = Arm { fineness: all / 32.0, ..Arm::of(PolicyName::Ours, px) };
        arms.extend(stage.coarsest(by_budget, &picture)?);
        let by_error = Arm { fineness: 0.5, ..Arm::of(PolicyName::ScreenError, px) };
        let found = stage.coarsest(by_error, &picture)?;
        arms.extend(found);
        let on_gpu = found.filter(|_| px.is_none()).map(|arm| Arm { on_gpu: true, ..arm });
        arms.extend(on_gpu);
        arms.extend(on_gpu.map(|arm| Arm { hides: true, ..arm }));
    }
    let mut errors = vec![0.0];
    for arm in &arms[1..] {
        errors.push(stage.error(arm, &picture)?);
    }
    let mut costs: Vec<Vec<Cost>> = arms.iter().map(|_| Vec::new()).collect();
    let mut selectors: Vec<_> = arms.iter().map(|arm| stage.selector(arm)).collect();
    for _ in 0..if is_slow { 2 } else { ROUNDS } {
        for ((arm, costs), selector) in arms.iter().zip(&mut costs).zip(&mut selectors) {
            // The first frame after another arm fills caches that all frames of a run share.
            costs.push(stage.draw(arm, selector)?);
        }
    }
    let of_full = median(costs[0].iter().map(|cost| cost.all_ms));
    for ((arm, costs), error) in arms.iter().zip(&costs).zip(errors) {
        let all_ms = median(costs.iter().map(|cost| cost.all_ms));
        let choose_ms = median(costs.iter().map(|cost| cost.choose_ms));
        let triangles = costs[0].triangles;
        let triangles = if arm.on_gpu { "".into() } else { triangles.to_string() };
        println!(
            "| {members} | {} | {:.3} | {triangles} | {error:.4} | {choose_ms:.1} | {all_ms:.1} | {:.1} |",
            arm.name(),
            arm.fineness,
            of_full / all_ms
        );
    }
    Ok(())
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let (members, budget) = match words[..] {
        [] => (vec![150, 1_000, 10_000], None),
        ["--members", members] => (vec![members.parse()?], None),
        ["--members", members, "--budget", budget] => {
            (vec![members.parse()?], Some(budget.parse()?))
        }
        _ => return Err("the options are --members N, and then --budget TRIANGLES".into()),
    };
    let gpu = Gpu::headless()?;
    println!("{}, {} x {}, FLIP at most {FLIP}", gpu.name(), SIZE[0], SIZE[1]);
    let school = SampleSchool::new(4_000, 24);
    println!(
        "| members | levels | fineness | triangles | FLIP | choose ms | frame ms | times as fast |"
    );
    println!("|--:|---|--:|--:|--:|--:|--:|--:|");
    for members in members {
        compare(&gpu, &school, members, budget)?;
    }
    Ok(())
}
