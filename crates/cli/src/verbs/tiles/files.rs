//! Files of a model, as the command reads them.

use std::path::{Path, PathBuf};

use meshlod::Scene;
use meshlod::io::Note;
use meshlod::jobs::{TileFileError, TileFiles, TileModel};

use crate::options::args::ReadArgs;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;

/// Opens files and the files in folders, as one model whose tiles or plan will be at `out`.
pub fn open(
    inputs: &[PathBuf],
    out: &Path,
    reading: &ReadArgs,
    session: &Session,
) -> Result<TileModel, Failure> {
    TileModel::open(inputs, out, &ReadFiles { reading, session })
}

/// The command as a reader of files.
struct ReadFiles<'a> {
    reading: &'a ReadArgs,
    session: &'a Session,
}

impl TileFiles for ReadFiles<'_> {
    type Error = Failure;

    fn is_read_whole(&self, path: &Path) -> bool {
        files::is_pipe(path) || self.reading.weld().is_some()
    }

    fn reading(&self) -> String {
        format!("{:?}", self.reading.options())
    }

    fn read(&self, path: &Path) -> Result<Scene, Failure> {
        files::read(path, self.reading, self.session)
    }

    fn note(&self, path: &Path, notes: &[Note]) -> Result<(), Failure> {
        self.session.note(path, notes)
    }

    fn warn(&self, path: Option<&Path>, text: &str) {
        match path {
            Some(path) => self.session.warn(Failure::at(path, text)),
            None => self.session.warn(text),
        }
    }
}

impl From<TileFileError> for Failure {
    fn from(error: TileFileError) -> Self {
        let path = error.path().to_owned();
        match error {
            TileFileError::Io(error) => error.into(),
            error => Self::new(error).about(&path),
        }
    }
}
