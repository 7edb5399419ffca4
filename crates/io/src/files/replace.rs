//! Atomic file replacement: a temporary file in the same folder, renamed when complete.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::IoError;

/// Writes a file atomically: an existing file at `path` is replaced only once the new one is
/// complete.
///
/// # Errors
/// Errors of the system, with the path.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    replace(path, |out| out.write_all(bytes)).map_err(|error| IoError::system(path, error))
}

/// Writes a file atomically, as [`write_file`] does, with `fill`.
///
/// # Errors
/// Errors of the system and of `fill`, with the path; those that name a file already stay as they
/// are.
pub fn write_file_with(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), IoError> {
    replace(path, fill)
        .map_err(|error| error.downcast().unwrap_or_else(|error| IoError::system(path, error)))
}

/// Fails if no file can be at a path: if it is a folder, or one of its folders is a file.
///
/// Folders may be missing: they are made when the file is written.
///
/// # Errors
/// An error of the system that says what is there.
pub fn check_place(path: &Path) -> Result<(), IoError> {
    let fault = |reason: &str| Err(IoError::system(path, io::Error::other(reason)));
    if path.is_dir() {
        return fault("is a folder; name a file to write");
    }
    let exists = |folder: &&Path| !folder.as_os_str().is_empty() && folder.exists();
    match path.ancestors().skip(1).find(exists) {
        Some(folder) if !folder.is_dir() => fault("its folder is a file"),
        _ => Ok(()),
    }
}

/// Deletes the unfinished temporary files of this process, for programs about to exit early, as on
/// Ctrl-C.
///
/// Threads that are still writing then have no file to finish, so end the process right after.
pub fn abandon_files() {
    for path in unfinished().drain(..) {
        // Nothing could be done about a failure here.
        let _ = fs::remove_file(path);
    }
}

/// Removes temporary files that killed processes have left beside these paths.
///
/// Files of running processes stay, on systems with `/proc`. Cost: reads each folder once.
pub fn remove_abandoned<'p>(paths: impl IntoIterator<Item = &'p Path>) {
    let mut folders: BTreeMap<&Path, BTreeSet<&str>> = BTreeMap::new();
    for path in paths {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let name = path.file_name().and_then(|name| name.to_str());
        folders.entry(folder.unwrap_or(Path::new("."))).or_default().extend(name);
    }
    for (folder, names) in folders {
        for file in fs::read_dir(folder).into_iter().flatten().flatten() {
            let found = file.file_name();
            let Some((target, process)) = found.to_str().and_then(target_of) else { continue };
            if names.contains(target) && !Path::new("/proc").join(process).exists() {
                // What cannot be removed does no harm.
                let _ = fs::remove_file(file.path());
            }
        }
    }
}

/// Returns the final name of a temporary file, and the id of its process.
fn target_of(temporary: &str) -> Option<(&str, &str)> {
    let (target, numbers) = temporary.strip_prefix('.')?.rsplit_once('.')?;
    let (process, number) = numbers.split_once('-')?;
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    (is_number(process) && is_number(number)).then_some((target, process))
}

/// Writes a file with `fill`; the old one stays as it is until the new one is complete.
///
/// Missing folders are made. A target that is not a regular file (a pipe, a device) is written in
/// place.
///
/// # Errors
/// Errors of the system and those of `fill`; no temporary file is left behind.
pub(crate) fn replace<E: From<io::Error>>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<(), E>,
) -> Result<(), E> {
    Ok(stage(path, fill)?.rename()?)
}

/// File that is complete under a temporary name, which is deleted on drop.
pub(crate) struct Staged {
    /// Temporary file and its place; `None` if it was written in place.
    place: Option<(Temporary, PathBuf)>,
}

impl Staged {
    /// Moves the file to its final name.
    pub fn rename(self) -> io::Result<()> {
        match self.place {
            Some((temporary, target)) => temporary.rename(&target),
            None => Ok(()),
        }
    }
}

