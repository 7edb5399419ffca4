//! Report of `extract`, as JSON and text.

use std::path::Path;
use std::time::Duration;

use meshlod::multires::Level;
use meshlod::simplify::VolumeResidual;
use serde::Serialize;

use crate::session::files;
use crate::text::kept_error::{KeptError, KeptFigures};
use crate::text::numbers::{count, faces, plural, value};

/// File that was written, and whether it is what was asked for.
pub struct Done<'a> {
    pub output: &'a Path,
    /// Vertices and faces.
    pub counts: [usize; 2],
    /// Number of faces that the scene shows, over all instances.
    pub shown: usize,
    /// True if the level is as close or as coarse as asked.
    pub reached: bool,
    /// Difference in volume that is left, if the volume was restored.
    pub restored: Option<VolumeResidual>,
    pub time: Duration,
}

/// Extracted level with the figures on what was read.
pub struct Extracted {
    pub level: Level,
    /// Number of faces of the level before faces outside the focus were left out.
    pub whole_faces: usize,
    /// Largest displacement of its vertices when the file was built.
    pub rounding: f64,
    pub lossless: bool,
    pub error_kind: &'static str,
    pub error: KeptError,
    /// Chunks read, present and in total.
    pub chunks: [usize; 3],
    pub updates: usize,
    pub bytes: u64,
}

/// Figures of an extracted level for programs.
#[derive(Serialize)]
pub struct ExtractFigures {
    file: String,
    vertices: usize,
    faces: usize,
    reached: bool,
    error_kind: &'static str,
    error: KeptFigures,
    lossless: bool,
    chunks: usize,
    chunks_there: usize,
    chunks_read: usize,
    updates_read: usize,
    bytes_read: u64,
    extract_seconds: f64,
    volume_residual: Option<f64>,
    volume_moved: Option<f64>,
    shown_faces: usize,
}

impl Extracted {
    pub fn figures(&self, done: &Done<'_>) -> ExtractFigures {
        let ([vertices, faces], [chunks_read, chunks_there, chunks]) = (done.counts, self.chunks);
        ExtractFigures {
            file: files::name(done.output),
            vertices,
            faces,
            reached: done.reached,
            error_kind: self.error_kind,
            error: self.error.figures(),
            lossless: self.lossless,
            chunks,
            chunks_there,
            chunks_read,
            updates_read: self.updates,
            bytes_read: self.bytes,
            extract_seconds: done.time.as_secs_f64(),
            volume_residual: done.restored.map(|restored| restored.after.abs()),
            volume_moved: done.restored.map(|restored| restored.farthest),
            shown_faces: done.shown,
        }
    }

    pub fn to_text(&self, done: &Done<'_>) -> String {
        let ([vertices, all], [read, _, chunks]) = (done.counts, self.chunks);
        let shown = match done.shown == all {
            true => String::new(),
            false => format!(", shown as {}", count(done.shown)),
        };
        let volume = done.restored.map(|restored| volume_text(&restored, self.lossless));
        format!(
            "{}: {} vertices, {}{shown}\nread {read} of {chunks} chunk{}, {} bytes\n{}extract_seconds: {}\n{}",
            files::name(done.output),
            count(vertices),
            faces(all),
            plural(chunks),
            count(self.bytes as usize),
            self.error.to_text(),
            value(done.time.as_secs_f64()),
            volume.unwrap_or_default(),
        )
    }
}

/// Describes what is left of a difference in volume, and whose volume it is.
fn volume_text(restored: &VolumeResidual, lossless: bool) -> String {
    let VolumeResidual { after, farthest, .. } = restored;
    let text =
        format!("volume_residual: {:.1e}\nvolume_moved: {}\n", after.abs(), value(*farthest));
    match lossless {
        true => text,
        false => {
            text + "the volume is that of the rounded vertices; build --exact-volume keeps the mesh's\n"
        }
    }
}
