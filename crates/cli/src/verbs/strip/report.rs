//! Figures of strips for programs, and the table for people.

use std::time::Duration;

use meshlod::jobs::{KeptError, StripReport, StrippedLevelReport};
use serde::Serialize;

use super::Strip;
use crate::session::files;
use crate::text::numbers::{count, faces};
use crate::text::simplify_report;
use crate::text::table::aligned;

/// Figures of the strips of all levels.
#[derive(Serialize)]
pub(super) struct StripFigures {
    file: String,
    #[serde(flatten)]
    report: StripReport,
    out: Option<String>,
    error: Option<KeptError>,
}

impl Strip {
    pub(super) fn figures(&self, report: StripReport, error: Option<KeptError>) -> StripFigures {
        StripFigures {
            file: files::name(&self.input),
            report,
            out: self.out.as_deref().map(files::name),
            error,
        }
    }
}

pub(super) fn text(report: &StripReport) -> String {
    let headings = [
        "level",
        "triangles",
        "vertices",
        "per triangle",
        "indices",
        "strips",
        "swaps",
        "ACMR16",
        "ACMR32",
        "ms",
    ];
    let mut rows = vec![headings.map(String::from)];
    rows.extend(report.levels.iter().map(row));
    let mut text = aligned(&rows);
    text += "vertices: sent when each strip is drawn by itself; indices: sent with restarts between strips;\n";
    text += "ACMR: vertices fetched per triangle with a FIFO cache of 16 or 32\n";
    for level in report.levels.iter().filter(|level| level.is_wrong()) {
        let [missing, extra] = [level.missing, level.extra].map(Option::unwrap_or_default);
        text += &format!("{}: {missing} missing and {extra} extra triangles\n", level.size);
    }
    if report.verified == Some(true) {
        text += "verified: the strips draw exactly the faces of each level\n";
    }
    if report.each_mesh_once {
        text += "each mesh is stripped once; counts are of all that is shown\n";
    }
    let left_out = report.degenerate_faces + report.duplicate_faces;
    if left_out > 0 {
        text += &format!("left out: {}, degenerate or duplicate\n", faces(left_out));
    }
    if report.simplify_seconds > 0.0 {
        let time = Duration::from_secs_f64(report.simplify_seconds);
        text += &simplify_report::seconds_line(time);
    }
    text
}

fn row(level: &StrippedLevelReport) -> [String; 10] {
    let each = level.vertices_sent as f64 / level.triangles.max(1) as f64;
    [
        level.size.clone(),
        count(level.triangles),
        count(level.vertices_sent),
        format!("{each:.3}"),
        count(level.indices_with_restart),
        count(level.strips),
        count(level.swaps),
        format!("{:.3}", level.acmr16),
        format!("{:.3}", level.acmr32),
        format!("{:.1}", level.seconds * 1e3),
    ]
}
