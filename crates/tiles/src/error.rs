//! Reasons why tiles cannot be made.

use std::io;
use std::path::{Path, PathBuf};

use meshlod_io::{IoError, Unsupported};
use thiserror::Error;

/// Reason why tiles cannot be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TilesError {
    /// The model has no faces.
    #[error("the model has no faces")]
    NoFaces,
    /// All vertices are at one place, or so far apart that their distance is not a number.
    #[error("the model has no extent that could be divided into tiles")]
    NoExtent,
    /// A file cannot be read or written.
    #[error(transparent)]
    Io(#[from] IoError),
    /// A file of the plan is damaged.
    #[error("{}: {reason}; remove its folder and make the plan again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Its fault.
        reason: String,
    },
    /// A file of a tile is damaged.
    #[error("{}: is cut off or changed; do task {task} again", path.display())]
    DamagedTile {
        /// The file.
        path: PathBuf,
        /// Number of the task that makes it.
        task: usize,
    },
    /// A disk has less room than the tiles need.
    #[error(
        "{}: the tiles and the files that they are made from need about {}, but {} are free there",
        path.display(), megabytes(*needs), megabytes(*free)
    )]
    NoSpace {
        /// Folder on the disk.
        path: PathBuf,
        /// Bytes that are needed, about.
        needs: u64,
        /// Bytes that are free.
        free: u64,
    },
    /// A file of a tileset is not what it should be.
    #[error("{}: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Its fault.
        reason: String,
    },
    /// A tileset that another program has made.
    #[error("{}: is not a tileset of meshlod, and only those can be checked", .0.display())]
    Foreign(PathBuf),
    /// A tile needs another one that has not been made.
    #[error("task {task} needs task {needs}, which is not done")]
    NotDone {
        /// Number of the task.
        task: usize,
        /// Number of the task that must be done before.
        needs: usize,
    },
    /// A tileset needs a tile that has not been made.
    #[error("task {task} is not done")]
    Missing {
        /// Number of the task.
        task: usize,
    },
    /// The plan has fewer tasks.
    #[error("there is no task {task}; the plan has {tasks}, from 0 on")]
    NoTask {
        /// Number that was asked for.
        task: usize,
        /// Number of tasks.
        tasks: usize,
    },
    /// A tile cannot be simplified.
    #[error("tile {tile}: {reason}")]
    Simplify {
        /// The tile.
        tile: String,
        /// Reason.
        reason: String,
    },
    /// A tile cannot be written as glTF.
    #[error("tile {tile}: {source}")]
    Content {
        /// The tile.
        tile: String,
        /// Reason.
        source: Unsupported,
    },
    /// Tiles of a level do not meet.
    #[error("tiles of depth {depth} do not meet; a tile file must have been changed")]
    Cracked {
        /// Depth of the level.
        depth: u8,
    },
}

impl TilesError {
    /// Returns an error of the system at a path, or at that of the source which it names.
    pub fn system(path: &Path, error: io::Error) -> Self {
        Self::Io(error.downcast().unwrap_or_else(|error| IoError::system(path, error)))
    }

    /// Returns the file that an error is about and the rest of its text, if it names one.
    pub fn place(&self) -> Option<(&Path, String)> {
        let (Self::Damaged { path, .. }
        | Self::DamagedTile { path, .. }
        | Self::NoSpace { path, .. }
        | Self::Unreadable { path, .. }
        | Self::Foreign(path)) = self
        else {
            return None;
        };
        let text = self.to_string();
        let rest = text.strip_prefix(&format!("{}: ", path.display()))?;
        Some((path, rest.to_owned()))
    }

    /// Returns the error of a damaged file.
    pub(crate) fn damaged(path: &Path, reason: impl ToString) -> Self {
        Self::Damaged { path: path.to_owned(), reason: reason.to_string() }
    }
}

/// Returns a number of bytes as megabytes, rounded up.
pub(crate) fn megabytes(bytes: u64) -> String {
    format!("{} MB", bytes.div_ceil(1_000_000))
}
