//! `simplify`: reduces a mesh to fewer faces.

mod report;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use meshlod::measure::DistanceOptions;
use meshlod::simplify::AttributeWeights;
use meshlod::{
    Format, Mesh, Method, Options, Report, Scene, Target, digits_of, moved_at_most, world_bounds,
};

use crate::options::args::{ReadArgs, WriteArgs};
use crate::options::constraints::ConstraintArgs;
use crate::options::locks::InputScene;
use crate::options::parse::{self, Bound};
use crate::options::topology;
use crate::options::volume::ExactVolumeArgs;
use crate::sequence;
use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;
use crate::simplify_run::{self, ReadyScene, Simplified, SimplifyRun};
use crate::text::distance;
use crate::text::error_bound::{AskedError, ProvedError};
use crate::text::simplify_report;

/// Reduce a mesh to fewer faces
#[derive(Args)]
pub struct Simplify {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Measure the result, as is always done with --error
    #[arg(long)]
    measured: bool,
    /// Record all levels on the way in FILE, for the verb replay, which needs --scene IN to restore
    /// nodes and materials; the input must hold exactly one mesh
    #[arg(long, value_name = "FILE",
        conflicts_with_all = ["measured", "fuse", "exact_volume"])]
    sequence: Option<PathBuf>,
    #[command(flatten)]
    target: TargetArgs,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    volume: ExactVolumeArgs,
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
    /// Target number of faces
    #[arg(short, long, value_name = "N", value_parser = parse::whole,
        allow_negative_numbers = true)]
    faces: Option<usize>,
    /// Target ratio of the faces: 10% or 0.1
    #[arg(short, long, value_name = "RATIO", value_parser = parse::ratio,
        allow_hyphen_values = true)]
    ratio: Option<f64>,
    /// Largest distance from the input: 0.5 in model units, or 0.1% of the diagonal. It is proved
    /// for every point of both surfaces, as written, and what is farther away is mended; methods
    /// other than lindstrom-turk and qem start again with a lower bound for that
    #[arg(short, long, value_name = "BOUND", value_parser = parse::bound,
        allow_hyphen_values = true)]
    error: Option<Bound>,
}

/// Method and its options.
#[derive(Args)]
#[command(next_help_heading = "Method")]
pub struct MethodArgs {
    #[arg(long, value_name = "NAME", default_value = Method::default().name(),
        help = parse::methods())]
    method: Method,
    /// Cost weight of boundaries, where 0 means none [default: 9 for lindstrom-turk, 2 for qem]
    #[arg(long, value_name = "WEIGHT", value_parser = parse::weight, allow_negative_numbers = true)]
    boundary: Option<f64>,
    #[command(flatten)]
    pub constraints: ConstraintArgs,
    #[command(flatten)]
    weights: WeightArgs,
}

const WEIGHTS: AttributeWeights = AttributeWeights::DEFAULT;

/// Weights of attributes in the cost of a contraction.
#[derive(Args)]
#[command(next_help_heading = "Attributes")]
struct WeightArgs {
    /// Weight of normals: a deviation of 1 counts like this fraction of the diagonal, where 0 means
    /// not at all; for lindstrom-turk, qem and qem-endpoint
    #[arg(long, value_name = "W", default_value_t = WEIGHTS.normal, value_parser = parse::weight,
        allow_negative_numbers = true)]
    weight_normal: f64,
    /// Weight of texture coordinates: a texture that slides by a length counts like this fraction
    /// of it, where 0 means not at all; for lindstrom-turk, qem and qem-endpoint
    #[arg(long, value_name = "W", default_value_t = WEIGHTS.uv, value_parser = parse::weight,
        allow_negative_numbers = true)]
    weight_uv: f64,
    /// Weight of colours: a deviation of 1 counts like this fraction of the diagonal, where 0 means
    /// not at all; for lindstrom-turk, qem and qem-endpoint
    #[arg(long, value_name = "W", default_value_t = WEIGHTS.color, value_parser = parse::weight,
        allow_negative_numbers = true)]
    weight_color: f64,
}

impl MethodArgs {
    /// Builds the simplification options for a scene from the arguments.
    pub fn options(&self, input: &InputScene<'_>, session: &Session) -> Result<Options, Failure> {
        let options = Options {
            method: self.method,
            weights: self.weights(),
            boundary_weight: self.boundary,
            ..Options::default()
        };
        self.constraints.apply(options, input, session)
    }

    fn weights(&self) -> AttributeWeights {
        let WeightArgs { weight_normal, weight_uv, weight_color } = self.weights;
        AttributeWeights { normal: weight_normal, uv: weight_uv, color: weight_color }
    }

    /// Warns about options that the method ignores, and about borders that lie near each other.
    pub fn warn(&self, report: &Report, ready: &ReadyScene<'_>, session: &Session) {
        topology::warn(&ready.scene, session);
        if self.weights() != WEIGHTS && !report.method.counts_attributes() {
            let method = report.method.name();
            session.warn(format_args!(
                "--weight-…: {method} ignores attributes; use lindstrom-turk, qem or qem-endpoint"
            ));
        }
        if self.boundary.is_some() && !report.method.weighs_boundaries() {
            let method = report.method.name();
            session.warn(format_args!(
                "--boundary: {method} has no boundary weight; use lindstrom-turk or qem"
            ));
        }
    }
}

impl TargetArgs {
    /// Returns the target, with an error in world units.
    fn target(&self, scene: &Scene) -> Target {
        match (self.faces, self.ratio, self.error) {
            (Some(faces), ..) => Target::Faces(faces),
            (_, Some(ratio), _) => Target::Ratio(ratio),
            (_, _, bound) => {
                let bound = bound.unwrap_or(Bound::Length(0.0));
                Target::Error(bound.length(world_bounds(scene).diagonal()))
            }
        }
    }
}

