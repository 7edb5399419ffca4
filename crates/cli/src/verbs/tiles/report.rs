//! Text and figures of tiles.

use std::path::Path;

use meshlod::jobs::TilesReport;
use meshlod::tiles::archive::is_archive;
use serde::Serialize;

use crate::session::files;
use crate::text::numbers::{count, plural, value};

/// Figures of tiles for programs.
#[derive(Serialize)]
pub struct TilesFigures {
    file: String,
    #[serde(flatten)]
    report: TilesReport,
}

impl TilesFigures {
    pub fn new(output: &Path, report: TilesReport) -> Self {
        Self { file: name(output), report }
    }
}

/// Names the file that a viewer opens.
fn name(output: &Path) -> String {
    match is_archive(output) {
        true => files::name(output),
        false => files::name(&output.join("tileset.json")),
    }
}

pub fn text(output: &Path, report: &TilesReport) -> String {
    let TilesReport { tiles, input_faces, levels, .. } = report;
    let mut text = format!(
        "{}: {} tile{} in {} level{}, {} bytes\n",
        name(output),
        count(*tiles),
        plural(*tiles),
        levels.len(),
        plural(levels.len()),
        count(report.bytes as usize),
    );
    text += &format!("  input       {} faces\n", count(*input_faces));
    for level in levels {
        text += &format!(
            "  level {:<5} {} tile{}, {} faces, within {}\n",
            level.depth,
            count(level.tiles),
            plural(level.tiles),
            count(level.faces),
            value(level.error_proved),
        );
    }
    text += "  proved: no crack within a level\n";
    text
}
