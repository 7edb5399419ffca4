//! Report of `extract`, as JSON and text.

use std::path::Path;
use std::time::Duration;

use meshlod::multires::Level;
use meshlod::simplify::VolumeResidual;
use serde_json::{Value, json};

use crate::files;
use crate::kept_error::KeptError;
use crate::numbers::{count, faces, plural, value};

/// Output that the user asked for, whether its target was met, and the time that it took.
pub struct Request<'a> {
    pub output: &'a Path,
    /// True if the level is as close or as coarse as asked.
    pub reached: bool,
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

impl Extracted {
    pub fn to_json(&self, asked: &Request<'_>, [vertices, faces]: [usize; 2]) -> Value {
        json!({
            "file": files::name(asked.output),
            "vertices": vertices,
            "faces": faces,
            "reached": asked.reached,
            "error_kind": self.error_kind,
            "error": self.error.to_json(),
            "lossless": self.lossless,
            "chunks": self.chunks[2],
            "chunks_there": self.chunks[1],
            "chunks_read": self.chunks[0],
            "updates_read": self.updates,
            "bytes_read": self.bytes,
            "extract_seconds": asked.time.as_secs_f64(),
        })
    }

    pub fn to_text(
        &self,
        asked: &Request<'_>,
        [vertices, all]: [usize; 2],
        shown: usize,
    ) -> String {
        let shown = match shown == all {
            true => String::new(),
            false => format!(", shown as {}", count(shown)),
        };
        let [read, _, chunks] = self.chunks;
        format!(
            "{}: {} vertices, {}{shown}\nread {read} of {chunks} chunk{}, {} bytes\n{}extract_seconds: {}\n",
            files::name(asked.output),
            count(vertices),
            faces(all),
            plural(chunks),
            count(self.bytes as usize),
            self.error.to_text(),
            value(asked.time.as_secs_f64()),
        )
    }
}

/// Describes what is left of a difference in volume, and whose volume it is.
pub fn volume_text(restored: &VolumeResidual, lossless: bool) -> String {
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