/// Scene with its target and options.
struct Task<'s> {
    scene: &'s Scene,
    ready: ReadyScene<'s>,
    target: Target,
    /// The error that was asked for, if the target is one.
    asked: Option<AskedError>,
    options: Options,
}

impl Simplify {
    pub fn run(mut self, session: &Session) -> Result<Answer, Failure> {
        let format = files::check_output(&self.output, session)?;
        if let Some(path) = &self.sequence {
            let reason = "--sequence records a run with --topology keep";
            self.method.constraints.topology.keep(reason)?;
            sequence::check(path, &self.input, &self.output)?;
        }
        let mut scene = files::read_surface(&self.input, &self.reading, session)?;
        if let Some(path) = &self.sequence {
            sequence::check_scene(path, &scene, &self.input, session)?;
        }
        let fused = self.method.constraints.fuse.apply(&mut scene, session);
        let target = self.target.target(&scene);
        let target = fused.as_ref().map_or(target, |fused| fused.target(target));
        let asked = self.asked(target, &scene, format);
        let target = asked.map_or(target, |asked| asked.target());
        let input = InputScene { scene: &scene, path: &self.input, reading: &self.reading };
        let options = self.method.options(&input, session)?;
        let borders = self.method.constraints.topology.borders();
        let ready = ReadyScene::new(&scene, &options, borders, &self.input, session)?;
        let task = Task { scene: &scene, ready, target, asked, options };
        let (mut done, mut time) = self.plain_run(&task, session)?;
        let before = self.volume.exact_volume.then(|| done.meshes.clone());
        let start = Instant::now();
        if self.volume.exact_volume {
            // The digits to which the volume is exact are those that are written.
            self.writing = self.writing.of(&scene);
        }
        let digits = digits_of(format, self.writing.options().precision);
        let residual = self.volume.restore(&task.ready.scene, &mut done.meshes, digits, session);
        time += start.elapsed();
        let moved = |before: Vec<Mesh>| moved_at_most(&scene, &before, &done.meshes);
        let moved = before.map_or(0.0, moved);
        let kept = self.measure(&task, &mut done, moved, session)?;
        self.method.warn(&done.report, &task.ready, session);
        if let Some(kept) = kept.filter(|kept| !kept.is_held()) {
            done.report.reached = false;
            session.miss(&Failure::at(&self.input, kept.warning()));
        } else if !done.report.reached {
            let reason = simplify_report::why_not_reached(&done.report, task.options.topology);
            session.miss(&Failure::at(&self.input, reason));
        }
        let outcome = Outcome::Missed.when(session.strict && !done.report.reached);
        let run = report::FinishedRun { task: &task, done: &done, fused, kept, residual, time };
        let answer = Answer::new(self.figures(&run), self.text(&run));
        simplify_run::replace(&mut scene, std::mem::take(&mut done.meshes));
        let write = || scene_files::write(&self.output, &scene, &self.writing, session);
        match (&self.sequence, &done.sequence) {
            (Some(path), Some(sequence)) => sequence::write_with(path, sequence, write)?,
            _ => write()?,
        }
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), outcome, ..answer })
    }

    fn plain_run(
        &self,
        task: &Task<'_>,
        session: &Session,
    ) -> Result<(Simplified, Duration), Failure> {
        let mut run = SimplifyRun::start(&task.ready, session)?;
        if self.sequence.is_some() {
            run.record();
        }
        let mut report = run.simplify_to(task.target)?;
        let time = run.time();
        let (meshes, sequence) = match self.sequence {
            Some(_) => {
                let all = run.into_sequence();
                let all = all.ok_or_else(|| sequence::several_meshes(&self.input))?;
                // As the sequence restores it, without the repayment of volume.
                (vec![all.level()], Some(all))
            }
            None => (run.level(&mut report), None),
        };
        Ok((Simplified { meshes, report, measured: None, sequence }, time))
    }

    /// Returns the error that was asked for, if the target is one. Where 32 bits would round it
    /// away, coordinates are written with 64, unless `--precision` says otherwise.
    fn asked(&mut self, target: Target, scene: &Scene, format: Format) -> Option<AskedError> {
        let Target::Error(error) = target else { return None };
        let with = |writing: &WriteArgs| {
            let digits = digits_of(format, writing.options().precision);
            AskedError::new(error, scene, digits, self.volume.exact_volume)
        };
        if with(&self.writing.of(scene)).needs_precision() {
            self.writing = self.writing.precise();
        }
        self.writing = self.writing.of(scene);
        Some(with(&self.writing))
    }

    /// Measures the result if that was asked for. Returns what holds of an error that was asked
    /// for: by the proof of the run before vertices moved by up to `moved`, or by a measurement.
    fn measure(
        &self,
        task: &Task<'_>,
        done: &mut Simplified,
        moved: f64,
        session: &Session,
    ) -> Result<Option<ProvedError>, Failure> {
        if task.asked.is_none() && !self.measured {
            return Ok(None);
        }
        let original = distance::surface_of(task.scene, distance::meshes(task.scene));
        let surface = match distance::ready(&original, &self.input) {
            Ok(surface) => Some(surface),
            Err(failure) if self.measured => return Err(failure),
            Err(_) => None,
        };
        let original = surface.as_ref().map(|surface| (surface, DistanceOptions::default()));
        done.measured = simplify_run::measure(original, task.scene, &done.meshes, session);
        let Some(asked) = task.asked else { return Ok(None) };
        Ok(Some(match done.report.proof {
            Some(_) => asked.by_report(&done.report, moved),
            None => asked.by_measuring(surface.as_ref(), task.scene, &done.meshes),
        }))
    }
}
