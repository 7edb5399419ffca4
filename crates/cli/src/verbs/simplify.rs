//! `simplify`: one coarser mesh.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use meshlod::simplify::{AttributeWeights, Digits};
use meshlod::{
    Mesh, Method, Options, Report, Scene, Target, conserve_volumes, digits_of, world_bounds,
};
use serde_json::{Value, json};

use crate::amounts::{self, Bound};
use crate::answer::Answer;
use crate::args::{Reading, Writing};
use crate::distance;
use crate::failure::Failure;
use crate::files;
use crate::fusing::{self, Fusing};
use crate::holding::{self, Holding, Origin};
use crate::numbers::{count, faces, percent, value};
use crate::reduce::{self, Engine, Reduced};
use crate::sequence;
use crate::session::Session;
use crate::volume;
use crate::within::Search;

#[derive(Args)]
pub struct Simplify {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    goal: Goal,
    #[command(flatten)]
    manner: Manner,
    /// Measure the result; with --error, find the coarsest level whose measured maximum is within the
    /// bound
    #[arg(long)]
    measured: bool,
    /// Record all levels on the way in FILE, for the verb replay, which needs --scene IN to restore
    /// nodes and materials; the input must hold exactly one mesh
    #[arg(long, value_name = "FILE", conflicts_with_all = ["measured", "fuse"])]
    sequence: Option<PathBuf>,
    /// Adjust the last digits of vertices until every closed mesh has its original volume in the
    /// precision that is written
    #[arg(long, conflicts_with = "sequence")]
    exact_volume: bool,
    /// Exit with 1 if the target is out of reach
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    writing: Writing,
}

/// How far to go.
#[derive(Args)]
#[group(required = true, multiple = false)]
struct Goal {
    /// Target number of faces
    #[arg(long, value_name = "N", value_parser = amounts::whole, allow_negative_numbers = true)]
    faces: Option<usize>,
    /// Target ratio of the faces: 10% or 0.1
    #[arg(long, value_name = "RATIO", value_parser = amounts::ratio, allow_hyphen_values = true)]
    ratio: Option<f64>,
    /// Largest error by the method's own estimate: 0.5 in model units, or 0.1% of the diagonal
    #[arg(long, value_name = "BOUND", value_parser = amounts::bound, allow_hyphen_values = true)]
    error: Option<Bound>,
}

/// How contractions are done.
#[derive(Args)]
pub struct Manner {
    #[arg(long, value_name = "NAME", value_parser = amounts::method,
        help = amounts::methods_or_suited())]
    method: Option<Method>,
    #[command(flatten)]
    pub fusing: Fusing,
    #[command(flatten)]
    holding: Holding,
    /// Cost weight of boundaries, where 0 means none [default: 9 for lindstrom-turk, 2 for qem]
    #[arg(long, value_name = "WEIGHT", value_parser = amounts::weight, allow_negative_numbers = true)]
    boundary: Option<f64>,
    #[command(flatten)]
    weights: Weights,
}

const WEIGHTS: AttributeWeights = AttributeWeights::DEFAULT;

/// What attributes count, where the method counts them.
#[derive(Args)]
struct Weights {
    /// Weight of normals: a deviation of 1 counts like this fraction of the diagonal, where 0 means
    /// not at all; for lindstrom-turk, qem and qem-endpoint
    #[arg(long, value_name = "W", default_value_t = WEIGHTS.normal, value_parser = amounts::weight,
        allow_negative_numbers = true)]
    weight_normal: f64,
    /// Weight of texture coordinates: a texture that slides by a length counts like this fraction of
    /// it, where 0 means not at all; for lindstrom-turk, qem and qem-endpoint
    #[arg(long, value_name = "W", default_value_t = WEIGHTS.uv, value_parser = amounts::weight,
        allow_negative_numbers = true)]
    weight_uv: f64,
    /// Weight of colours: a deviation of 1 counts like this fraction of the diagonal, where 0 means
    /// not at all; for lindstrom-turk, qem and qem-endpoint
    #[arg(long, value_name = "W", default_value_t = WEIGHTS.color, value_parser = amounts::weight,
        allow_negative_numbers = true)]
    weight_color: f64,
}

impl Manner {
    /// The options for a scene.
    pub fn options(&self, origin: &Origin<'_>, session: &Session) -> Result<Options, Failure> {
        let options = Options {
            method: self.method,
            weights: self.weights(),
            boundary_weight: self.boundary,
            ..Options::default()
        };
        self.holding.hold(options, origin, session)
    }

    fn weights(&self) -> AttributeWeights {
        let Weights { weight_normal, weight_uv, weight_color } = self.weights;
        AttributeWeights { normal: weight_normal, uv: weight_uv, color: weight_color }
    }

