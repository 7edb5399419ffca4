//! `measure`: measures the distance between two meshes and the change of area and volume.

use std::path::PathBuf;

use clap::Args;
use meshlod::jobs::{self, FarthestPose, MeasureReport, MeasureRequest};
use meshlod::measure::DistanceOptions;

use crate::options::args::{ReadArgs, SamplingArgs};
use crate::options::parse;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::text::distance;
use crate::text::numbers::{change, count, plural, value};
use crate::text::table::aligned;

/// Measure the distance between two meshes, both ways
#[derive(Args)]
pub struct Measure {
    /// The original: forward distances start on it, and percentages refer to its diagonal
    #[arg(value_name = "A")]
    a: PathBuf,
    /// The mesh to compare with it
    #[arg(value_name = "B")]
    b: PathBuf,
    /// Also prove the maximum distance, to within 1%
    ///
    /// It is enclosed between a lower and an upper bound by dividing faces until none can reach
    /// farther: a proof, where samples may miss a peak.
    #[arg(long)]
    certified: bool,
    /// Measure in N poses of the animations of A
    ///
    /// At key times and, if N is large enough, between them; reports the pose in which the two are
    /// farthest apart. B must be a level of A.
    #[arg(long, value_name = "N", value_parser = parse::positive, allow_negative_numbers = true)]
    poses: Option<usize>,
    #[command(flatten)]
    sampling: SamplingArgs,
    #[command(flatten)]
    reading: ReadArgs,
}

impl Measure {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        if files::is_pipe(&self.a) && files::is_pipe(&self.b) {
            return Err(Failure::usage("-: only one of the two meshes can be standard input"));
        }
        let [a, b] = [&self.a, &self.b].map(|path| files::read(path, &self.reading, session));
        let (a, b) = (a?, b?);
        let hearing = Hearing::of_two(session, &self.a, &self.b);
        let done = jobs::measure(&a, &b, &self.request(), &hearing);
        let report = done.map_err(|error| hearing.failure(error))?;
        let text = text(&report);
        Ok(Answer::new(report, text))
    }

    fn request(&self) -> MeasureRequest {
        let DistanceOptions { samples, seed } = self.sampling.options();
        MeasureRequest { samples, seed, certified: self.certified, poses: self.poses }
    }
}

fn text(report: &MeasureReport) -> String {
    let row = |name: &str, [a, b]: [f64; 2]| [name.into(), value(a), value(b), change(a, b)];
    format!(
        "{}{}{}diagonal {}\n\n{}{}",
        report.pose.as_ref().map(pose).unwrap_or_default(),
        distance::to_table(&report.distance),
        report.certified.as_ref().map(distance::certified_table).unwrap_or_default(),
        value(report.distance.diagonal),
        aligned(&[
            ["", "A", "B", "change"].map(String::from),
            row("area", [report.area_a, report.area_b]),
            row("volume", [report.volume_a, report.volume_b]),
        ]),
        open_note([report.closed_a, report.closed_b]),
    )
}

fn pose(pose: &FarthestPose) -> String {
    let FarthestPose { measured, animation, seconds } = *pose;
    format!(
        "the farthest of {} pose{}: animation {animation} at {} s\n\n",
        count(measured),
        plural(measured),
        value(seconds),
    )
}

/// Returns a line that names the meshes that are not closed.
fn open_note(closed: [bool; 2]) -> &'static str {
    match closed {
        [true, true] => "",
        [false, true] => "A is open: its volume is not that of a closed surface\n",
        [true, false] => "B is open: its volume is not that of a closed surface\n",
        [false, false] => "both are open: the volumes are not those of closed surfaces\n",
    }
}
