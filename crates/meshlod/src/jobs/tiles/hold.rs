//! Locks on the folder of a plan, so that two processes do not change it at a time.
//!
//! One file is locked during each step: by tasks together, by what makes or finishes a plan for itself
//! alone. Another one is locked for a whole run, whose steps other processes may do.

use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use meshlod_io::IoError;
use meshlod_tiles::TilesError;
use meshlod_tiles::folder::Folder;

use crate::jobs::JobError;
use crate::jobs::tiles::fault::{failure, no_plan};
use crate::jobs::tiles::refuse_foreign;

/// Right to work in the folder of a plan, for as long as it lives.
#[derive(Debug)]
#[expect(dead_code, reason = "its locks end when they are closed")]
pub(super) struct Hold {
    lock: File,
    run: Option<File>,
}

/// Folder of a plan, for one who works there alone or does a step of a [`TileRun`].
#[derive(Clone, Copy, Debug)]
pub struct PlanFolder<'a> {
    pub(super) path: &'a Path,
    run: Option<&'a str>,
}

impl<'a> PlanFolder<'a> {
    /// Names a folder that no run has.
    pub fn new(path: &'a Path) -> Self {
        Self { path, run: None }
    }

    /// Names the folder of a run by its key.
    pub fn of_run(path: &'a Path, key: &'a str) -> Self {
        Self { path, run: Some(key) }
    }
}

/// Right to the folder of a plan from before it is made until it is removed: steps that other
/// processes do show its key, and whoever else would make or finish a plan there is refused.
#[derive(Debug)]
pub struct TileRun {
    folder: Folder,
    key: String,
    /// Locked while it is open.
    _file: File,
}

impl TileRun {
    /// Takes a folder, which is made.
    ///
    /// # Errors
    /// A folder that holds other files or that another process has, and errors of the system.
    pub fn begin(path: &Path) -> Result<Self, JobError> {
        let folder = Folder::new(path);
        refuse_foreign(&folder)?;
        let mut file = take(&folder, &folder.run_file(), File::try_lock, made)?;
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let key = format!("{} {}", std::process::id(), since.as_nanos());
        let written = file.set_len(0).and_then(|()| file.write_all(key.as_bytes()));
        let written = written.and_then(|()| file.sync_all());
        written.map_err(|error| failure(TilesError::system(&folder.run_file(), error)))?;
        Ok(Self { folder, key, _file: file })
    }

    /// Returns the key that its steps show.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Removes the files of the plan, unless another process is working on them.
    pub fn remove(&self) {
        let place = PlanFolder::of_run(self.folder.path(), &self.key);
        if let Ok(_hold) = Hold::alone(place) {
            self.folder.remove();
        }
    }
}

impl Drop for TileRun {
    fn drop(&mut self) {
        // Without a plan, nothing here is of use to the next run.
        if self.folder.plan_stamp().is_none() {
            self.remove();
        }
    }
}

impl Hold {
    /// Takes a folder, which is made, for one process alone.
    pub fn new_plan(place: PlanFolder<'_>) -> Result<Self, JobError> {
        Self::take_alone(place, made)
    }

    /// Takes the folder of a plan for one process alone.
    pub fn alone(place: PlanFolder<'_>) -> Result<Self, JobError> {
        Self::take_alone(place, there)
    }

    /// Takes the folder of a plan together with other processes that do its tasks.
    pub fn shared(folder: &Folder) -> Result<Self, JobError> {
        let lock = take(folder, &folder.lock_file(), File::try_lock_shared, there)?;
        Ok(Self { lock, run: None })
    }

    fn take_alone(place: PlanFolder<'_>, open: Open) -> Result<Self, JobError> {
        let folder = Folder::new(place.path);
        let run = match place.run {
            Some(key) if is_run(&folder, key) => None,
            Some(_) => return Err(busy(&folder)),
            None => Some(take(&folder, &folder.run_file(), File::try_lock, open)?),
        };
        let lock = take(&folder, &folder.lock_file(), File::try_lock, open)?;
        Ok(Self { lock, run })
    }
}

/// Way to open a file that is locked.
type Open = fn(&Folder, &Path) -> Result<File, JobError>;

fn take(
    folder: &Folder,
    path: &Path,
    lock: fn(&File) -> Result<(), TryLockError>,
    open: Open,
) -> Result<File, JobError> {
    loop {
        let file = open(folder, path)?;
        match lock(&file) {
            Err(TryLockError::WouldBlock) => return Err(busy(folder)),
            // The disks of some clusters have no locks. Tasks write the same bytes anyway.
            Err(TryLockError::Error(_)) => return Ok(file),
            // The one who had it may have removed it meanwhile.
            Ok(()) if is_at(&file, path) => return Ok(file),
            Ok(()) => {}
        }
    }
}

fn busy(folder: &Folder) -> JobError {
    let error = io::Error::other("another process is making tiles here");
    JobError::output(IoError::system(folder.path(), error))
}

/// Returns true if the run of this key has the folder.
fn is_run(folder: &Folder, key: &str) -> bool {
    let mut text = String::new();
    let read = File::open(folder.run_file()).and_then(|mut file| file.read_to_string(&mut text));
    read.is_ok() && text == key
}

/// Opens a file of a folder, and makes both if they are not there.
fn made(folder: &Folder, path: &Path) -> Result<File, JobError> {
    folder.make().map_err(failure)?;
    let file = File::options().read(true).write(true).create(true).truncate(false).open(path);
    file.map_err(|error| system(path, error))
}

/// Opens a file of the folder of a plan that must be there.
fn there(folder: &Folder, path: &Path) -> Result<File, JobError> {
    let missing = |error: io::Error| match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => no_plan(folder),
        _ => system(path, error),
    };
    let lock: PathBuf = folder.lock_file();
    let open = |path: &Path, is_made: bool| {
        File::options().read(true).write(true).create(is_made).truncate(false).open(path)
    };
    // Only the folder of a plan has a lock.
    let file = open(&lock, false).map_err(missing)?;
    if *path == *lock { Ok(file) } else { open(path, true).map_err(missing) }
}

fn system(path: &Path, error: io::Error) -> JobError {
    failure(TilesError::system(path, error))
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
