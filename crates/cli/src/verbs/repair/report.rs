//! Report of `repair`, as JSON and text.

use meshlod::jobs::SceneRepair;
use serde::Serialize;

use super::Repair;
use crate::options::fuse;
use crate::session::files;
use crate::text::numbers::{count, faces, value};
use crate::text::table::aligned;

/// Report of the job with the file that was written.
#[derive(Serialize)]
pub(super) struct RepairedFile<'r> {
    file: String,
    #[serde(flatten)]
    report: &'r SceneRepair,
}

impl Repair {
    pub(super) fn figures<'r>(&self, report: &'r SceneRepair) -> RepairedFile<'r> {
        RepairedFile { file: files::name(&self.output), report }
    }

    pub(super) fn text(&self, report: &SceneRepair) -> String {
        let steps: Vec<[String; 2]> = report
            .steps
            .nonzero()
            .map(|(step, number)| [format!("  {}", step.name()), count(number)])
            .collect();
        let nothing = match (report.steps.is_unchanged(), report.errors_left) {
            (false, _) => "",
            (true, 0) => "  nothing to repair\n",
            (true, _) => "  nothing repaired\n",
        };
        let left: Vec<[String; 2]> = report
            .errors_left_by_kind
            .found()
            .map(|(kind, number)| [format!("  left: {}", kind.name()), count(number)])
            .collect();
        format!(
            "{}: {} to {}, {} vertices to {}\n{nothing}{}{}{}repair_seconds: {}\n",
            files::name(&self.output),
            faces(report.input_faces),
            count(report.output_faces),
            count(report.input_vertices),
            count(report.output_vertices),
            aligned(&steps),
            fuse::to_text(report.fused.as_ref()),
            aligned(&left),
            value(report.repair_seconds),
        )
    }
}
