//! The folder of a tileset: which may be written to, and where its plan is.

use std::fs;
use std::path::{Path, PathBuf};

use meshlod_tiles::archive::is_archive;
use meshlod_tiles::folder::{has_other_files, is_of_tile};

use crate::jobs::JobError;
use crate::jobs::tiles::result::TILES;

/// Folder of the plan in that of the tileset, while this is made; after the name of an archive.
const PLAN: &str = ".plan";

/// Returns the folder of the plan by which a tileset is made in a folder, or as an archive.
pub fn tile_plan_folder(out: &Path) -> PathBuf {
    if !is_archive(out) {
        return out.join(PLAN);
    }
    let mut name = out.as_os_str().to_owned();
    name.push(PLAN);
    name.into()
}

/// Fails if tiles cannot go to a folder, since it is a file or holds anything that is not a tileset
/// of ours, before any work is done.
///
/// # Errors
/// [`JobError::Output`].
pub fn check_tiles_folder(out: &Path) -> Result<(), JobError> {
    if is_archive(out) {
        return match out.is_dir() {
            true => Err(JobError::output("is a folder; name a file for the archive")),
            false => Ok(()),
        };
    }
    if out.exists() && !out.is_dir() {
        return Err(JobError::output("is a file; name a folder for the tiles"));
    }
    let Ok(mut entries) = fs::read_dir(out) else { return Ok(()) };
    let tileset = out.join("tileset.json");
    let is_ours = || out.join(PLAN).exists() || is_written_by_us(&tileset);
    // As a process leaves them that was ended while it put the tiles there.
    let is_rest = |name: &str| {
        let is_part = name.starts_with(".tiles-") || name.starts_with(".tileset.json.");
        name == TILES || is_part || is_of_tile(name)
    };
    let mut are_rests = || {
        entries
            .all(|entry| entry.is_ok_and(|entry| entry.file_name().to_str().is_some_and(is_rest)))
    };
    match is_ours() || are_rests() {
        true if has_other_files(&out.join(TILES)) => {
            let reason = format!("its folder {TILES} holds other files; name a new folder");
            Err(JobError::output(reason))
        }
        true => Ok(()),
        false => Err(JobError::output("holds other files; name a new folder for the tiles")),
    }
}

/// Returns true for a tileset that this program has written, whose tiles may be replaced.
fn is_written_by_us(tileset: &Path) -> bool {
    fs::read_to_string(tileset).is_ok_and(|text| text.contains("\"generator\":\"meshlod "))
}
