//! `simplify`: reduces a mesh to fewer faces.

mod report;

use std::path::{Path, PathBuf};

use clap::Args;
use meshlod::jobs::{self, Aim, SimplifyReport, SimplifyRequest};
use meshlod::{Format, Scene};

use crate::options::args::{ReadArgs, WriteArgs};
use crate::options::doubt;
use crate::options::finish::FinishArgs;
use crate::options::locks::InputScene;
use crate::options::method::MethodArgs;
use crate::options::parse::{self, Bound};
use crate::options::tolerance::Tolerance;
use crate::options::topology;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::session::scene_files;
use crate::text::error_bound;
use crate::text::simplify_report;
use crate::text::stuck::Stuck;

/// Reduce a mesh to fewer faces
#[derive(Args)]
pub struct Simplify {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Measure the mean, RMS and greatest distance of the result from the input
    #[arg(long)]
    measured: bool,
    #[command(flatten)]
    target: TargetArgs,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    finish: FinishArgs,
    #[command(flatten)]
    reading: ReadArgs,
    #[command(flatten)]
    writing: WriteArgs,
}

/// Target of the simplification.
#[derive(Args)]
#[command(next_help_heading = "Target, one of")]
#[group(required = true, multiple = false)]
struct TargetArgs {
    /// Target number of faces: 5000, 5k or 1.5M
    #[arg(short, long, value_name = "N", value_parser = parse::faces,
        allow_negative_numbers = true)]
    faces: Option<usize>,
    /// Target ratio of the faces: 10% or 0.1
    #[arg(short, long, value_name = "RATIO", value_parser = parse::ratio_of_faces,
        allow_hyphen_values = true)]
    ratio: Option<f64>,
    /// Largest distance from the input: 0.1% or a length, proved
    ///
    /// A length is in model units, a percentage relative to the diagonal; 1mm is read for glTF, whose
    /// unit is the metre. The bound holds for every point of both surfaces, as written, and faces
    /// that are farther away are mended; methods other than lindstrom-turk and qem start again with
    /// a lower bound.
    #[arg(short, long, value_name = "BOUND", value_parser = Tolerance::parse,
        allow_hyphen_values = true)]
    error: Option<Tolerance>,
}

impl TargetArgs {
    fn aim(&self, input: &Path, session: &Session) -> Result<Aim, Failure> {
        Ok(match (self.faces, self.ratio, &self.error) {
            (Some(faces), ..) => Aim::Faces(faces),
            (_, Some(ratio), _) => Aim::Ratio(ratio),
            (_, _, Some(error)) => Aim::Error(error.bound("--error", input, session)?),
            (None, None, None) => Aim::Error(Bound::Length(0.0)),
        })
    }

    /// Warns of an error that is probably meant as a percentage, or as a ratio.
    fn doubt(&self, input: &Path, scene: &Scene, session: &Session) {
        let Some(error) = &self.error else { return };
        error.doubt("--error", input, scene, session);
        if let Tolerance::Bound(bound) = error {
            session.doubt(input, doubt::of_part("--error", *bound));
        }
    }
}

impl Simplify {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        let format = files::check_output(&self.output, session)?;
        let target = self.target.aim(&self.input, session)?;
        let scene = files::read_surface(&self.input, &self.reading, session)?;
        self.target.doubt(&self.input, &scene, session);
        let request = self.request(&scene, target, format)?;
        let hearing = Hearing::new(session, &self.input, &self.output);
        let done = jobs::simplify(scene, &request, &hearing);
        let (scene, report) = done.map_err(|error| hearing.failure(error))?;
        topology::warn(report.near_borders, session);
        self.warn_if_missed(&scene, &report, &request, session);
        let answer = Answer::new(self.figures(&report), self.text(&report));
        let writing = self.writing.written_as(report.written_as);
        scene_files::write(&self.output, &scene, &writing, session)?;
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..answer })
    }

    fn request(
        &self,
        scene: &Scene,
        target: Aim,
        format: Format,
    ) -> Result<SimplifyRequest, Failure> {
        let input = InputScene { scene, path: &self.input, reading: &self.reading };
        Ok(SimplifyRequest {
            target,
            method: self.method.method,
            weights: self.method.weights(),
            boundary: self.method.boundary,
            polish: self.finish.polish,
            constraints: self.method.constraints.constraints(&input)?,
            exact_volume: self.finish.exact_volume,
            measured: self.measured,
            near_borders: true,
            written_as: Some(self.writing.in_format(format)),
        })
    }

    /// Says why the target was missed, if it was.
    fn warn_if_missed(
        &self,
        scene: &Scene,
        report: &SimplifyReport,
        request: &SimplifyRequest,
        session: &Session,
    ) {
        let missed = report.error.as_ref().filter(|error| !error.is_held);
        let reason = match missed {
            Some(error) => error_bound::warning(error),
            None if report.run.reached => return,
            None => {
                let stuck = Stuck::of(scene, scene.meshes.iter().map(|mesh| &mesh.mesh));
                simplify_report::why_not_reached(&report.run, request.constraints.topology, stuck)
            }
        };
        session.miss(&Failure::at(&self.input, reason));
    }
}