/// Writes a file with `fill` under a temporary name beside its place.
///
/// # Errors
/// Errors of [`replace`].
pub(crate) fn stage<E: From<io::Error>>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<(), E>,
) -> Result<Staged, E> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if fs::metadata(&target).is_ok_and(|found| !found.is_file()) {
        fill_file(OpenOptions::new().write(true).open(&target)?, fill)?;
        return Ok(Staged { place: None });
    }
    if let Some(folder) = target.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder)?;
    }
    let (temporary, file) = Temporary::beside(&target)?;
    if let Ok(found) = fs::metadata(&target) {
        // Set before the first byte, so that private contents stay private. Some network drives
        // have no permissions; writing the file matters more.
        let _ = file.set_permissions(found.permissions());
    }
    fill_file(file, fill)?;
    Ok(Staged { place: Some((temporary, target)) })
}

fn fill_file<E: From<io::Error>>(
    file: File,
    fill: impl FnOnce(&mut dyn Write) -> Result<(), E>,
) -> Result<(), E> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    fill(&mut out)?;
    out.flush()?;
    Ok(())
}

/// Temporary files that currently exist.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    // A panic cannot leave a list of paths half-changed.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Marks a file to be deleted by [`abandon_files`].
pub(crate) fn mark_unfinished(path: &Path) {
    unfinished().push(path.to_owned());
}

/// Unmarks a file.
pub(crate) fn forget(path: &Path) {
    unfinished().retain(|other| other != path);
}

/// Temporary file, deleted on drop unless it was renamed.
struct Temporary(Option<PathBuf>);

impl Temporary {
    fn beside(target: &Path) -> io::Result<(Self, File)> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let name = target.file_name().unwrap_or_default().to_string_lossy().into_owned();
        loop {
            let number = NEXT.fetch_add(1, Ordering::Relaxed);
            let path = target.with_file_name(format!(".{name}.{}-{number}", std::process::id()));
            // Locked while the file is created, so that `abandon_files` misses none.
            let mut unfinished = unfinished();
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => {
                    unfinished.push(path.clone());
                    return Ok((Self(Some(path)), file));
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    fn rename(mut self, target: &Path) -> io::Result<()> {
        let path = self.0.as_ref().expect("renamed once");
        fs::rename(path, target)?;
        forget(path);
        self.0 = None;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(path) = self.0.take() {
            // The error that led here is the one to report.
            let _ = fs::remove_file(&path);
            forget(&path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_keeps_the_old_file_and_leaves_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").unwrap();
        let failed = replace(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("no more"))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        replace::<io::Error>(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn an_abandoned_file_is_gone_and_the_old_one_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_file(&path, b"old").unwrap();
        let failed = replace(&path, |out| {
            out.write_all(b"half")?;
            let own = |other: &PathBuf| other.starts_with(folder.path());
            let listed = unfinished().iter().filter(|other| own(other)).count();
            assert_eq!((listed, fs::read_dir(folder.path())?.count()), (1, 2));
            // Like `abandon_files`, without the files of other tests.
            let half = unfinished().iter().find(|other| own(other)).cloned();
            fs::remove_file(half.unwrap())
        });
        assert!(failed.is_err(), "there is nothing to rename");
        assert!(!unfinished().iter().any(|other| other.starts_with(folder.path())));
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn what_a_killed_process_left_goes_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let names = [
            ".a.ply.4194305-0",
            ".a.ply.4194305-x",
            ".a.ply.17",
            ".ba.ply.1-1",
            "a.ply.1-1",
            "a.ply",
        ];
        names.iter().for_each(|name| fs::write(folder.path().join(name), name).unwrap());
        remove_abandoned([folder.path().join("a.ply").as_path()]);
        let left = names.map(|name| folder.path().join(name).exists());
        assert_eq!(left, [false, true, true, true, true, true]);
    }

    #[cfg(unix)]
    #[test]
    fn a_file_keeps_its_permissions() {
        use std::os::unix::fs::PermissionsExt;

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").unwrap();
        for mode in [0o600, 0o664, 0o444] {
            fs::set_permissions(&path, PermissionsExt::from_mode(mode)).unwrap();
            replace::<io::Error>(&path, |out| out.write_all(b"new")).unwrap();
            assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, mode);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_a_device_a_device() {
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        replace::<io::Error>(&link, |out| out.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&real).unwrap(), b"new");
        replace::<io::Error>(Path::new("/dev/null"), |out| out.write_all(b"gone")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
