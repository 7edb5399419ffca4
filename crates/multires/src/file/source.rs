//! Where the bytes of a file are.

use std::fs::File;
use std::io::{self, Read};

use super::FileError;

/// Bytes that can be read from any place on, by several at once: a file, a piece of memory, a range
/// request.
pub trait Source {
    /// How many there are.
    /// # Errors
    /// Of the place where they are.
    fn length(&self) -> io::Result<u64>;

    /// Fills `bytes` with those from `at` on.
    /// # Errors
    /// Fewer bytes, or of the place where they are.
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

/// So many bytes, which are not asked for before they are known to be there.
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
