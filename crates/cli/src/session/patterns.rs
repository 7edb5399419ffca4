//! Patterns that stand for several files, such as `in/**/*.glb`.

use std::path::{Path, PathBuf};

use glob::{MatchOptions, glob_with};
use meshlod::FileKind;

use crate::session::failure::Failure;

/// Names that begin with a dot are hidden, as they are to shells: unfinished files have such names.
const MATCHING: MatchOptions = MatchOptions {
    case_sensitive: true,
    require_literal_separator: true,
    require_literal_leading_dot: true,
};

/// Reports whether a path is a pattern that no shell has replaced.
pub fn is_pattern(path: &Path) -> bool {
    path.to_string_lossy().contains(['*', '?', '[']) && !path.exists()
}

/// Returns the paths that a pattern matches, in order; `text` is the pattern as it is searched.
pub fn matches(pattern: &Path, text: &str) -> Result<Vec<PathBuf>, Failure> {
    let paths = glob_with(text, MATCHING).map_err(|error| Failure::at(pattern, error))?;
    paths.map(|path| path.map_err(|error| Failure::at(error.path(), error.error()))).collect()
}

/// Returns the files that a pattern matches and that we read.
///
/// # Errors
/// If there are none.
pub fn files_of(pattern: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut files = matches(pattern, &pattern.to_string_lossy())?;
    files.retain(|path| path.is_file() && FileKind::of_path(path).is_ok());
    match files.is_empty() {
        true => Err(Failure::at(pattern, "no file of a format that is read")),
        false => Ok(files),
    }
}
