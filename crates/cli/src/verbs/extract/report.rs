//! Report of `extract`, as JSON and text.

use std::path::Path;
use std::time::Duration;

use meshlod::jobs::ExtractReport;
use serde::Serialize;

use crate::session::files;
use crate::text::kept_error;
use crate::text::numbers::{count, faces, plural, value};

/// Figures of an extracted level for programs.
#[derive(Serialize)]
pub(super) struct ExtractFigures<'r> {
    file: String,
    #[serde(flatten)]
    report: &'r ExtractReport,
    extract_seconds: f64,
}

pub(super) fn figures<'r>(
    output: &Path,
    report: &'r ExtractReport,
    time: Duration,
) -> ExtractFigures<'r> {
    ExtractFigures { file: files::name(output), report, extract_seconds: time.as_secs_f64() }
}

pub(super) fn to_text(output: &Path, report: &ExtractReport, time: Duration) -> String {
    let shown = match report.shown_faces == report.faces {
        true => String::new(),
        false => format!(", shown as {}", count(report.shown_faces)),
    };
    format!(
        "{}: {} vertices, {}{shown}\nread {} of {} chunk{}, {} bytes\n{}extract_seconds: {}\n{}",
        files::name(output),
        count(report.vertices),
        faces(report.faces),
        report.chunks_read,
        report.chunks,
        plural(report.chunks),
        count(report.bytes_read as usize),
        kept_error::to_text(&report.error),
        value(time.as_secs_f64()),
        volume_text(report),
    )
}

/// Describes what is left of a difference in volume, and whose volume it is; empty if the volume was
/// not restored.
fn volume_text(report: &ExtractReport) -> String {
    let (Some(residual), Some(moved)) = (report.volume_residual, report.volume_moved) else {
        return String::new();
    };
    let text = format!("volume_residual: {residual:.1e}\nvolume_moved: {}\n", value(moved));
    match report.lossless {
        true => text,
        false => {
            text + "the volume is that of the rounded vertices; build --exact-volume keeps the mesh's\n"
        }
    }
}
