//! Report of `simplify`, as JSON and text.

use std::time::Duration;

use meshlod::Method;
use serde::Serialize;

use super::{Simplify, Task};
use crate::options::fuse::{self, FuseReport};
use crate::options::topology::{self, ConditioningFigures};
use crate::options::volume::{self, VolumeNotConserved};
use crate::session::files;
use crate::simplify_run::Simplified;
use crate::text::distance::{self, DistanceFigures};
use crate::text::error_bound::{ErrorFigures, ProvedError};
use crate::text::numbers::{count, faces, percent, value};
use crate::text::simplify_report::{self, ContractionFigures, InputFigures, RunFigures};

/// A finished run, with all that is reported of it.
pub(super) struct FinishedRun<'r> {
    pub(super) task: &'r Task<'r>,
    pub(super) done: &'r Simplified,
    pub(super) fused: Option<FuseReport>,
    /// Knowledge about the error that was asked for.
    pub(super) kept: Option<ProvedError>,
    /// Largest relative deviation from the original volumes, if they were restored.
    pub(super) residual: Option<f64>,
    pub(super) time: Duration,
}

/// Figures of a run for programs.
#[derive(Serialize)]
pub(super) struct SimplifyFigures {
    method: Method,
    input_faces: usize,
    output_faces: usize,
    reached: bool,
    error_estimate: f64,
    error_measured: Option<DistanceFigures>,
    volume_running_sum: f64,
    contractions: ContractionFigures,
    volume_not_conserved: Option<VolumeNotConserved>,
    #[serde(flatten)]
    input: InputFigures,
    #[serde(flatten)]
    conditioning: ConditioningFigures,
    fused: Option<FuseReport>,
    #[serde(flatten)]
    run: RunFigures,
    file: String,
    #[serde(flatten)]
    error: ErrorFigures,
    volume_residual: Option<f64>,
}

impl Simplify {
    pub(super) fn figures(&self, run: &FinishedRun<'_>) -> SimplifyFigures {
        let report = &run.done.report;
        SimplifyFigures {
            method: report.method,
            input_faces: report.input_faces,
            output_faces: report.output_faces,
            reached: report.reached,
            error_estimate: report.error_estimate,
            error_measured: run.done.measured.as_ref().map(DistanceFigures::from),
            volume_running_sum: report.volume.lost(),
            contractions: report.contractions.into(),
            volume_not_conserved: VolumeNotConserved::of(report.method, &report.volume),
            input: InputFigures::of(report, run.time),
            conditioning: ConditioningFigures::of(&run.task.ready.scene),
            fused: run.fused,
            run: report.into(),
            file: files::name(&self.output),
            error: ProvedError::figures(run.kept.as_ref()),
            volume_residual: run.residual,
        }
    }

    pub(super) fn text(&self, run: &FinishedRun<'_>) -> String {
        let FinishedRun { task, done, fused, kept, residual, time } = run;
        let (report, fused) = (&done.report, fused.as_ref());
        let input_faces = fused.map_or(report.input_faces, |fused| fused.input_faces);
        let part = 100.0 * report.output_faces as f64 / input_faces as f64;
        let mut text = format!(
            "{}{}: {} to {} ({})\n{}{}",
            fuse::to_text(fused),
            files::name(&self.output),
            faces(input_faces),
            count(report.output_faces),
            percent(part),
            topology::to_text(&task.ready.scene),
            simplify_report::mesh_notes(report),
        );
        text += &format!("error_estimate: {}\n", value(report.error_estimate));
        if let Some(distance) = &done.measured {
            text += &format!("error_measured:\n{}", distance::to_table(distance));
        }
        let can_restore = || volume::can_restore(&task.ready.scene, &done.meshes);
        if !self.volume.exact_volume
            && let Some(line) =
                volume::lost_text(report.method, &report.volume, task.scene, can_restore)
        {
            text += &format!("{line}\n");
        }
        text += &simplify_report::seconds_line(*time);
        text += &kept.map_or(String::new(), |kept| kept.text());
        if let Some(residual) = residual {
            text += &format!("volume_residual: {residual:.1e}\n");
        }
        text
    }
}