    /// Says which of the options have no part in what the method does.
    pub fn warn(&self, report: &Report, session: &Session) {
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

impl Goal {
    /// The target, with an error in world units.
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

/// What is to be done.
struct Task<'s> {
    scene: &'s Scene,
    target: Target,
    options: Options,
}

impl Simplify {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        let format = files::check_output(&self.output, session)?;
        if let Some(path) = &self.sequence {
            sequence::check(path, &self.input, &self.output)?;
        }
        let mut scene = files::read(&self.input, &self.reading, session)?;
        if self.sequence.is_some() {
            sequence::check_scene(&scene, &self.input, session)?;
        }
        let fused = self.manner.fusing.apply(&mut scene, session);
        let target = self.goal.target(&scene);
        let target = fused.as_ref().map_or(target, |fused| fused.target(target));
        let origin = Origin { scene: &scene, path: &self.input, reading: &self.reading };
        let options = self.manner.options(&origin, session)?;
        let task = Task { scene: &scene, target, options };
        let (mut done, mut time) = match target {
            Target::Error(_) => self.measured_run(&task, session)?,
            _ if self.measured => self.measured_run(&task, session)?,
            _ => self.plain_run(&task, session)?,
        };
        let residual = if self.exact_volume {
            let start = Instant::now();
            let digits = digits_of(format, self.writing.options().precision);
            let residual = self.conserve(&task, &mut done.meshes, digits, session)?;
            time += start.elapsed();
            residual
        } else {
            None
        };
        reduce::replace(&mut scene, std::mem::take(&mut done.meshes));
        let write = || files::write(&self.output, &scene, &self.writing, session);
        match (&self.sequence, &done.sequence) {
            (Some(path), Some(sequence)) => sequence::write_with(path, sequence, write)?,
            _ => write()?,
        }
        self.manner.warn(&done.report, session);
        if !done.report.reached {
            let reason = Failure::at(&self.input, reduce::why_not_reached(&done.report));
            session.warn(reason);
        }
        let mut json = self.json(&done, fused.as_ref(), time);
        json["volume_residual"] = residual.into();
        let mut text = self.text(&done, fused.as_ref(), time);
        if let Some(residual) = residual {
            text += &format!("volume_residual: {residual:.1e}\n");
        }
        Ok(Answer {
            file_on_stdout: files::is_pipe(&self.output),
            missed: self.strict && !done.report.reached,
            ..Answer::new(json, text)
        })
    }

    /// Gives the levels the volumes of their meshes. How far the worst is off, in parts of its volume;
    /// `None` where none has a volume.
    fn conserve(
        &self,
        task: &Task<'_>,
        levels: &mut [Mesh],
        digits: Digits,
        session: &Session,
    ) -> Result<Option<f64>, Failure> {
        let found = conserve_volumes(task.scene, levels, digits, &task.options.locks)
            .map_err(|error| Failure::at(&self.input, error))?;
        let mut worst: Option<f64> = None;
        for (i, residual) in found.into_iter().enumerate() {
            match residual {
                Ok(residual) => worst = Some(residual.after.abs().max(worst.unwrap_or(0.0))),
                Err(error) => session.warn(format_args!("--exact-volume: mesh {i}: {error}")),
            }
        }
        Ok(worst)
    }

    fn plain_run(
        &self,
        task: &Task<'_>,
        session: &Session,
    ) -> Result<(Reduced, Duration), Failure> {
        let mut engine = Engine::start(task.scene, &task.options, &self.input, session)?;
        if self.sequence.is_some() {
            engine.record();
        }
        let report = engine.run(task.target)?;
        let (meshes, time) = (engine.level(), engine.time());
        let sequence = match self.sequence {
            Some(_) => {
                let all = engine.into_sequence();
                Some(all.ok_or_else(|| sequence::several_meshes(&self.input))?)
            }
            None => None,
        };
        Ok((Reduced { meshes, report, measured: None, sequence }, time))
    }

    /// A run that is measured, or led by what is measured.
    fn measured_run(
        &self,
        task: &Task<'_>,
        session: &Session,
    ) -> Result<(Reduced, Duration), Failure> {
        let &Task { scene, target, ref options } = task;
        let original = distance::surface_of(scene, distance::meshes(scene));
        let surface = match distance::ready(&original, &self.input) {
            Ok(surface) => Some(surface),
            Err(failure) if self.measured => return Err(failure),
            Err(_) => None,
        };
        if let (Target::Error(bound), Some(original), true) = (target, &surface, self.measured) {
            let path = &self.input;
            return Search { scene, options, original, bound, path, session }.run();
        }
        let (reduced, time) = self.plain_run(task, session)?;
        let measured = reduce::measure(surface.as_ref(), scene, &reduced.meshes, session);
        Ok((Reduced { measured, ..reduced }, time))
    }

    fn json(&self, done: &Reduced, fused: Option<&fusing::Done>, time: Duration) -> Value {
        let report = &done.report;
        let mut json = json!({ "method": report.method.name() });
        for (key, value) in reduce::report_json(report).as_object().into_iter().flatten() {
            json[key] = value.clone();
        }
        json["error_measured"] = done.measured.as_ref().map(distance::to_json).into();
        json["volume_running_sum"] = report.volume.running_sum.into();
        json["volume_not_conserved"] = volume::unconserved_json(report.method, &report.volume);
        json["simplify_seconds"] = time.as_secs_f64().into();
        json["degenerate_faces"] = report.degenerate_faces.into();
        json["duplicate_faces"] = report.duplicate_faces.into();
        json["non_manifold_vertices"] = report.non_manifold_vertices.into();
        json["fused"] = fusing::to_json(fused);
        json["held"] = holding::to_json(report);
        json["vanished"] = report.vanished.into();
        json["refusals"] = reduce::refusals_json(report);
        json["file"] = files::name(&self.output).into();
        json
    }

    fn text(&self, done: &Reduced, fused: Option<&fusing::Done>, time: Duration) -> String {
        let report = &done.report;
        let input_faces = fused.map_or(report.input_faces, |fused| fused.before);
        let part = 100.0 * report.output_faces as f64 / input_faces as f64;
        let mut text = format!(
            "{}{}: {} to {} ({})\n{}",
            fusing::to_text(fused),
            files::name(&self.output),
            faces(input_faces),
            count(report.output_faces),
            percent(part),
            reduce::oddities(report),
        );
        text += &format!("error_estimate: {}\n", value(report.error_estimate));
        if let Some(distance) = &done.measured {
            text += &format!("error_measured:\n{}", distance::to_table(distance));
        }
        if let Some(line) = volume::unconserved_text(report.method, &report.volume) {
            text += &format!("{line}\n");
        }
        text + &reduce::seconds_line(time)
    }
}
