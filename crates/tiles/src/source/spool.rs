//! Files without a name that hold what is read again and in any order.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::file::{PlacedFile, named};

/// File of words of 32 bits, which goes with the process, whatever ends it.
pub(super) struct Spool {
    out: BufWriter<File>,
    folder: PathBuf,
    /// Number of words.
    pub words: u64,
    bytes: Vec<u8>,
}

impl Spool {
    /// Makes an empty file in a folder.
    pub fn new(folder: &Path) -> io::Result<Self> {
        let file = tempfile::tempfile_in(folder).map_err(|error| named(folder, error))?;
        let out = BufWriter::with_capacity(1 << 18, file);
        Ok(Self { out, folder: folder.to_owned(), words: 0, bytes: Vec::new() })
    }

    pub fn add(&mut self, words: impl IntoIterator<Item = u32>) -> io::Result<()> {
        self.bytes.clear();
        self.bytes.extend(words.into_iter().flat_map(u32::to_le_bytes));
        self.words += self.bytes.len() as u64 / 4;
        self.out.write_all(&self.bytes).map_err(|error| named(&self.folder, error))
    }

    /// Appends bytes, which are not counted.
    pub fn add_bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes).map_err(|error| named(&self.folder, error))
    }

    pub fn add_floats(&mut self, values: &[f32]) -> io::Result<()> {
        self.add(values.iter().map(|value| value.to_bits()))
    }

    /// Ends writing.
    pub fn finish(self) -> io::Result<PlacedFile> {
        let file =
            self.out.into_inner().map_err(|error| named(&self.folder, error.into_error()))?;
        PlacedFile::unnamed(file, &self.folder)
    }
}
