//! Checks of tilesets that `tiles` has written.

use std::path::Path;

use meshlod::jobs::{TilesetReport, check_tileset};
use meshlod::tiles::archive::is_archive;
use serde::Serialize;

use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::text::numbers::{count, plural};

/// Name of the file that a tileset begins with.
const TILESET: &str = "tileset.json";

/// Figures of a tileset for programs.
#[derive(Serialize)]
struct TilesetFigures {
    file: String,
    #[serde(flatten)]
    report: TilesetReport,
}

/// Returns true for `tileset.json`, for a folder that has one, and for an archive of tiles.
pub fn is_tileset(path: &Path) -> bool {
    is_archive(path)
        || path.file_name().is_some_and(|name| name == TILESET)
        || path.join(TILESET).is_file()
}

/// Reads all tiles of a tileset again and checks them.
pub fn check(path: &Path, session: &Session) -> Result<Answer, Failure> {
    let is_whole = path.is_dir() || is_archive(path);
    let whole = if is_whole { path } else { path.parent().unwrap_or(Path::new("")) };
    let hearing = Hearing::new(session, path, path);
    let report = check_tileset(whole, &hearing).map_err(|error| hearing.failure(error))?;
    let outcome = Outcome::Found.when(!report.findings.is_empty());
    let text = text(path, &report);
    let figures = TilesetFigures { file: files::name(path), report };
    Ok(Answer { outcome, ..Answer::new(figures, text) })
}

fn text(path: &Path, report: &TilesetReport) -> String {
    let TilesetReport { tiles, levels, faces, findings } = report;
    let mut text = format!(
        "{}: {} tile{} in {levels} level{}, {} faces\n",
        files::name(path),
        count(*tiles),
        plural(*tiles),
        plural(*levels),
        count(*faces),
    );
    match findings.is_empty() {
        true => text += "  proved: no crack within a level, contents in their boxes\n",
        false => findings.iter().for_each(|finding| text += &format!("  error: {finding}\n")),
    }
    text
}
