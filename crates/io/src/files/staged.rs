//! Several files that belong together, replaced as one.
//!
//! No system renames several files at once. Whenever the process ends, a document only ever refers
//! to parts of its own version:
//!
//! 1. Every file is written completely under a temporary name, the document included. A full disk
//!    shows here, and nothing has changed.
//! 2. Parts are renamed to names that the document there does not use with other contents
//!    ([`part_name`]), so that it stays what it was.
//! 3. The document is renamed, which makes the new version the valid one.
//! 4. Parts that only the old document used are removed.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use super::replace::{Staged, forget, mark_unfinished, stage};
use crate::error::IoError;
use crate::gltf::document::uri;

/// Files written under temporary names, to be renamed together.
#[derive(Default)]
pub(crate) struct StagedFiles {
    parts: Vec<(PathBuf, Staged)>,
    /// Folders created for the files, outermost first.
    folders: Vec<PathBuf>,
    is_done: bool,
}

impl StagedFiles {
    /// Writes a part with `fill` under a temporary name.
    ///
    /// # Errors
    /// Errors of the system and of `fill`, with the path.
    pub fn add(
        &mut self,
        path: &Path,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), IoError> {
        step("write", path)?;
        self.make_folders(path)?;
        let staged = stage(path, |out| fill(bounded(out).as_mut()));
        let staged = staged.map_err(|error| IoError::system(path, error))?;
        self.parts.push((path.to_owned(), staged));
        Ok(())
    }

    /// Reports whether a part was added for this place.
    pub fn has(&self, path: &Path) -> bool {
        self.parts.iter().any(|(other, _)| other == path)
    }

    /// Writes the document, renames the parts and then the document, and removes obsolete parts.
    ///
    /// # Errors
    /// Errors of the system and of `fill`. The old document then stays, and no new file is left.
    pub fn finish(
        mut self,
        document: &Path,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
        obsolete: &[PathBuf],
    ) -> Result<(), IoError> {
        let failed = |error| IoError::system(document, error);
        step("write", document)?;
        let staged = stage(document, |out| fill(bounded(out).as_mut())).map_err(failed)?;
        let mut created = Created(Vec::new());
        for (path, part) in std::mem::take(&mut self.parts) {
            step("rename", &path)?;
            let is_new = fs::symlink_metadata(&path).is_err();
            part.rename().map_err(|error| IoError::system(&path, error))?;
            if is_new {
                mark_unfinished(&path);
                created.0.push(path);
            }
        }
        step("rename", document)?;
        // Not to be abandoned from here on: the document may have come.
        created.0.iter().for_each(|path| forget(path));
        staged.rename().map_err(failed)?;
        created.0.clear();
        self.is_done = true;
        for path in obsolete {
            step("remove", path)?;
            // What cannot be removed is of no use, but does no harm.
            let _ = fs::remove_file(path);
        }
        Ok(())
    }

    /// Makes the folder of a file, and notes which folders were missing.
    fn make_folders(&mut self, path: &Path) -> Result<(), IoError> {
        let folders = path.ancestors().skip(1).filter(|folder| !folder.as_os_str().is_empty());
        let missing: Vec<&Path> = folders.take_while(|folder| !folder.exists()).collect();
        for folder in missing.into_iter().rev() {
            fs::create_dir(folder).map_err(|error| IoError::system(folder, error))?;
            self.folders.push(folder.to_owned());
        }
        Ok(())
    }
}

impl Drop for StagedFiles {
    fn drop(&mut self) {
        self.parts.clear();
        if !self.is_done {
            // One that is in use by now stays.
            self.folders.iter().rev().for_each(|folder| drop(fs::remove_dir(folder)));
        }
    }
}

/// New parts, removed on drop unless the document was renamed.
struct Created(Vec<PathBuf>);

impl Drop for Created {
    fn drop(&mut self) {
        for path in &self.0 {
            // The error that led here is the one to report.
            let _ = fs::remove_file(path);
            forget(path);
        }
    }
}

/// Chooses the name for a part of a document, `stem.suffix` or else `stem-2.suffix` and so on: the
/// first name that is not taken, for instance by the current document.
pub(crate) fn part_name(stem: &str, suffix: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let numbered = (2..).map(|number: u32| format!("{stem}-{number}.{suffix}"));
    let mut names = std::iter::once(format!("{stem}.{suffix}")).chain(numbered);
    names.find(|name| !is_taken(name)).unwrap_or_default()
}

/// Reports whether a name has the form that [`part_name`] gives parts.
pub(crate) fn is_part_name(name: &str, stem: &str, suffix: &str) -> bool {
    let middle =
        name.strip_prefix(stem).and_then(|rest| rest.strip_suffix(suffix)?.strip_suffix('.'));
    middle.is_some_and(|middle| {
        let number = middle.strip_prefix('-').and_then(|number| number.parse::<u32>().ok());
        middle.is_empty() || number.is_some_and(|number| number >= 2)
    })
}

/// Lists the old parts of a document that neither its new version nor another document in the
/// folder uses.
pub(crate) fn obsolete_parts(
    document: &Path,
    old: &BTreeSet<String>,
    is_own: impl Fn(&str) -> bool,
) -> Vec<PathBuf> {
    let of_no_use = old.iter().filter(|name| is_own(name) && !is_mentioned(document, name));
    of_no_use.map(|name| document.with_file_name(name)).collect()
}

/// Reports whether another file with the suffix of `document` in its folder mentions a name.
pub(crate) fn is_mentioned(document: &Path, name: &str) -> bool {
    let folder = document.parent().filter(|folder| !folder.as_os_str().is_empty());
    let Ok(files) = fs::read_dir(folder.unwrap_or(Path::new("."))) else { return true };
    let same_suffix = |path: &PathBuf| {
        let [a, b] = [path.extension(), document.extension()];
        a.zip(b).is_some_and(|(a, b)| a.eq_ignore_ascii_case(b))
            && path.file_name() != document.file_name()
    };
    let paths = files.flatten().map(|entry| entry.path()).filter(same_suffix);
    let encoded = uri::of_file(name);
    let mentions = |path: PathBuf| contains(&path, &[name, &encoded]).unwrap_or(true);
    paths.into_iter().any(mentions)
}

/// Reports whether a file contains one of these texts.
fn contains(path: &Path, texts: &[&str]) -> io::Result<bool> {
    let longest = texts.iter().map(|text| text.len()).max().unwrap_or_default();
    let mut file = fs::File::open(path)?;
    let mut piece = Vec::new();
    loop {
        // The end of the last piece may be the beginning of a text.
        let kept = piece.len().min(longest);
        piece.drain(..piece.len() - kept);
        if Read::by_ref(&mut file).take(1 << 20).read_to_end(&mut piece)? == 0 {
            return Ok(false);
        }
        let has = |text: &&str| piece.windows(text.len().max(1)).any(|w| w == text.as_bytes());
        if texts.iter().any(has) {
            return Ok(true);
        }
    }
}

#[cfg(not(test))]
fn step(_: &str, _: &Path) -> Result<(), IoError> {
    Ok(())
}

#[cfg(not(test))]
fn bounded<'a>(out: &'a mut dyn Write) -> Box<dyn Write + 'a> {
    Box::new(out)
}

#[cfg(test)]
use super::staged::tests::{bounded, step};

#[cfg(test)]
mod tests;
