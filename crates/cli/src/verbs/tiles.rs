//! `tiles`: writes a model of any size as 3D Tiles, or one of the steps of that.

mod files;
mod report;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use meshlod::io::check_place;
use meshlod::jobs::{
    Globe, PlanFolder, TilesRequest, Up, check_tiles_folder, finish_tiles, plan_tiles,
    run_tile_task, tiles,
};
use meshlod::tiles::archive::is_archive;
use serde_json::json;

use crate::options::args::ReadArgs;
use crate::options::parse;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files as session_files;
use crate::session::hearing::Hearing;
use crate::text::numbers::{count, plural};
use report::TilesFigures;

/// Write a model of any size as 3D Tiles: a tree of tiles, each level within a proved error
///
/// OUT is a folder: tileset.json names the tiles in it. If it ends in .3tz it is an archive of these
/// files. A run that was ended goes on where it stopped.
///
/// Binary PLY, binary STL, OBJ and glTF files from 64 MB on are read in passing, with little memory;
/// OBJ and compressed glTF take their room on the disk of OUT meanwhile. Of an .mlod file, the finest
/// level is read. Of several files, the layers are kept that all of them have.
///
/// The steps plan, task and finish do the same with any number of processes or machines.
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Tiles {
    #[command(subcommand)]
    step: Option<TileStep>,
    /// Meshes to read as one model, folders of them, or -
    #[arg(value_name = "IN", required = true)]
    inputs: Vec<PathBuf>,
    /// Folder to write, or archive
    #[arg(value_name = "OUT", required = true)]
    output: Option<PathBuf>,
    #[command(flatten)]
    archive: ArchiveArgs,
    #[command(flatten)]
    form: FormArgs,
    /// Memory for all threads together, such as 1G; how many work at a time follows from it
    #[arg(long, value_name = "BYTES", value_parser = parse::bytes)]
    memory: Option<usize>,
    #[command(flatten)]
    reading: ReadArgs,
}

/// A step of making tiles.
#[derive(Subcommand)]
enum TileStep {
    /// Cut a model into the pieces of its tiles, and plan how to make them
    Plan(PlanStep),
    /// Make one tile of a plan; those that it is made from come before it
    Task(TaskStep),
    /// Make the tileset of a plan whose tasks are all done
    Finish(FinishStep),
}

#[derive(Args)]
struct PlanStep {
    /// Meshes to read as one model, folders of them, or -
    #[arg(value_name = "IN", required = true)]
    inputs: Vec<PathBuf>,
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
    /// Folder to write, or archive
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    archive: ArchiveArgs,
}

/// Choice of an archive.
#[derive(Args)]
struct ArchiveArgs {
    /// Write one file, an archive of the tileset: OUT, whose name gets .3tz unless it has it
    #[arg(long)]
    zip: bool,
}

impl ArchiveArgs {
    /// Returns the path of the output.
    fn output(&self, path: &Path) -> Result<PathBuf, Failure> {
        if session_files::is_pipe(path) {
            return Err(Failure::usage("-: tiles cannot go to standard output; name a folder"));
        }
        let mut path: PathBuf = path.components().collect();
        if self.zip && !is_archive(&path) {
            path.as_mut_os_string().push(".3tz");
        }
        Ok(path)
    }
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
    /// Coordinates of the model are about the middle of the earth, in metres (EPSG:4978)
    #[arg(long, conflicts_with_all = ["lat", "lon", "alt", "up"])]
    ecef: bool,
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
            ecef: self.ecef,
            memory,
        }
    }
}

impl Tiles {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        match self.step {
            Some(TileStep::Plan(step)) => step.run(session),
            Some(TileStep::Task(step)) => step.run(session),
            Some(TileStep::Finish(step)) => step.run(session),
            None => self.whole(session),
        }
    }

    fn whole(self, session: &Session) -> Result<Answer, Failure> {
        let ([input, ..], Some(output)) = (&self.inputs[..], &self.output) else {
            return Err(Failure::usage("name a mesh to read and a folder to write"));
        };
        let output = &self.archive.output(output)?;
        let hearing = Hearing::new(session, input, output);
        check_output(output, &hearing)?;
        let request = self.form.request(self.memory);
        let model = files::open(&self.inputs, output, &self.reading, session)?;
        let done = tiles(model.input(), output, &request, &hearing);
        let report = done.map_err(|error| hearing.failure(error))?;
        let text = report::text(output, &report);
        Ok(Answer::new(TilesFigures::new(output, report), text))
    }
}

impl PlanStep {
    fn run(self, session: &Session) -> Result<Answer, Failure> {
        let request = self.form.request(None);
        let model = files::open(&self.inputs, &self.plan, &self.reading, session)?;
        let hearing = Hearing::new(session, &self.inputs[0], &self.plan);
        let place = PlanFolder::new(&self.plan);
        let done = plan_tiles(model.input(), place, &request, &hearing);
        let tasks = done.map_err(|error| hearing.failure(error))?;
        let plan = session_files::name(&self.plan);
        let last = tasks - 1;
        let text = format!("{plan}: {} task{}, 0 to {last}\n", count(tasks), plural(tasks));
        Ok(Answer::new(json!({ "plan": plan, "tasks": tasks }), text))
    }
}

impl TaskStep {
    fn run(self, session: &Session) -> Result<Answer, Failure> {
        let hearing = Hearing::new(session, &self.plan, &self.plan);
        run_tile_task(&self.plan, self.task).map_err(|error| hearing.failure(error))?;
        let plan = session_files::name(&self.plan);
        let text = format!("{plan}: task {} done\n", self.task);
        Ok(Answer::new(json!({ "plan": plan, "task": self.task }), text))
    }
}

impl FinishStep {
    fn run(self, session: &Session) -> Result<Answer, Failure> {
        let output = self.archive.output(&self.output)?;
        let hearing = Hearing::new(session, &self.plan, &output);
        check_output(&output, &hearing)?;
        let done = finish_tiles(&self.plan, &output, &hearing);
        let report = done.map_err(|error| hearing.failure(error))?;
        let text = report::text(&output, &report);
        Ok(Answer::new(TilesFigures::new(&output, report), text))
    }
}

/// Fails if tiles cannot go to a folder or file, before any work is done.
fn check_output(path: &Path, hearing: &Hearing<'_>) -> Result<(), Failure> {
    check_tiles_folder(path).map_err(|error| hearing.failure(error))?;
    match is_archive(path) {
        true => Ok(check_place(path)?),
        false => Ok(()),
    }
}
