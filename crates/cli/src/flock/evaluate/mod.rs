//! `flock --evaluate`: triangles against image error for all policies, as a page and as JSON.

mod chart;
mod page;
mod pictures;
mod summary;

use std::path::Path;
use std::sync::Arc;

use meshlod::flock::levels::LevelTable;
use meshlod::flock::select::Budget;
use meshlod::io::write_file;
use meshlod_school::Footage;
use meshlod_school::evaluate::{Arm, Evaluation, EvaluationOptions, Track, evaluate, over_time};
use meshlod_school::scene::ScenarioName;

use crate::flock::evaluate::pictures::Pictures;
use crate::flock::model::FlockModel;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::count;
use crate::verbs::flock::Flock;

/// Extent of an evaluation.
struct Extent {
    size: [u32; 2],
    frames: usize,
    pairs: usize,
    shares: &'static [f64],
    /// Frames from one that is compared over time to the next.
    step: usize,
}

const QUICK: Extent = Extent {
    size: [640, 360],
    frames: 300,
    pairs: 2,
    shares: &[0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7],
    step: 30,
};

const FULL: Extent = Extent {
    size: [1280, 720],
    frames: 600,
    pairs: 4,
    shares: &[0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8],
    step: 20,
};

/// Greatest number of triangles of a frame in full detail.
const MOST_TRIANGLES: usize = 10_000_000;

/// Image errors for which the triangles needed are found.
pub const FLIPS: [f64; 3] = [0.01, 0.02, 0.05];

/// Share of the triangles of full detail at which pictures are shown.
pub const SHOWN_SHARE: f64 = 0.05;

/// Name of the arm that stands for what engines do, and of the one with occlusion.
pub const BUDGET: &str = "budget";
pub const SCREEN_ERROR: &str = "screen-error, occluded skipped";
pub const OURS: &str = "ours";
pub const OURS_VISIBLE: &str = "ours, occluded skipped";

/// Everything that the page shows.
pub struct Report<'a> {
    pub model: &'a FlockModel,
    pub members: usize,
    pub size: [u32; 2],
    pub is_quick: bool,
    pub evaluation: &'a Evaluation,
    /// Paper's experiment.
    pub tracks: &'a [Track],
    pub frame_s: f32,
    pub pictures: &'a Pictures,
}

/// Evaluates all policies in all scenes and writes the page.
pub fn run(
    options: &Flock,
    model: &FlockModel,
    table: &Arc<LevelTable>,
    session: &Session,
) -> Result<Answer, Failure> {
    let extent = if options.quick { QUICK } else { FULL };
    check_extent(options.school.members, table)?;
    let footage = footage(options, &extent, session)?;
    let settings = EvaluationOptions {
        shares: extent.shares.to_vec(),
        pairs: extent.pairs,
        flips: FLIPS.to_vec(),
        ..EvaluationOptions::default()
    };
    let mut pictures = Pictures::default();
    let mut watch = |part: f64, what: &str| {
        session.progress.part(what, (part * 1000.0) as usize, 1000);
    };
    let mut keep = |still| pictures.keep(still);
    let evaluation = evaluate(&footage, table, &model.look, &settings, &mut watch, &mut keep)
        .map_err(Failure::new)?;
    session.progress.stage("paper's experiment");
    let tracks = over_time(
        &footage[0],
        table,
        &model.look,
        &Arm::of_the_paper(),
        &Budget::default(),
        extent.step,
    )
    .map_err(Failure::new)?;
    session.progress.stage("strips of frames");
    pictures.strips(&footage, table, &model.look)?;
    let report = Report {
        model,
        members: options.school.members,
        size: extent.size,
        is_quick: options.quick,
        evaluation: &evaluation,
        tracks: &tracks,
        frame_s: footage[0].frame_s,
        pictures: &pictures,
    };
    write(&options.out, &report)?;
    Ok(Answer::new(summary::json(&report, &options.out), summary::text(&report, &options.out)))
}

/// Refuses what is too large to be drawn in full detail.
pub fn check_extent(members: usize, table: &LevelTable) -> Result<(), Failure> {
    let triangles = members.saturating_mul(table.triangle_count(0));
    match triangles > MOST_TRIANGLES {
        false => Ok(()),
        true => Err(Failure::new(format_args!(
            "full detail has {} triangles, and pictures are compared up to {}: take fewer members or \
             a coarser model",
            count(triangles),
            count(MOST_TRIANGLES)
        ))),
    }
}

/// Records the five scenes.
fn footage(options: &Flock, extent: &Extent, session: &Session) -> Result<Vec<Footage>, Failure> {
    let scenes = options.scenes(extent.size);
    let record = |(i, name): (usize, ScenarioName)| {
        session.progress.part("recording", i, ScenarioName::ALL.len());
        scenes.scenario(name)?.footage(extent.frames).map_err(Failure::new)
    };
    ScenarioName::ALL.into_iter().enumerate().map(record).collect()
}

fn write(folder: &Path, report: &Report<'_>) -> Result<(), Failure> {
    files::make_folder(folder)?;
    for (name, png) in report.pictures.files() {
        write_file(&folder.join(name), &png)?;
    }
    let json = serde_json::to_vec_pretty(&summary::full_json(report)).map_err(Failure::new)?;
    write_file(&folder.join("evaluation.json"), &json)?;
    Ok(write_file(&folder.join("index.html"), page::page(report).into_string().as_bytes())?)
}
