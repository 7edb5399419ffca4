//! The folder of a tileset: which may be written to, and by whom.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use meshlod_tiles::TilesError;
use meshlod_tiles::folder::{Folder, TileRecord};

use crate::jobs::JobError;
use crate::jobs::tiles::failure;

/// Folder of the plan in that of the tileset, while this is made.
const PLAN: &str = ".plan";

/// Returns the folder of the plan by which a tileset is made in a folder.
pub fn tile_plan_folder(out: &Path) -> PathBuf {
    out.join(PLAN)
}

/// Fails if tiles cannot go to a folder, since it is a file or holds anything that is not a tileset
/// of ours, before any work is done.
///
/// # Errors
/// [`JobError::Output`].
pub fn check_tiles_folder(out: &Path) -> Result<(), JobError> {
    if out.exists() && !out.is_dir() {
        return Err(JobError::output("is a file; name a folder for the tiles"));
    }
    let Ok(mut entries) = fs::read_dir(out) else { return Ok(()) };
    let is_ours = out.join(PLAN).exists() || is_written_by_us(&out.join("tileset.json"));
    match entries.next().is_none() || is_ours {
        true => Ok(()),
        false => Err(JobError::output("holds other files; name a new folder for the tiles")),
    }
}

/// Returns true for a tileset that this program has written, whose tiles may be replaced.
fn is_written_by_us(tileset: &Path) -> bool {
    fs::read_to_string(tileset).is_ok_and(|text| text.contains("\"generator\":\"meshlod "))
}

/// Right to make tiles in a folder, which no other process has; given back on drop.
#[derive(Debug)]
pub struct TilesLock {
    _file: File,
}

impl TilesLock {
    /// Takes the right to make tiles in a folder, with the folder of their plan.
    ///
    /// File systems without locks, as some network drives are, grant it to everybody.
    ///
    /// # Errors
    /// A folder that cannot be made, or that another process is working on.
    pub fn take(out: &Path) -> Result<Self, JobError> {
        let folder = Folder::new(tile_plan_folder(out));
        folder.make().map_err(failure)?;
        let path = folder.lock_file();
        let system = |error| failure(TilesError::system(&path, error));
        let file = File::create(&path).map_err(system)?;
        if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
            let path = path.display();
            let reason = format!("{path}: another process is making tiles here");
            return Err(JobError::output(reason));
        }
        Ok(Self { _file: file })
    }
}

/// Removes what processes that were ended have left among the contents of tiles.
pub(super) fn tidy(folder: &Folder, records: &[TileRecord]) {
    let content = |record: &TileRecord| folder.content(record.cell);
    let known: BTreeSet<PathBuf> = records.iter().map(content).collect();
    let entries = fs::read_dir(folder.content_folder()).into_iter().flatten().flatten();
    for path in entries.map(|entry| entry.path()).filter(|path| !known.contains(path)) {
        // What cannot be removed does no harm.
        let _ = fs::remove_file(path);
    }
}
