//! What kind of model a file holds, told by how it starts.

use super::archive::Archive;
use super::source::{Source, read_range};
use super::{FileError, VERSION};
use crate::rtin::{HeightField, HeightPrecision};

/// A multiresolution file of any kind.
#[derive(Debug)]
pub enum ModelFile<S> {
    /// The contractions of a mesh.
    Contractions(Archive<S>),
    /// A height field, for [`Rtin`](crate::Rtin).
    HeightField(HeightField),
}

/// How a file with a height field starts.
const FIELD_MAGIC: &[u8; 8] = b"meshlodh";
/// Where the checksum is, and what it is of starts.
const CHECKSUM: usize = 12;
/// Where the length of the rest is.
const LENGTH: usize = 16;
const BODY: usize = 24;

impl<S: Source> ModelFile<S> {
    /// Reads a height field, or what a file of contractions starts with.
    /// # Errors
    /// A file that is something else, damaged, or cut off too early.
    pub fn open(source: S) -> Result<Self, FileError> {
        let length = source.length()?;
        if length < BODY as u64 || read_range(&source, 0, 8, "its first word")? != FIELD_MAGIC {
            return Archive::open(source).map(Self::Contractions);
        }
        let bytes = read_range(&source, 0, length, "the height field")?;
        let [version, checksum] =
            [8, CHECKSUM].map(|at| u32::from_le_bytes(std::array::from_fn(|k| bytes[at + k])));
        if version != VERSION {
            return Err(FileError::Version(version));
        }
        let body = u64::from_le_bytes(std::array::from_fn(|k| bytes[LENGTH + k]));
        if body > length - BODY as u64 {
            return Err(FileError::Truncated { at: length, what: "the height field" });
        }
        if crc32fast::hash(&bytes[LENGTH..]) != checksum {
            return Err(FileError::Checksum("the height field".into()));
        }
        Ok(Self::HeightField(HeightField::from_bytes(&bytes[BODY..])?))
    }
}

impl HeightField {
    /// The bytes of a `.mlod` file of right triangles.
    /// # Errors
    /// A bound that is none.
    pub fn to_file(&self, precision: HeightPrecision) -> Result<Vec<u8>, FileError> {
        let body = self.to_bytes(precision)?;
        let rest = [&(body.len() as u64).to_le_bytes()[..], &body].concat();
        let checksum = crc32fast::hash(&rest).to_le_bytes();
        Ok([&FIELD_MAGIC[..], &VERSION.to_le_bytes(), &checksum, &rest].concat())
    }
}
