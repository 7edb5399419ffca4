//! Pictures that chapters make, compared with those of the book.

use std::path::Path;

use anyhow::{Context, Result};

/// Folder of the pictures: from that of the chapters, and from where a chapter runs.
pub const FOLDER: &str = "pictures";
/// Largest picture, in bytes: the book is part of every clone.
const MAX_BYTES: usize = 60_000;

/// Picture that a chapter has made.
pub struct Picture {
    pub name: String,
    pub bytes: Vec<u8>,
}

/// Reads the files that were made in a folder, sorted by name.
pub fn made(folder: &Path) -> Result<Vec<Picture>> {
    let picture = |name: String| {
        let bytes = std::fs::read(folder.join(&name))?;
        anyhow::Ok(Picture { name, bytes })
    };
    names(folder)?.into_iter().map(picture).collect()
}

/// Compares pictures byte by byte with the files of the same names in `folder`, or writes them
/// there; lists those that differ and those that are too large.
pub fn settle(pictures: &[Picture], folder: &Path, write: bool) -> Result<Vec<String>> {
    let mut errors = Vec::new();
    for Picture { name, bytes } in pictures {
        if bytes.len() > MAX_BYTES {
            errors.push(format!("{name}: {} bytes, more than {MAX_BYTES}", bytes.len()));
        } else if write {
            std::fs::create_dir_all(folder)?;
            std::fs::write(folder.join(name), bytes)?;
        } else if std::fs::read(folder.join(name)).ok().as_ref() != Some(bytes) {
            errors.push(format!("{name}: the chapter draws another picture than the book shows"));
        }
    }
    Ok(errors)
}

/// Lists files in the folder that no chapter has made.
pub fn orphans(folder: &Path, made: &[String]) -> Result<Vec<String>> {
    let names = names(folder)?.into_iter().filter(|name| !made.contains(name));
    Ok(names.map(|name| format!("{name}: no chapter draws this picture")).collect())
}

fn names(folder: &Path) -> Result<Vec<String>> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let names = entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
    let mut names = names.collect::<Result<Vec<_>>>()?;
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(name: &str, bytes: usize) -> Picture {
        Picture { name: name.into(), bytes: vec![7; bytes] }
    }

    #[test]
    fn pictures_are_compared_and_only_written_when_asked() {
        let folder = tempfile::tempdir().unwrap();
        let settle =
            |bytes, write| settle(&[picture("a.png", bytes)], folder.path(), write).unwrap().len();
        assert_eq!(settle(10, false), 1, "missing");
        assert_eq!(settle(10, true), 0);
        assert_eq!(settle(10, false), 0, "equal");
        assert_eq!(settle(11, false), 1, "another");
        assert_eq!(settle(MAX_BYTES + 1, true), 1, "too large");
        assert_eq!(made(folder.path()).unwrap()[0].bytes.len(), 10);
    }

    #[test]
    fn pictures_that_nobody_draws_are_named() {
        let folder = tempfile::tempdir().unwrap();
        settle(&[picture("a.png", 1), picture("b.png", 1)], folder.path(), true).unwrap();
        assert_eq!(orphans(folder.path(), &["a.png".into()]).unwrap().len(), 1);
        assert_eq!(orphans(&folder.path().join("none"), &[]).unwrap(), [""; 0]);
    }
}
