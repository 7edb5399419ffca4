//! Errors of tiles, as those of a job.

use std::error::Error;
use std::io;

use meshlod_io::IoError;
use meshlod_tiles::TilesError;
use meshlod_tiles::folder::Folder;

use crate::jobs::JobError;

/// Returns the error of a folder that has no plan.
pub(super) fn no_plan(folder: &Folder) -> JobError {
    JobError::request("", format!("{}: no plan of tiles", folder.path().display()))
}

/// Says which part of the job an error is about.
pub(super) fn failure(error: TilesError) -> JobError {
    match error {
        TilesError::NoFaces | TilesError::NoExtent => JobError::input(error),
        TilesError::NoTask { .. } | TilesError::NotDone { .. } | TilesError::Missing { .. } => {
            JobError::request("", error)
        }
        TilesError::Io(error @ IoError::Parse { .. }) => JobError::input(error),
        error => JobError::output(at_file(error)),
    }
}

/// Says that an error is about what a job reads.
pub(super) fn failure_of_input(error: TilesError) -> JobError {
    JobError::input(at_file(error))
}

/// Makes an error that names a file one of that file, so that no program puts another one before it.
fn at_file(error: TilesError) -> Box<dyn Error + Send + Sync> {
    match error {
        TilesError::Io(error) => error.into(),
        error => match error.place() {
            Some((path, reason)) => IoError::system(path, io::Error::other(reason)).into(),
            None => error.into(),
        },
    }
}
