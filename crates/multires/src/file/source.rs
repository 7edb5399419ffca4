//! Random access to the bytes of a file.

use std::fs::File;
use std::io::{self, Read};

use super::FileError;

/// Random-access source of bytes that several threads can read at once: a file, a buffer in memory,
/// or a server that answers range requests.
pub trait Source {
    /// Returns the total number of bytes.
    /// # Errors
    /// Any I/O error of the underlying storage.
    fn length(&self) -> io::Result<u64>;

    /// Fills `bytes` with the bytes from offset `at` on.
    /// # Errors
    /// Fewer bytes than requested, or any I/O error of the underlying storage.
    fn read_at(&self, at: u64, bytes: &mut [u8]) -> io::Result<()>;
}

impl Source for File {
    fn length(&self) -> io::Result<u64> {
        Ok(self.metadata()?.len())
    }

    #[cfg(unix)]
    fn read_at(&self, at: u64, bytes: &mut [u8]) -> io::Result<()> {
        std::os::unix::fs::FileExt::read_exact_at(self, bytes, at)
    }

    #[cfg(windows)]
    fn read_at(&self, mut at: u64, mut bytes: &mut [u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            match std::os::windows::fs::FileExt::seek_read(self, bytes, at)? {
                0 => return Err(io::ErrorKind::UnexpectedEof.into()),
                read => {
                    at += read as u64;
                    bytes = &mut bytes[read..];
                }
            }
        }
        Ok(())
    }
}

impl Source for Vec<u8> {
    fn length(&self) -> io::Result<u64> {
        Ok(self.len() as u64)
    }

    fn read_at(&self, at: u64, bytes: &mut [u8]) -> io::Result<()> {
        let from = usize::try_from(at).ok().and_then(|at| self.get(at..));
        let mut rest = from.ok_or(io::ErrorKind::UnexpectedEof)?;
        rest.read_exact(bytes)
    }
}

/// Reads `count` bytes, and allocates nothing before it knows that they exist.
pub(super) fn read_range(
    source: &impl Source,
    at: u64,
    count: u64,
    what: &'static str,
) -> Result<Vec<u8>, FileError> {
    let length = source.length()?;
    if at.checked_add(count).is_none_or(|end| end > length) {
        return Err(FileError::Truncated { at: length, what });
    }
    let mut bytes = vec![0; count as usize];
    source.read_at(at, &mut bytes)?;
    Ok(bytes)
}
