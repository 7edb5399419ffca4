//! Files that work makes: after an interruption, nothing is written any more.

use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf, absolute};
use std::process;
use std::sync::atomic::{AtomicUsize, Ordering};

use meshlod::IoError;

use crate::work::Watch;

/// Makes a file with `write`, which gets the path to write to. Work that is cancelled before the
/// file is complete leaves the old one as it is.
///
/// A target that is not a regular file (a pipe, a device) is written in place.
///
/// # Errors
/// Errors of the system with `path`, and those of `write` as text.
pub fn make<T, E: ToString>(
    watch: &Watch,
    path: &Path,
    write: impl FnOnce(&Path) -> Result<T, E>,
) -> Result<T, MakeError> {
    let named = |error| MakeError::File(IoError::system(path, error));
    // The folder of the process may change while the work runs.
    let target = fs::canonicalize(path).or_else(|_| absolute(path)).map_err(named)?;
    if fs::metadata(&target).is_ok_and(|found| !found.is_file()) {
        watch.commit();
        return write(path).map_err(|error| MakeError::Work(error.to_string()));
    }
    let scratch = Scratch::beside(&target).map_err(named)?;
    let made = write(&scratch.0).map_err(|error| {
        let [scratch, path] = [&scratch.0, path].map(|path| path.display().to_string());
        MakeError::Work(error.to_string().replace(&scratch, &path))
    })?;
    watch.commit();
    fs::rename(&scratch.0, &target).map_err(named)?;
    Ok(made)
}

/// Reason why a file was not made.
pub enum MakeError {
    /// The system refused it.
    File(IoError),
    /// The contents of the file cannot be made.
    Work(String),
}

/// File beside its later place, of the same format, that is removed on drop.
struct Scratch(PathBuf);

impl Scratch {
    /// Makes an empty file, with the permissions of the one that it will replace.
    fn beside(target: &Path) -> io::Result<Self> {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let suffix = target.extension().unwrap_or_default();
        loop {
            let number = NEXT.fetch_add(1, Ordering::Relaxed);
            let name = format!(".meshlod-{}-{number}", process::id());
            let path = target.with_file_name(name).with_extension(suffix);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => {
                    if let Ok(found) = fs::metadata(target) {
                        // Some network drives have no permissions; writing the file matters more.
                        let _ = file.set_permissions(found.permissions());
                    }
                    return Ok(Self(path));
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // It is gone if it was renamed.
        let _ = fs::remove_file(&self.0);
    }
}
