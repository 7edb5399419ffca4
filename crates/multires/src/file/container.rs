//! Detection, from its first bytes, of what a multiresolution file holds.

use super::archive::{Archive, Extract};
use super::source::{Source, read_range};
use super::{FileError, VERSION};
use crate::hierarchy::Hierarchy;
use crate::level::Level;
use crate::query::{Focus, Query, Tolerance};
use crate::rtin::{FieldBytesError, Fit, HeightField, HeightPrecision, Rtin, RtinExtractor};

/// Open multiresolution file, which stores either the contractions of a mesh or a height field.
#[derive(Debug)]
pub enum ModelFile<S> {
    /// A file that stores the contractions of a mesh.
    Contractions(Archive<S>),
    /// A file that stores a height field, from which [`Rtin`](crate::Rtin) builds all levels.
    HeightField(HeightField, FieldParts),
}

/// Parts of a stored height field, one for each halving of its triangles, coarsest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldParts {
    /// Number of parts that the file holds in full.
    pub complete: u32,
    /// Number of parts of the whole field.
    pub all: u32,
    /// Length of the file in bytes.
    pub bytes: u64,
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
    /// Both may be truncated: then the finest levels are missing.
    /// # Errors
    /// A file of another format, a damaged file, or one that ends before its coarsest level.
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
        // Of a truncated file each part has a checksum, but the header has none.
        let is_whole = body <= length - BODY as u64;
        if is_whole && crc32fast::hash(&bytes[LENGTH..]) != checksum {
            return Err(FileError::Checksum("the height field".into()));
        }
        let read = match is_whole {
            true => HeightField::from_prefix(&bytes[BODY..], length - BODY as u64),
            false => HeightField::from_prefix(&bytes[BODY..], body),
        };
        let (field, [complete, all]) = read.map_err(|error| match error {
            FieldBytesError::Short { .. } if !is_whole => {
                FileError::Truncated { at: length, what: "the coarsest height field" }
            }
            error => error.into(),
        })?;
        if !is_whole && complete == all {
            // Nothing is missing, so the stated length is wrong.
            return Err(FileError::Checksum("the height field".into()));
        }
        Ok(Self::HeightField(field, FieldParts { complete, all, bytes: length }))
    }
}

impl<S: Source> ModelFile<S> {
    /// Returns the number of chunks that are there and that a whole file has; a height field counts
    /// its [parts](FieldParts). The first is less in a truncated file.
    pub fn pieces(&self) -> [usize; 2] {
        match self {
            Self::Contractions(archive) => [archive.complete_chunks(), archive.chunk_count()],
            Self::HeightField(_, parts) => [parts.complete, parts.all].map(|n| n as usize),
        }
    }

