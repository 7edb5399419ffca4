//! `repair`: repairs the defects that can be repaired safely.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use meshlod::check::{
    CheckOptions, HoleLimits, Kinds, RepairOptions, RepairReport, RepairStep, Stitch, Summary,
    check,
};
use meshlod::scene::repair_scene;
use meshlod::{Format, Scene};
use serde::Serialize;

use crate::options::args::{ReadArgs, WriteArgs};
use crate::options::fuse::{self, FuseArgs, FuseReport};
use crate::options::parse;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;
use crate::text::numbers::{count, faces, plural, value};
use crate::text::table::aligned;

/// Repair the defects that can be repaired safely, and report every step.
///
/// The steps, in order: drop invalid data; --weld; drop duplicate faces; drop faces without area;
/// split non-manifold edges and vertices; orient faces consistently; stitch borders; close --holes;
/// turn closed shells outwards; drop unused vertices. Then --fuse, followed by the same steps once
/// more. At the end OUT is read back, and the errors that check still finds in it are reported.
#[derive(Args)]
pub struct Repair {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    steps: StepArgs,
    #[command(flatten)]
    fuse: FuseArgs,
    #[command(flatten)]
    reading: ReadArgs,
    #[command(flatten)]
    writing: WriteArgs,
}

/// Options that add or skip repair steps.
#[derive(Args)]
#[command(next_help_heading = "Steps")]
struct StepArgs {
    /// Stitch borders that lie within EPS of each other, in model units
    #[arg(long, value_name = "EPS", default_value_t = 0.0, value_parser = parse::length,
        allow_negative_numbers = true)]
    stitch: f64,
    /// Close holes of up to N edges, at most 256
    ///
    /// If too many are large, the smallest are closed first; run again to go on.
    #[arg(long, value_name = "N", value_parser = parse::whole, allow_negative_numbers = true)]
    holes: Option<usize>,
    /// Close only holes whose perimeter is at most LENGTH, in model units
    #[arg(long, value_name = "LENGTH", value_parser = parse::length, requires = "holes",
        allow_negative_numbers = true)]
    hole_length: Option<f64>,
    /// Keep duplicate faces
    #[arg(long)]
    no_duplicates: bool,
    /// Keep faces without area
    #[arg(long)]
    no_degenerate: bool,
    /// Do not split non-manifold edges and vertices
    #[arg(long)]
    no_split: bool,
    /// Do not flip faces
    #[arg(long)]
    no_orient: bool,
    /// Do not stitch borders
    #[arg(long, conflicts_with = "stitch")]
    no_stitch: bool,
    /// Keep unused vertices
    #[arg(long)]
    no_unused: bool,
}

impl StepArgs {
    fn options(&self, weld: Option<f64>) -> RepairOptions {
        let length = self.hole_length;
        RepairOptions {
            weld,
            duplicates: !self.no_duplicates,
            degenerate: !self.no_degenerate,
            split: !self.no_split,
            stitch: if self.no_stitch { Stitch::Off } else { Stitch::Within(self.stitch) },
            orient: !self.no_orient,
            holes: self.holes.map(|edges| HoleLimits { edges, length }),
            unused: !self.no_unused,
        }
    }
}

impl Repair {
    pub fn run(mut self, session: &Session) -> Result<Answer, Failure> {
        let format = files::check_output(&self.output, session)?;
        let options = self.steps.options(self.reading.take_weld());
        let mut scene = files::read(&self.input, &self.reading, session)?;
        let before = MeshSize::of(&scene);
        session.progress.stage("repairing");
        let start = Instant::now();
        let mut report = repair_scene(&mut scene, &options);
        let fused = self.fuse.apply(&mut scene, session);
        if fused.is_some() {
            // Where cuts are close together, rounding leaves faces without area.
            report = report.then(&repair_scene(&mut scene, &options));
        }
        let time = start.elapsed();
        let after = MeshSize::of(&scene);
        if after.faces == 0 {
            return Err(Failure::at(&self.input, "no face with an area is left"));
        }
        // Rounding could undo repairs.
        self.writing = self.writing.within(0.0, &scene, format);
        scene_files::write(&self.output, &scene, &self.writing, session)?;
        let left = errors(scene_files::read_again(&self.output, &scene, &self.writing, session)?);
        let done = Repaired { report, fused, left, before, after, time };
        self.warn(format, &done, session);
        Ok(Answer {
            file_on_stdout: files::is_pipe(&self.output),
            ..Answer::new(self.figures(&done), self.text(&done))
        })
    }

