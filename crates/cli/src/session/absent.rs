//! Files that are not there: what was probably meant.

use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use meshlod::{FileKind, IoError};

use crate::session::failure::Failure;
use crate::session::{files, patterns};

/// Makes the failure of a file that cannot be read; says what is meant if there is none.
pub fn failure(error: IoError) -> Failure {
    let path = error.path().to_owned();
    match &error {
        IoError::System { source, .. } if source.kind() == ErrorKind::NotFound => {
            match tip(&path) {
                Some(tip) => Failure::new(format_args!("{error}; {tip}")).about(&path),
                None => error.into(),
            }
        }
        _ => error.into(),
    }
}

fn tip(path: &Path) -> Option<String> {
    let name = files::name(path);
    if name.contains("://") {
        return Some("download it first".into());
    }
    if patterns::is_pattern(path) {
        return Some(format!("patterns are for batch: meshlod batch '{name}' OUT"));
    }
    if name.starts_with('~') {
        return Some("~ is a folder only outside quotes".into());
    }
    Some(format!("did you mean {}?", files::name(&similar(path)?)))
}

/// Finds a file of the same name in any case, or for a mesh one with another suffix.
fn similar(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let is_mesh = |path: &Path| matches!(FileKind::of_path(path), Ok(FileKind::Mesh(_)));
    let same = |a: Option<&OsStr>, b: Option<&OsStr>| {
        a.zip(b).is_some_and(|(a, b)| a.eq_ignore_ascii_case(b))
    };
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
    let names = entries.filter_map(|entry| Some(PathBuf::from(entry.ok()?.file_name())));
    let alike = names.filter(|name| same(name.file_stem(), path.file_stem()));
    let ranked = alike.map(|name| (!same(name.extension(), path.extension()), name));
    let fits = |(differs, name): &(bool, PathBuf)| !differs || is_mesh(name) && is_mesh(path);
    let (_, found) = ranked.filter(fits).min()?;
    Some(folder.map_or(found.clone(), |folder| folder.join(found)))
}
