//! `flock`: films schools of a model, every member with the level that a policy chooses.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Args;
use meshlod::flock::select::Budget;
use meshlod_school::scene::Film;

use crate::flock::model::{FlockModel, ModelArgs};
use crate::flock::scene::SceneSettings;
use crate::flock::school_args::SchoolArgs;
use crate::flock::summary::Summary;
use crate::flock::{evaluate, names, record, score, shoot};
use crate::options::args::ReadArgs;
use crate::options::parse;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;

/// Film schools of a model, each member only as fine as needed
///
/// Writes the frames as PNG and their figures as OUT/frames.jsonl, one JSON object a line. Lengths
/// are in body lengths: the longest side of the model's box is 1.
#[derive(Args)]
pub struct Flock {
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub reading: ReadArgs,
    #[command(flatten)]
    pub school: SchoolArgs,
    /// Triangles per frame, for the policies budget and ours [default: a tenth of those of all
    /// members at full detail]
    #[arg(long, value_name = "N", value_parser = parse::positive, allow_negative_numbers = true)]
    pub triangles: Option<usize>,
    /// Fineness of the other policies: 2 keeps detail to twice the distance
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = names::detail,
        allow_negative_numbers = true)]
    pub detail: f64,
    /// Draw members smaller than this many pixels as impostors
    ///
    /// Impostors are quads of two triangles with a picture of the model. The size is that of a body
    /// length.
    #[arg(long, value_name = "PX", value_parser = names::impostors, allow_negative_numbers = true)]
    pub impostors: Option<f64>,
    /// Number of frames
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = names::frames,
        allow_negative_numbers = true)]
    pub frames: usize,
    /// Frames a second
    #[arg(long, value_name = "X", default_value_t = 30.0, value_parser = names::fps,
        allow_negative_numbers = true)]
    pub fps: f64,
    /// Width and height of the frames in pixels
    #[arg(long, value_name = "WxH", default_value = "960x540", value_parser = parse::pixels)]
    pub size: [u32; 2],
    /// Seed of the simulation
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
    /// Folder to write to; created if missing
    #[arg(long, value_name = "DIR", default_value = "flock")]
    pub out: PathBuf,
    /// Folder for a recording; created if missing
    ///
    /// Members, cameras, levels and selection, as JSON and NumPy arrays.
    #[arg(long, value_name = "DIR")]
    pub record: Option<PathBuf>,
    /// Compare all policies instead
    ///
    /// In five scenes: triangles against image error, written to OUT as a page with pictures
    /// (index.html) and as figures (evaluation.json).
    #[arg(long, conflicts_with_all = ["policy", "camera", "triangles", "detail", "impostors", "frames",
        "size", "no_pictures", "record"])]
    pub evaluate: bool,
    /// Evaluate small pictures and few frames, within minutes
    #[arg(long, requires = "evaluate")]
    pub quick: bool,
    /// Score a recording instead
    ///
    /// Draws the levels of its selection.npy, whoever chose them, and compares them with full
    /// detail; --model names the recorded model, for its textures.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["evaluate", "policy", "camera", "triangles",
        "detail", "impostors", "frames", "size", "no_pictures", "record"])]
    pub score: Option<PathBuf>,
    /// Draw no pictures: only OUT/frames.jsonl is written
    #[arg(long)]
    pub no_pictures: bool,
}

impl Flock {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_folder(&self.out)?;
        if let Some(folder) = &self.record {
            record::check(folder, self.school.members, self.frames)?;
        }
        let scenario = self.scenes(self.size).scenario(self.school.camera)?;
        let model = FlockModel::load(&self.model, &self.reading, session)?;
        if let Some(folder) = &self.score {
            return score::run(folder, &model, session);
        }
        if self.evaluate {
            session.progress.stage("building levels");
            let table = Arc::new(model.table(self.model.method)?);
            return evaluate::run(&self, &model, &table, session);
        }
        session.progress.stage("setting the scene");
        let film = Film::new(scenario).map_err(Failure::new)?;
        session.progress.stage("building levels");
        let start = Instant::now();
        let table = Arc::new(model.table(self.model.method)?);
        let build_seconds = start.elapsed().as_secs_f64();
        let full = self.school.members.saturating_mul(table.triangle_count(0));
        let triangles = self.triangles.unwrap_or_else(|| (full / 10).max(1));
        let budget = Budget {
            triangles,
            detail: self.detail as f32,
            impostors_below_px: self.impostors.map(|px| px as f32),
        };
        let take = shoot::shoot(&self, &model, &table, film, &budget, session)?;
        let summary = Summary {
            options: &self,
            model: &model,
            table: &table,
            build_seconds,
            budget,
            take: &take,
        };
        Ok(Answer::new(summary.json(), summary.text()))
    }

    /// Returns what all scenes have in common, with pictures of a size in pixels.
    pub fn scenes(&self, size: [u32; 2]) -> SceneSettings {
        let Self { seed, fps, .. } = *self;
        let SchoolArgs { members, schools, .. } = self.school;
        SceneSettings { members, schools, seed, size, fps }
    }
}
