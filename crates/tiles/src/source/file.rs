//! Files that are read at any place, by several threads at a time.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use meshlod_io::{IoError, ParseError};

/// File that is open for reading; its errors name it.
#[derive(Debug)]
pub(crate) struct PlacedFile {
    file: File,
    path: PathBuf,
    /// Length in bytes.
    pub length: u64,
}

impl PlacedFile {
    pub fn open(path: &Path) -> io::Result<Self> {
        let named = |error| named(path, error);
        let file = File::open(path).map_err(named)?;
        let length = file.metadata().map_err(named)?.len();
        Ok(Self { file, path: path.to_owned(), length })
    }

    /// Takes a file without a name in a folder, which errors name instead.
    pub fn unnamed(file: File, folder: &Path) -> io::Result<Self> {
        let length = file.metadata().map_err(|error| named(folder, error))?.len();
        Ok(Self { file, path: folder.to_owned(), length })
    }

    /// Fills `bytes` from a place of the file.
    pub fn read(&self, at: u64, bytes: &mut [u8]) -> io::Result<()> {
        read_at(&self.file, at, bytes).map_err(|error| named(&self.path, error))
    }

    /// Returns the bytes from a place on: `most` of them, or fewer at the end of the file.
    pub fn part(&self, at: u64, most: usize) -> io::Result<Vec<u8>> {
        let there = usize::try_from(self.length.saturating_sub(at)).unwrap_or(usize::MAX);
        let mut bytes = vec![0; most.min(there)];
        self.read(at, &mut bytes)?;
        Ok(bytes)
    }

    /// Creates the error of contents that are not valid.
    pub fn invalid(&self, error: ParseError) -> io::Error {
        io::Error::new(io::ErrorKind::InvalidData, IoError::parse(&self.path, error))
    }

    /// Creates the error of contents that are not valid at a byte of the file.
    pub fn invalid_at(&self, byte: u64, reason: String) -> io::Error {
        self.invalid(ParseError::byte(usize::try_from(byte).unwrap_or(usize::MAX), reason))
    }
}

/// Puts the name of a file before an error of the system.
pub(super) fn named(path: &Path, error: io::Error) -> io::Error {
    io::Error::new(error.kind(), IoError::system(path, error))
}

#[cfg(unix)]
fn read_at(file: &File, at: u64, bytes: &mut [u8]) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, at)
}

#[cfg(windows)]
fn read_at(file: &File, mut at: u64, mut bytes: &mut [u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        match std::os::windows::fs::FileExt::seek_read(file, bytes, at)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            size => {
                at += size as u64;
                bytes = &mut bytes[size..];
            }
        }
    }
    Ok(())
}
