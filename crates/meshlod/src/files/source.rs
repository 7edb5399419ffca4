//! Bytes of a file that is read in parts, from a disk or from memory.

use std::fs::File;
use std::io;

use meshlod_multires::Source;

/// Bytes of a file that is read in parts.
#[derive(Debug)]
pub enum FileBytes {
    /// A file on a disk; only the needed parts are read.
    Disk(File),
    /// A file that is in memory.
    Memory(Vec<u8>),
}

impl Source for FileBytes {
    fn length(&self) -> io::Result<u64> {
        match self {
            Self::Disk(file) => file.length(),
            Self::Memory(bytes) => bytes.length(),
        }
    }

    fn read_at(&self, at: u64, bytes: &mut [u8]) -> io::Result<()> {
        match self {
            Self::Disk(file) => file.read_at(at, bytes),
            Self::Memory(all) => all.read_at(at, bytes),
        }
    }
}