    /// Returns the word for one of the [pieces](Self::pieces) of the file.
    pub fn piece_name(&self) -> &'static str {
        match self {
            Self::Contractions(_) => "chunk",
            Self::HeightField(..) => "part",
        }
    }

    /// Reads all levels that the file holds into memory, where a
    /// [`HierarchyCut`](crate::HierarchyCut) can follow queries. Of a truncated file these are the
    /// coarser ones.
    ///
    /// Contractions are certified: no cut has a crack. Errors of a height field are measured again.
    /// # Errors
    /// A damaged file.
    pub fn read(&self) -> Result<Hierarchy, FileError> {
        match self {
            Self::Contractions(archive) => Ok(archive.read()?.0.into()),
            Self::HeightField(field, _) => Ok(Rtin::new(field).into()),
        }
    }

    /// Extracts the mesh that satisfies a query, reading only what it needs. A height field has been
    /// read whole, and its parts count as chunks.
    /// # Errors
    /// An invalid query, or a damaged file.
    pub fn extract(&self, query: &Query<'_>) -> Result<Extract, FileError> {
        match self {
            Self::Contractions(archive) => archive.extract(query),
            Self::HeightField(field, parts) => {
                Ok(of_field(parts, field, Rtin::new(field).level(query)?))
            }
        }
    }

    /// Extracts the finest mesh of at most `faces` faces for a query, or the coarsest mesh if that
    /// has more.
    /// # Errors
    /// An invalid query, or a damaged file.
    pub fn extract_at_most(&self, faces: usize, query: &Query<'_>) -> Result<Extract, FileError> {
        match self {
            Self::Contractions(archive) => archive.extract_at_most(faces, query),
            Self::HeightField(field, parts) => {
                let model = Rtin::new(field);
                let level = RtinExtractor::new(&model).at_most(faces, query)?.clone();
                Ok(of_field(parts, field, level))
            }
        }
    }

    /// Returns the point of the finest surface in the file that is closest to a point in model
    /// units; `None` if the surface is empty.
    ///
    /// Cost: that of a query for a ball of up to four times the distance.
    /// # Errors
    /// A coordinate that is not finite, or a damaged file.
    pub fn closest_point(&self, point: [f64; 3]) -> Result<Option<[f64; 3]>, FileError> {
        match self {
            Self::Contractions(archive) => archive.closest_point(point),
            Self::HeightField(field, _) => Ok(Rtin::new(field).closest_point(point)?),
        }
    }

    /// Moves the focus of a query from a point to the closest point of the finest surface, and
    /// returns that point with the query; any other query stays as it is.
    ///
    /// The faces of the level that are [nearest](Level::nearest) to it satisfy the tolerance: with a
    /// uniform one, the focus is the ball about it in which they are. If the level has at most
    /// `max_faces` faces, the tolerance means little and the focus is the point itself.
    /// # Errors
    /// A coordinate that is not finite, or a damaged file.
    pub fn at_surface<'f>(
        &self,
        query: &Query<'f>,
        max_faces: Option<usize>,
    ) -> Result<(Query<'f>, Option<[f64; 3]>), FileError> {
        let Focus::Point(point) = query.focus else { return Ok((query.clone(), None)) };
        let Some(center) = self.closest_point(point)? else { return Ok((query.clone(), None)) };
        let focus = match query.tolerance {
            Tolerance::Uniform(radius) if radius.is_finite() && max_faces.is_none() => {
                Focus::Sphere { center, radius }
            }
            _ => Focus::Point(center),
        };
        Ok((Query { focus, tolerance: query.tolerance.clone() }, Some(center)))
    }

    /// Returns the bounding-box diagonal of the finest mesh, in model units.
    pub fn diagonal(&self) -> f64 {
        match self {
            Self::Contractions(archive) => archive.diagonal(),
            Self::HeightField(field, _) => field.bounds().diagonal(),
        }
    }

    /// Returns the vertical axis of a height field, 0 to 2; `None` for other surfaces.
    pub fn up(&self) -> Option<usize> {
        match self {
            Self::Contractions(_) => None,
            Self::HeightField(field, _) => Some(field.axis()),
        }
    }
}

fn of_field(parts: &FieldParts, field: &HeightField, level: Level) -> Extract {
    let (chunks, updates) = (parts.complete as usize, field.heights().len());
    Extract { level, chunks, updates, bytes: parts.bytes }
}

impl HeightField {
    /// Encodes the height field as the bytes of a `.mlod` file, and says how far its finest level is
    /// from the mesh, with the rounding of heights.
    /// # Errors
    /// A precision with an invalid error bound.
    pub fn to_file(&self, precision: HeightPrecision) -> Result<(Vec<u8>, Fit), FileError> {
        let (body, fit) = self.encoded(precision)?;
        let rest = [&(body.len() as u64).to_le_bytes()[..], &body].concat();
        let checksum = crc32fast::hash(&rest).to_le_bytes();
        Ok(([&FIELD_MAGIC[..], &VERSION.to_le_bytes(), &checksum, &rest].concat(), fit))
    }
}
