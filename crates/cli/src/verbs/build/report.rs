//! Report of `build`, as JSON and text.

use std::time::Duration;

use meshlod::multires::{Certificate, Fit};
use meshlod::simplify::Held;
use meshlod::{Mesh, Method, PoseCounts, SceneCounts};
use serde::Serialize;

use super::Build;
use crate::options::fuse::FuseReport;
use crate::session::files;
use crate::session::model_file;
use crate::text::model_scene::ErrorPoses;
use crate::text::numbers::{count, faces, value};

/// File contents with the figures to report.
pub(super) struct Built {
    pub(super) bytes: Vec<u8>,
    /// Size of the levels alone, without images, nodes and materials.
    pub(super) surface_bytes: usize,
    /// Number of faces of the finest level.
    pub(super) faces: usize,
    pub(super) rounding: f64,
    /// Displacement of vertices in words.
    pub(super) moved: String,
    pub(super) levels: Levels,
    /// Poses for which errors hold, beside that of the file.
    pub(super) poses: ErrorPoses,
}

/// Figures of the levels, under the keys of JSON.
#[derive(Serialize)]
#[serde(untagged)]
pub(super) enum Levels {
    Contractions {
        held: Held,
        error_kind: &'static str,
        poses: Option<PoseCounts>,
        model: &'static str,
        method: Method,
        lossless: bool,
        updates: usize,
        base_faces: usize,
        certificate: Certificate,
    },
    RightTriangles {
        model: &'static str,
        error_kind: &'static str,
        grid: [u32; 2],
        fit: Fit,
    },
}

/// Figures of a multiresolution file for programs.
#[derive(Serialize)]
pub(super) struct BuildFigures<'b> {
    file: String,
    input_vertices: usize,
    input_faces: usize,
    bytes: usize,
    scene_bytes: usize,
    bytes_per_vertex: f64,
    rounding: f64,
    build_seconds: f64,
    #[serde(flatten)]
    levels: &'b Levels,
    fused: Option<FuseReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<SceneCounts>,
}

impl Build {
    pub(super) fn figures<'b>(
        &self,
        mesh: &Mesh,
        built: &'b Built,
        (fused, scene): (Option<FuseReport>, Option<SceneCounts>),
        time: Duration,
    ) -> BuildFigures<'b> {
        let input_vertices = vertex_count(mesh);
        BuildFigures {
            file: files::name(&self.output),
            input_vertices,
            input_faces: mesh.faces.len(),
            bytes: built.bytes.len(),
            scene_bytes: built.bytes.len() - built.surface_bytes,
            bytes_per_vertex: built.surface_bytes as f64 / input_vertices as f64,
            rounding: built.rounding,
            build_seconds: time.as_secs_f64(),
            levels: &built.levels,
            fused,
            scene,
        }
    }

    pub(super) fn text(&self, mesh: &Mesh, built: &Built, time: Duration) -> String {
        let vertices = vertex_count(mesh);
        let mut text = format!(
            "{}: all levels of {} in {} bytes, {:.2} per vertex{}; {}\n",
            files::name(&self.output),
            faces(built.faces),
            count(built.bytes.len()),
            built.surface_bytes as f64 / vertices as f64,
            built.scene_text(),
            built.moved,
        );
        text += &match &built.levels {
            Levels::Contractions { updates, base_faces, certificate, error_kind, .. } => format!(
                "{} updates by {} down to {}, with {}; {}\n",
                count(*updates),
                self.method.name(),
                faces(*base_faces),
                model_file::errors_text(error_kind, built.poses.measured()),
                model_file::certificate_text(certificate),
            ),
            Levels::RightTriangles { grid: [columns, rows], fit, .. } => format!(
                "right triangles of {columns} x {rows} heights; {}\n",
                model_file::fit_text(fit),
            ),
        };
        text + &format!("build_seconds: {}\n", value(time.as_secs_f64()))
    }
}

impl Built {
    /// Formats what images, nodes and materials take; empty if there are none.
    fn scene_text(&self) -> String {
        match self.bytes.len() - self.surface_bytes {
            0 => String::new(),
            bytes => format!(" without the {} of images, nodes and materials", count(bytes)),
        }
    }
}

/// Returns the number of vertices used by faces.
fn vertex_count(mesh: &Mesh) -> usize {
    mesh.used_vertices().iter().filter(|&&used| used).count()
}
