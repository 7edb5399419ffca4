//! `tiles`: writes a model of any size as 3D Tiles, or one of the steps of that.

mod report;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use meshlod::Scene;
use meshlod::jobs::{
    Globe, TileInput, TilesRequest, Up, finish_tiles, plan_tiles, run_tile_task, tiles,
};
use meshlod::tiles::plan::Look;
use meshlod::tiles::source::SceneSource;
use serde_json::json;

use crate::options::args::ReadArgs;
use crate::options::parse;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::text::numbers::{count, plural};
use report::TilesFigures;

/// Write a model of any size as 3D Tiles: a tree of tiles, each level within a proved error
///
/// OUT is a folder: tileset.json names the tiles in it. A run that was ended goes on where it
/// stopped.
///
/// The steps plan, task and finish do the same with any number of processes or machines.
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Tiles {
    #[command(subcommand)]
    step: Option<Step>,
    /// Mesh to read, or -
    #[arg(value_name = "IN", required = true)]
    input: Option<PathBuf>,
    /// Folder to write
    #[arg(value_name = "OUT", required = true)]
    output: Option<PathBuf>,
    #[command(flatten)]
    form: FormArgs,
    /// Memory for all threads together, such as 1G; how many work at a time follows from it
    #[arg(long, value_name = "BYTES", value_parser = parse::bytes)]
    memory: Option<usize>,
    #[command(flatten)]
    reading: ReadArgs,
}

/// Step of making tiles.
#[derive(Subcommand)]
enum Step {
    /// Cut a model into the pieces of its tiles, and plan how to make them
    Plan(PlanStep),
    /// Make one tile of a plan; those that it is made from come before it
    Task(TaskStep),
    /// Make the tileset of a plan whose tasks are all done
    Finish(FinishStep),
}

#[derive(Args)]
struct PlanStep {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// Folder for the plan and all that is made by it
    #[arg(value_name = "PLAN")]
    plan: PathBuf,
    #[command(flatten)]
    form: FormArgs,
    #[command(flatten)]
    reading: ReadArgs,
}

#[derive(Args)]
struct TaskStep {
    /// Folder of the plan
    #[arg(value_name = "PLAN")]
    plan: PathBuf,
    /// Number of the task, from 0 on
    #[arg(value_name = "N", value_parser = parse::whole, allow_negative_numbers = true)]
    task: usize,
}

#[derive(Args)]
struct FinishStep {
    /// Folder of the plan
    #[arg(value_name = "PLAN")]
    plan: PathBuf,
    /// Folder to write
    #[arg(value_name = "OUT")]
    output: PathBuf,
}

/// Form of the tiles.
#[derive(Args)]
struct FormArgs {
    /// Number of faces from which a part of the model is divided
    #[arg(long, value_name = "N", default_value = "50000", value_parser = parse::positive,
        allow_negative_numbers = true)]
    tile_faces: usize,
    /// Leave out the compression by meshopt
    #[arg(long)]
    plain: bool,
    /// Leave out the skirts, which hide gaps between tiles of different levels
    #[arg(long)]
    no_skirts: bool,
    /// Axis of the model that points up
    #[arg(long, value_name = "AXIS", default_value = "y")]
    up: UpArg,
    /// Latitude of the model's origin, in degrees north
    #[arg(long, value_name = "DEGREES", requires = "lon", allow_negative_numbers = true)]
    lat: Option<f64>,
    /// Longitude of the model's origin, in degrees east
    #[arg(long, value_name = "DEGREES", requires = "lat", allow_negative_numbers = true)]
    lon: Option<f64>,
    /// Height of the model's origin above the ellipsoid, in metres
    #[arg(
        long,
        value_name = "METRES",
        requires = "lat",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    alt: f64,
}

#[derive(Clone, Copy, ValueEnum)]
enum UpArg {
    /// As in glTF
    Y,
    /// As in most scans and maps
    Z,
}

impl FormArgs {
    fn request(&self, memory: Option<usize>) -> TilesRequest {
        let globe = self.lat.zip(self.lon).map(|(latitude, longitude)| Globe {
            latitude,
            longitude,
            altitude: self.alt,
        });
        TilesRequest {
            tile_faces: self.tile_faces,
            plain: self.plain,
            skirts: !self.no_skirts,
            up: match self.up {
                UpArg::Y => Up::Y,
                UpArg::Z => Up::Z,
            },
            globe,
            memory,
        }
    }
}

