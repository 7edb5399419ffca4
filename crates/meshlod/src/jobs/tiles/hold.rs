//! Locks on the folder of a plan, so that two processes do not change it at a time.

use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::Path;

use meshlod_io::IoError;
use meshlod_tiles::TilesError;
use meshlod_tiles::folder::Folder;

use crate::jobs::JobError;
use crate::jobs::tiles::fault::{failure, no_plan};

/// Right to work in the folder of a plan, for as long as it lives.
#[derive(Debug)]
pub(super) struct Hold(#[expect(dead_code, reason = "its lock ends when it is closed")] File);

impl Hold {
    /// Takes a folder, which is made, for one process alone.
    pub fn new_plan(folder: &Folder) -> Result<Self, JobError> {
        Self::take(folder, File::try_lock, |folder| {
            folder.make().map_err(failure)?;
            open(&folder.lock_file()).map_err(|error| system(folder, error))
        })
    }

    /// Takes the folder of a plan for one process alone.
    pub fn alone(folder: &Folder) -> Result<Self, JobError> {
        Self::take(folder, File::try_lock, there)
    }

    /// Takes the folder of a plan together with other processes that do its tasks.
    pub fn shared(folder: &Folder) -> Result<Self, JobError> {
        Self::take(folder, File::try_lock_shared, there)
    }

    fn take(
        folder: &Folder,
        lock: fn(&File) -> Result<(), TryLockError>,
        open: impl Fn(&Folder) -> Result<File, JobError>,
    ) -> Result<Self, JobError> {
        loop {
            let file = open(folder)?;
            match lock(&file) {
                Err(TryLockError::WouldBlock) => {
                    let error = io::Error::other("another process is making tiles here");
                    return Err(JobError::output(IoError::system(folder.path(), error)));
                }
                // The disks of some clusters have no locks. Tasks write the same bytes anyway.
                Err(TryLockError::Error(_)) => return Ok(Self(file)),
                // The one who had it may have removed it meanwhile.
                Ok(()) if is_at(&file, &folder.lock_file()) => return Ok(Self(file)),
                Ok(()) => {}
            }
        }
    }
}

fn open(path: &Path) -> io::Result<File> {
    File::options().read(true).write(true).open(path)
}

/// Opens the lock file of a plan that must be there.
fn there(folder: &Folder) -> Result<File, JobError> {
    open(&folder.lock_file()).map_err(|error| match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => no_plan(folder),
        _ => system(folder, error),
    })
}

fn system(folder: &Folder, error: io::Error) -> JobError {
    failure(TilesError::system(&folder.lock_file(), error))
}

/// Returns true if an open file is the one at a path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;

    let id = |facts: &std::fs::Metadata| (facts.dev(), facts.ino());
    matches!((file.metadata(), path.metadata()), (Ok(a), Ok(b)) if id(&a) == id(&b))
}

/// Returns true: a file that is open is not removed.
#[cfg(not(unix))]
fn is_at(_file: &File, _path: &Path) -> bool {
    true
}