    /// Warns of defects that are left.
    fn warn(&self, format: Format, done: &Repaired, session: &Session) {
        let shells = done.report.count(RepairStep::NotOrientable);
        if shells > 0 {
            let reason = format!(
                "{} one-sided shell{} left unchanged: cut open, they could be oriented",
                count(shells),
                plural(shells)
            );
            session.warn(Failure::at(&self.input, reason));
        }
        let untried = done.report.count(RepairStep::HolesUntried);
        if untried > 0 {
            let reason =
                format!("too many large holes for one run; run again to close the other {untried}");
            session.warn(Failure::at(&self.input, reason));
        }
        if done.left.total() > 0 {
            let joins = format.is_welded() && done.report.count(RepairStep::SplitVertices) > 0;
            let how = match joins {
                true => "reading this format without --no-weld joins what was split".into(),
                false => format!("check {} lists them", files::name(&self.output)),
            };
            let (errors, s) = (count(done.left.total()), plural(done.left.total()));
            let reason = format!("has {errors} error{s} when it is read back; {how}");
            session.warn(Failure::at(&self.output, reason));
        }
    }

    fn figures<'d>(&self, done: &'d Repaired) -> RepairFigures<'d> {
        let Repaired { report, fused, left, before, after, time } = done;
        RepairFigures {
            file: files::name(&self.output),
            changed: !report.is_unchanged() || fused.as_ref().is_some_and(|fused| fused.is_change),
            input_faces: before.faces,
            input_vertices: before.vertices,
            output_faces: after.faces,
            output_vertices: after.vertices,
            steps: report,
            fused: *fused,
            errors_left: left.total(),
            errors_left_by_kind: left,
            repair_seconds: time.as_secs_f64(),
        }
    }

    fn text(&self, done: &Repaired) -> String {
        let Repaired { report, fused, left, before, after, time } = done;
        let steps: Vec<[String; 2]> = report
            .nonzero()
            .map(|(step, number)| [format!("  {}", step.name()), count(number)])
            .collect();
        let nothing = match (report.is_unchanged(), left.total()) {
            (false, _) => "",
            (true, 0) => "  nothing to repair\n",
            (true, _) => "  nothing repaired\n",
        };
        let left: Vec<[String; 2]> = left
            .found()
            .map(|(kind, number)| [format!("  left: {}", kind.name()), count(number)])
            .collect();
        format!(
            "{}: {} to {}, {} vertices to {}\n{nothing}{}{}{}repair_seconds: {}\n",
            files::name(&self.output),
            faces(before.faces),
            count(after.faces),
            count(before.vertices),
            count(after.vertices),
            aligned(&steps),
            fuse::to_text(fused.as_ref()),
            aligned(&left),
            value(time.as_secs_f64()),
        )
    }
}

/// Figures of a repair for programs.
#[derive(Serialize)]
struct RepairFigures<'d> {
    file: String,
    changed: bool,
    input_faces: usize,
    input_vertices: usize,
    output_faces: usize,
    output_vertices: usize,
    steps: &'d RepairReport,
    fused: Option<FuseReport>,
    errors_left: usize,
    errors_left_by_kind: &'d Summary,
    repair_seconds: f64,
}

/// Counts the errors of a scene.
fn errors(scene: Scene) -> Summary {
    let options = CheckOptions { kinds: Kinds::errors(), ..CheckOptions::default() };
    let mut errors = Summary::default();
    let _ = check(&scene.into_mesh(), &options, &mut |finding| {
        errors.add(finding);
        ControlFlow::Continue(())
    });
    errors
}

struct Repaired {
    report: RepairReport,
    fused: Option<FuseReport>,
    /// Errors in the file that was written.
    left: Summary,
    before: MeshSize,
    after: MeshSize,
    time: Duration,
}

/// Total size of all meshes.
struct MeshSize {
    vertices: usize,
    faces: usize,
}

impl MeshSize {
    fn of(scene: &Scene) -> Self {
        let meshes = || scene.meshes.iter().map(|mesh| &mesh.mesh);
        Self {
            vertices: meshes().map(|mesh| mesh.positions.len()).sum(),
            faces: meshes().map(|mesh| mesh.faces.len()).sum(),
        }
    }
}
