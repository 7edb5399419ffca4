//! `repair`: repairs the defects that can be repaired safely.

mod report;

use std::path::PathBuf;

use clap::Args;
use meshlod::Format;
use meshlod::check::{HoleLimits, RepairOptions, RepairStep, Stitch};
use meshlod::jobs::{self, RepairRequest, SceneRepair};

use crate::options::args::{ReadArgs, WriteArgs};
use crate::options::doubt;
use crate::options::fuse::FuseArgs;
use crate::options::parse;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::session::scene_files;
use crate::text::numbers::{count, plural};

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
        let weld = self.reading.take_weld();
        let request = RepairRequest {
            steps: self.steps.options(weld),
            fuse: self.fuse.fuse,
            written_as: Some(self.writing.in_format(format)),
        };
        let scene = files::read(&self.input, &self.reading, session)?;
        for (option, length) in [("--weld", weld.unwrap_or(0.0)), ("--stitch", self.steps.stitch)] {
            session.doubt(&self.input, doubt::of_distance(option, length, &scene));
        }
        let hearing = Hearing::new(session, &self.input, &self.output);
        let done = jobs::repair(scene, &request, &hearing);
        let (scene, report) = done.map_err(|error| hearing.failure(error))?;
        let writing = self.writing.written_as(report.written_as);
        scene_files::write(&self.output, &scene, &writing, session)?;
        self.warn_of_errors(format, &report, session);
        let answer = Answer::new(self.figures(&report), self.text(&report));
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..answer })
    }

    /// Warns of errors that are left, and says how to see or avoid them.
    fn warn_of_errors(&self, format: Format, report: &SceneRepair, session: &Session) {
        if report.errors_left == 0 {
            return;
        }
        let joins = format.is_welded() && report.steps.count(RepairStep::SplitVertices) > 0;
        let how = match joins {
            true => "reading this format without --no-weld joins what was split".into(),
            false => format!("check {} lists them", files::name(&self.output)),
        };
        let (errors, s) = (count(report.errors_left), plural(report.errors_left));
        let reason = format!("has {errors} error{s} when it is read back; {how}");
        session.warn(Failure::at(&self.output, reason));
    }
}
