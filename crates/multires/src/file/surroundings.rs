//! Everything that a file holds around the focus of a query, to check the answer.

use super::archive::Archive;
use super::source::Source;
use super::{Extract, FileError};
use crate::cut::{Cut, Flaw};
use crate::implicit::Implicit;
use crate::query::{Limits, Query};

/// Section of a `.mlod` file around the focus of a query, at all levels.
///
/// A cut of the model has the finest triangles of the file wherever a point of the focus may be
/// compared with one of them, and at least the coarsest elsewhere.
#[derive(Clone, Debug)]
pub struct Surroundings {
    /// Model of the chunks that were read. It is not certified.
    pub model: Implicit,
    /// Distances that the query allows.
    pub limits: Limits,
    /// Number of chunks of updates read from the file.
    pub chunks: usize,
    /// Number of bytes read from the file.
    pub bytes: u64,
}

impl<S: Source> Archive<S> {
    /// Reads all levels around the focus of a query, within the distance that it allows.
    ///
    /// Only wedges of an extracted level are checked: see [`Archive::extract`].
    /// # Errors
    /// An invalid query, one whose tolerance is a field, or a damaged file.
    pub fn around(&self, query: &Query<'_>) -> Result<Surroundings, FileError> {
        let limits = Limits::new(query, &self.header.about.frame)?;
        let wanted = |&chunk: &usize| limits.concern_area(&self.header.chunks[chunk].area);
        let chunks: Vec<usize> = (0..self.complete_chunks()).filter(wanted).collect();
        let model = self.load(&chunks)?.assemble(self.header.about)?;
        let stored = chunks.iter().map(|&chunk| u64::from(self.header.chunks[chunk].stored.bytes));
        let bytes = self.chunk_ends().next().unwrap_or(0) + stored.sum::<u64>();
        Ok(Surroundings { model, limits, chunks: chunks.len(), bytes })
    }
}

impl Surroundings {
    /// Returns the mesh of a cut of the model, with what was read.
    /// # Errors
    /// A file that was crafted to mislead about wedges.
    pub fn extract(&self, cut: &Cut<'_>) -> Result<Extract, FileError> {
        let level = cut.level();
        if !level.has_own_wedges() {
            return Err(FileError::Section {
                section: "the attributes".into(),
                why: Flaw::BadWedge.to_string(),
            });
        }
        let updates = self.model.update_count();
        Ok(Extract { level, chunks: self.chunks, updates, bytes: self.bytes })
    }
}
