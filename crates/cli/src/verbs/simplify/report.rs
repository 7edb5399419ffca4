//! Report of `simplify`, as JSON and text.

use meshlod::jobs::SimplifyReport;
use serde::Serialize;

use super::Simplify;
use crate::options::fuse;
use crate::options::topology;
use crate::session::files;
use crate::text::distance;
use crate::text::error_bound;
use crate::text::numbers::{count, faces, percent, value};
use crate::text::simplify_report;

/// Report of the job with the file that was written.
#[derive(Serialize)]
pub(super) struct WrittenFigures<'r> {
    #[serde(flatten)]
    report: &'r SimplifyReport,
    file: String,
}

impl Simplify {
    pub(super) fn figures<'r>(&self, report: &'r SimplifyReport) -> WrittenFigures<'r> {
        WrittenFigures { report, file: files::name(&self.output) }
    }

    pub(super) fn text(&self, report: &SimplifyReport) -> String {
        let (run, fused) = (&report.run, report.fused.as_ref());
        let input_faces = fused.map_or(run.input_faces, |fused| fused.input_faces);
        let part = 100.0 * run.output_faces as f64 / input_faces as f64;
        let mut text = format!(
            "{}{}: {} to {} ({})\n{}{}",
            fuse::to_text(fused),
            files::name(&self.output),
            faces(input_faces),
            count(run.output_faces),
            percent(part),
            topology::to_text(&report.conditioning),
            simplify_report::mesh_notes(run),
        );
        text += &report.flats.map_or(String::new(), |flats| simplify_report::flats(report, flats));
        text += &format!("error_estimate: {}\n", value(run.error_estimate));
        if let Some(distance) = &report.measured {
            text += &format!("error_measured:\n{}", distance::to_table(distance));
        }
        text += &report.lost_volume.as_ref().map_or(String::new(), simplify_report::lost_volume);
        text += &simplify_report::seconds_line(report.time);
        text += &report.error.as_ref().map_or(String::new(), error_bound::text);
        if let Some(residual) = report.volume_residual {
            text += &format!("volume_residual: {residual:.1e}\n");
        }
        text
    }
}
