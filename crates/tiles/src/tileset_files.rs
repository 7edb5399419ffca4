//! Files of a tileset by their names: in a folder, or in an archive.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use crate::archive::{Archive, is_archive};
use crate::error::TilesError;

/// Files of a tileset.
pub(crate) struct TilesetFiles {
    path: PathBuf,
    archive: Option<Archive>,
}

impl TilesetFiles {
    /// Opens the tileset in a folder or archive.
    pub fn open(path: &Path) -> Result<Self, TilesError> {
        let open = || Archive::open(path).map_err(|error| unreadable(path, &error));
        let archive = if is_archive(path) && !path.is_dir() { Some(open()?) } else { None };
        Ok(Self { path: path.to_owned(), archive })
    }

    /// Returns the path of a file, for messages.
    pub fn path(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Reads a file.
    pub fn read(&self, name: &str) -> Result<Vec<u8>, TilesError> {
        let is_inside = |part: Component<'_>| matches!(part, Component::Normal(_));
        if !Path::new(name).components().all(is_inside) {
            let reason = format!("{name:?} is not a file of the tileset");
            return Err(TilesError::Unreadable { path: self.path.clone(), reason });
        }
        match &self.archive {
            Some(archive) => archive.read(name).map_err(|error| unreadable(&self.path, &error)),
            None => {
                let path = self.path(name);
                fs::read(&path).map_err(|error| TilesError::system(&path, error))
            }
        }
    }
}

fn unreadable(path: &Path, error: &io::Error) -> TilesError {
    TilesError::Unreadable { path: path.to_owned(), reason: error.to_string() }
}
