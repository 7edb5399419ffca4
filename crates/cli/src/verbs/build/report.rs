//! Report of `build`, as JSON and text.

use std::time::Duration;

use meshlod::Mesh;
use meshlod::multires::{Certificate, Fit};
use serde_json::{Value, json};

use super::Build;
use crate::files;
use crate::model_file;
use crate::model_scene::ErrorPoses;
use crate::numbers::{count, faces, value};

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

pub(super) enum Levels {
    Contractions {
        updates: usize,
        base_faces: usize,
        certificate: Certificate,
        error_kind: &'static str,
        /// Numbers of vertices that were held, as JSON.
        held: Value,
    },
    RightTriangles {
        size: [u32; 2],
        fit: Fit,
    },
}

impl Build {
    pub(super) fn json(&self, mesh: &Mesh, built: &Built, time: Duration) -> Value {
        let vertices = vertex_count(mesh);
        let mut json = json!({
            "file": files::name(&self.output),
            "input_vertices": vertices,
            "input_faces": mesh.faces.len(),
            "bytes": built.bytes.len(),
            "scene_bytes": built.bytes.len() - built.surface_bytes,
            "bytes_per_vertex": built.surface_bytes as f64 / vertices as f64,
            "rounding": built.rounding,
            "build_seconds": time.as_secs_f64(),
        });
        match &built.levels {
            Levels::Contractions { updates, base_faces, certificate, error_kind, held } => {
                json["held"] = held.clone();
                json["error_kind"] = (*error_kind).into();
                json["poses"] = model_file::poses_json(built.poses.measured());
                json["model"] = "contractions".into();
                json["method"] = self.method.name().into();
                json["lossless"] = self.lossless.into();
                json["updates"] = (*updates).into();
                json["base_faces"] = (*base_faces).into();
                json["certificate"] = model_file::certificate_json(certificate);
            }
            Levels::RightTriangles { size, fit } => {
                json["model"] = "right-triangles".into();
                json["error_kind"] = "bound".into();
                json["grid"] = json!(size);
                json["fit"] = model_file::fit_json(fit);
            }
        }
        json
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
            Levels::RightTriangles { size: [columns, rows], fit } => format!(
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
