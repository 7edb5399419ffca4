//! Detection, from its first bytes, of what a multiresolution file holds.

use super::archive::Archive;
use super::source::{Source, read_range};
use super::{FileError, VERSION};
use crate::rtin::{HeightField, HeightPrecision};

/// Open multiresolution file, which stores either the contractions of a mesh or a height field.
#[derive(Debug)]
pub enum ModelFile<S> {
    /// A file that stores the contractions of a mesh.
    Contractions(Archive<S>),
    /// A file that stores a height field, from which [`Rtin`](crate::Rtin) builds all levels.
    HeightField(HeightField),
}

/// Magic bytes of a file that holds a height field.
const FIELD_MAGIC: &[u8; 8] = b"meshlodh";
/// Offset of the checksum, which covers everything from `LENGTH` on.
const CHECKSUM: usize = 12;
/// Offset of the length of the body.
const LENGTH: usize = 16;
const BODY: usize = 24;

impl<S: Source> ModelFile<S> {
    /// Opens a multiresolution file of either format.
    ///
    /// A height field is read whole; of a file of contractions only the header and the index are.
    /// # Errors
    /// A file of another format, a damaged file, or one that ends too early.
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
    /// Encodes the height field as the bytes of a `.mlod` file.
    /// # Errors
    /// A precision with an invalid error bound.
    pub fn to_file(&self, precision: HeightPrecision) -> Result<Vec<u8>, FileError> {
        let body = self.to_bytes(precision)?;
        let rest = [&(body.len() as u64).to_le_bytes()[..], &body].concat();
        let checksum = crc32fast::hash(&rest).to_le_bytes();
        Ok([&FIELD_MAGIC[..], &VERSION.to_le_bytes(), &checksum, &rest].concat())
    }
}
