//! Report of `build`, as JSON and text.

use std::path::Path;
use std::time::Duration;

use meshlod::jobs::{BuildReport, BuiltLevels};
use serde::Serialize;

use crate::options::fuse::{self, FuseReport};
use crate::session::files;
use crate::session::model_file;
use crate::text::model_scene;
use crate::text::numbers::{count, faces, value};

/// Figures of a multiresolution file for programs.
#[derive(Serialize)]
pub(super) struct BuildFigures<'b> {
    file: String,
    #[serde(flatten)]
    report: &'b BuildReport,
    build_seconds: f64,
    fused: Option<FuseReport>,
}

pub(super) fn figures<'b>(
    output: &Path,
    report: &'b BuildReport,
    fused: Option<FuseReport>,
    time: Duration,
) -> BuildFigures<'b> {
    BuildFigures { file: files::name(output), report, build_seconds: time.as_secs_f64(), fused }
}

pub(super) fn to_text(
    output: &Path,
    report: &BuildReport,
    fused: Option<&FuseReport>,
    time: Duration,
) -> String {
    let BuildReport { moved, diagonal, scene_bytes, error_poses, .. } = *report;
    let is_lossless = matches!(report.levels, BuiltLevels::Contractions { lossless: true, .. });
    let mut text = fuse::to_text(fused);
    text += &format!(
        "{}: all levels of {} in {} bytes, {:.2} per vertex{}; {}\n",
        files::name(output),
        faces(report.faces),
        count(report.bytes),
        report.bytes_per_vertex,
        scene_text(scene_bytes),
        model_file::rounding_text(moved, diagonal, is_lossless),
    );
    text += &match &report.levels {
        BuiltLevels::Contractions {
            updates, base_faces, certificate, error_kind, method, ..
        } => {
            format!(
                "{} updates by {} down to {}, with {}; {}\n",
                count(*updates),
                method.name(),
                faces(*base_faces),
                model_file::errors_text(*error_kind, error_poses.measured()),
                model_file::certificate_text(certificate),
            )
        }
        BuiltLevels::RightTriangles { grid: [columns, rows], fit, .. } => format!(
            "right triangles of {columns} x {rows} heights; {}\n",
            model_file::fit_text(fit),
        ),
    };
    text += &format!("build_seconds: {}\n", value(time.as_secs_f64()));
    match &report.scene {
        Some(counts) => text + &model_scene::counts_text(counts, error_poses),
        None => text,
    }
}

/// Formats what images, nodes and materials take; empty if there are none.
fn scene_text(bytes: usize) -> String {
    match bytes {
        0 => String::new(),
        bytes => format!(" without the {} of images, nodes and materials", count(bytes)),
    }
}
