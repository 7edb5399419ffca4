//! Bytes of documents that stay in files, and are read when they are needed.

use std::fmt::Debug;
use std::io;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// File that can be read at any place, by several threads at a time.
pub trait Store: Debug + Send + Sync {
    /// Returns the number of bytes.
    fn length(&self) -> u64;

    /// Fills `bytes` from a place of the file on.
    ///
    /// # Errors
    /// Errors of the system, and a file that ends before.
    fn read(&self, at: u64, bytes: &mut [u8]) -> io::Result<()>;
}

/// File that is written from its start to its end, to be read afterwards.
pub trait ScratchFile: Send {
    /// Appends bytes.
    ///
    /// # Errors
    /// Errors of the system, such as a full disk.
    fn add(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Ends writing.
    ///
    /// # Errors
    /// Errors of the system.
    fn finish(self: Box<Self>) -> io::Result<Arc<dyn Store>>;
}

/// Files that a document in passing is read from, and one for what is decompressed.
pub trait StoreFiles: Debug + Send + Sync {
    /// Opens a file for reading.
    ///
    /// # Errors
    /// Errors of the system.
    fn open(&self, path: &Path) -> io::Result<Arc<dyn Store>>;

    /// Makes an empty file.
    ///
    /// # Errors
    /// Errors of the system.
    fn scratch(&self) -> io::Result<Box<dyn ScratchFile>>;
}

/// Part of a file.
#[derive(Clone, Debug)]
pub(crate) struct StoredBytes {
    file: Arc<dyn Store>,
    start: u64,
    pub length: usize,
}

impl StoredBytes {
    /// Takes a range of a file, which must be in it.
    pub fn new(file: Arc<dyn Store>, range: Range<u64>) -> Self {
        let length = usize::try_from(range.end - range.start).unwrap_or(usize::MAX);
        Self { file, start: range.start, length }
    }

    /// Reads bytes that must be in the part.
    pub fn read(&self, at: usize, length: usize) -> io::Result<Vec<u8>> {
        let mut bytes = vec![0; length];
        self.file.read(self.start + at as u64, &mut bytes)?;
        Ok(bytes)
    }
}