impl Tiles {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        match self.step {
            Some(Step::Plan(step)) => step.run(session),
            Some(Step::Task(step)) => step.run(session),
            Some(Step::Finish(step)) => step.run(session),
            None => self.whole(session),
        }
    }

    fn whole(self, session: &Session) -> Result<Answer, Failure> {
        let (Some(input), Some(output)) = (&self.input, &self.output) else {
            return Err(Failure::usage("name a mesh to read and a folder to write"));
        };
        check_folder(output)?;
        let request = self.form.request(self.memory);
        let model = Model::read(input, &self.reading, session)?;
        let hearing = Hearing::new(session, input, output);
        let done = tiles(model.input(), output, &request, &hearing);
        let report = done.map_err(|error| hearing.failure(error))?;
        let text = report::text(output, &report);
        Ok(Answer::new(TilesFigures::new(output, report), text))
    }
}

impl PlanStep {
    fn run(self, session: &Session) -> Result<Answer, Failure> {
        let request = self.form.request(None);
        let model = Model::read(&self.input, &self.reading, session)?;
        let hearing = Hearing::new(session, &self.input, &self.plan);
        let done = plan_tiles(model.input(), &self.plan, &request, &hearing);
        let tasks = done.map_err(|error| hearing.failure(error))?;
        let plan = files::name(&self.plan);
        let last = tasks - 1;
        let text = format!("{plan}: {} task{}, 0 to {last}\n", count(tasks), plural(tasks));
        Ok(Answer::new(json!({ "plan": plan, "tasks": tasks }), text))
    }
}

impl TaskStep {
    fn run(self, session: &Session) -> Result<Answer, Failure> {
        let hearing = Hearing::new(session, &self.plan, &self.plan);
        run_tile_task(&self.plan, self.task).map_err(|error| hearing.failure(error))?;
        let plan = files::name(&self.plan);
        let text = format!("{plan}: task {} done\n", self.task);
        Ok(Answer::new(json!({ "plan": plan, "task": self.task }), text))
    }
}

impl FinishStep {
    fn run(self, session: &Session) -> Result<Answer, Failure> {
        check_folder(&self.output)?;
        let hearing = Hearing::new(session, &self.plan, &self.output);
        let done = finish_tiles(&self.plan, &self.output, &hearing);
        let report = done.map_err(|error| hearing.failure(error))?;
        let text = report::text(&self.output, &report);
        Ok(Answer::new(TilesFigures::new(&self.output, report), text))
    }
}

/// Model that was read for tiles.
struct Model {
    source: SceneSource,
    look: Look,
    key: String,
}

impl Model {
    fn read(path: &Path, reading: &ReadArgs, session: &Session) -> Result<Self, Failure> {
        let scene = files::read_surface(path, reading, session)?;
        let look = look(&scene);
        let key = key(path);
        Ok(Self { source: SceneSource::new(scene), look, key })
    }

    fn input(&self) -> TileInput<'_> {
        TileInput { source: &self.source, look: &self.look, key: &self.key }
    }
}

/// Returns the materials of a scene by the labels that its faces have when it is one mesh.
fn look(scene: &Scene) -> Look {
    if scene.materials.is_empty() {
        return Look::default();
    }
    let mut materials = scene.materials.clone();
    // Faces without a material have the last label.
    materials.push(meshlod::io::Material::default());
    let labels = materials.iter().map(|material| material.name.clone()).collect();
    Look { labels, materials, images: scene.images.clone(), ..Look::default() }
}

/// Returns a text that is different for another file, and mostly for another content.
fn key(path: &Path) -> String {
    let facts = std::fs::metadata(path).ok();
    let changed = facts.as_ref().and_then(|facts| facts.modified().ok());
    let seconds = changed.and_then(|at| at.duration_since(std::time::UNIX_EPOCH).ok());
    format!(
        "{} {} {}",
        std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).display(),
        facts.map_or(0, |facts| facts.len()),
        seconds.map_or(0, |since| since.as_nanos()),
    )
}

/// Fails if a folder holds anything that is not a tileset, before any work is done.
fn check_folder(path: &Path) -> Result<(), Failure> {
    if files::is_pipe(path) {
        return Err(Failure::usage("-: tiles cannot go to standard output; name a folder"));
    }
    if path.exists() && !path.is_dir() {
        return Err(Failure::at(path, "is a file; name a folder for the tiles"));
    }
    let Ok(mut entries) = std::fs::read_dir(path) else { return Ok(()) };
    let is_ours = ["tileset.json", ".plan"].iter().any(|name| path.join(name).exists());
    match entries.next().is_none() || is_ours {
        true => Ok(()),
        false => Err(Failure::at(path, "holds other files; name a new folder for the tiles")),
    }
}
