//! File names in mesh files.

use std::path::{Component, Path, PathBuf};

/// Returns the last part of an absolute path of any system, such as `/a/b.png` or `C:\a\b.png`;
/// `None` for a relative path, or several paths in a row.
pub(super) fn bare_name(name: &str) -> Option<&str> {
    let mut words = name.split_ascii_whitespace();
    let is_one = words.next().is_some_and(is_absolute) && !words.any(is_absolute);
    let bare = name.rsplit(['/', '\\']).next()?;
    (is_one && !matches!(bare, "" | "." | "..")).then_some(bare)
}

/// Returns a name as a path if joining it to a folder stays within that folder, on any system.
pub(crate) fn inner_path(name: &str) -> Option<PathBuf> {
    if bare_name(name).is_some() {
        return None;
    }
    let path = Path::new(name);
    let mut parts = path.components().filter(|part| *part != Component::CurDir).peekable();
    let is_empty = parts.peek().is_none();
    let inside = parts.all(|part| matches!(part, Component::Normal(_)));
    (inside && !is_empty).then(|| path.to_owned())
}

pub(super) fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn is_absolute(name: &str) -> bool {
    let is_separator = |byte: &u8| matches!(byte, b'/' | b'\\');
    match name.as_bytes() {
        [drive, b':', separator, ..] if drive.is_ascii_alphabetic() => is_separator(separator),
        [first, ..] => is_separator(first),
        [] => false,
    }
}
