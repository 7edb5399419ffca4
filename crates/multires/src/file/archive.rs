//! Reads a file: all of it, its first part, or what a query needs.

use super::decoder_state::DecoderState;
use super::header::{self, FIXED_LEN, Header, Section};
use super::source::{Source, read_range};
use super::{FileError, Storage, base, chunk, write};
use crate::bounds::ErrorKind;
use crate::cut::{Certificate, Cut};
use crate::forest::Forest;
use crate::implicit::Implicit;
use crate::level::Level;
use crate::model::Model;
use crate::query::Criterion;
use crate::query::Query;

/// A `.mlod` file: all levels of a mesh, the coarsest first.
#[derive(Debug)]
pub struct Archive<S> {
    source: S,
    pub(super) header: Header,
    /// How many of its chunks are complete.
    complete: usize,
}

/// What a query reads of a file.
#[derive(Clone, Debug)]
pub struct Extract {
    /// The answer.
    pub level: Level,
    /// How many chunks were read for it.
    pub chunks: usize,
    /// How many updates those have.
    pub updates: usize,
    /// How many bytes of the file were read.
    pub bytes: u64,
}

impl Archive<Vec<u8>> {
    /// The bytes of a `.mlod` file with all levels, and the proof that none of them has a crack.
    ///
    /// Vertices are moved to a lattice, as far as the storage says; those of the input stay where they are
    /// where the forest keeps them [to the bit](Forest::lossless). Errors are rounded up, by a sixteenth at
    /// most. Cost: linear.
    /// # Errors
    /// More vertices than are numbered; a rounding below 0 or beyond the diagonal. What has no certificate is
    /// not written.
    pub fn write(forest: &Forest, storage: &Storage) -> Result<(Vec<u8>, Certificate), FileError> {
        write::write(forest, storage)
    }

    /// Writes the checksums that fit into bytes that were changed, for tests of [`Archive::read`].
    #[doc(hidden)]
    pub fn rewrite_checksums(bytes: &mut [u8]) {
        header::rewrite_checksums(bytes);
    }
}

impl<S: Source> Archive<S> {
    /// Reads what a file starts with.
    /// # Errors
    /// One that is something else, damaged, or ends before its coarsest mesh does.
    pub fn open(source: S) -> Result<Self, FileError> {
        let length = source.length()?;
        let start = read_range(&source, 0, FIXED_LEN as u64, "the header")?;
        let header = Header::length(&start)? as u64;
        let header = Header::from_bytes(&read_range(&source, 0, header, "the index")?)?;
        let mut this = Self { source, header, complete: 0 };
        let there = this.chunk_ends().take_while(|&end| end <= length).count();
        let truncated = FileError::Truncated { at: length, what: "the coarsest mesh" };
        this.complete = there.checked_sub(1).ok_or(truncated)?;
        match this.chunk_ends().last() {
            Some(at) if at < length => Err(FileError::TrailingData { at }),
            _ => Ok(this),
        }
    }

    /// How many chunks of updates the file is to have.
    pub fn chunk_count(&self) -> usize {
        self.header.chunks.len()
    }

    /// How many of its chunks are there; the rest is cut off, and only missing.
    pub fn complete_chunks(&self) -> usize {
        self.complete
    }

    /// Where the coarsest mesh ends, and each chunk.
    pub fn chunk_ends(&self) -> impl Iterator<Item = u64> + '_ {
        let base = self.header.len() + u64::from(self.header.base.bytes);
        let sizes = self.header.chunks.iter().map(|chunk| u64::from(chunk.stored.bytes));
        let ends = sizes.scan(base, |end, size| {
            *end += size;
            Some(*end)
        });
        std::iter::once(base).chain(ends)
    }

    /// How many updates the file is to have.
    pub fn update_count(&self) -> usize {
        self.header.updates()
    }

    /// What the errors of its updates are.
    pub fn error_kind(&self) -> ErrorKind {
        self.header.about.error_kind
    }

    /// How many faces the coarsest mesh has.
    pub fn base_faces(&self) -> usize {
        self.header.base_faces as usize
    }

    /// Where its bytes are.
    pub fn into_source(self) -> S {
        self.source
    }

    /// The diagonal of the finest mesh, in model units.
    pub fn diagonal(&self) -> f64 {
        self.header.diagonal
    }

    /// Whether the vertices of the finest mesh are where they were in the input, to the bit: that level is
    /// off by 0, whatever [`rounding`](Self::rounding) says. Those of other levels are if they are of the
    /// finest, too.
    pub fn is_lossless(&self) -> bool {
        self.header.lossless
    }

    /// By how much a vertex was moved to the file's lattice at most, in model units. In a
    /// [lossless](Self::is_lossless) file those of the input were not moved: it is the others', which only
    /// coarser levels have.
    pub fn rounding(&self) -> f64 {
        self.header.rounding
    }

    /// All levels, and the proof that none has a crack.
    /// # Errors
    /// A file that is damaged, or made to mislead.
    pub fn read(&self) -> Result<(Implicit, Certificate), FileError> {
        self.read_chunks(self.complete)
    }

    /// The levels of so many chunks from the start, and the proof that none has a crack. Of all chunks of a
    /// lossless file, that the finest has its positions to the bit.
    /// # Errors
    /// A file that is damaged, or made to mislead.
    pub fn read_chunks(&self, count: usize) -> Result<(Implicit, Certificate), FileError> {
        let state = self.load(&(0..count.min(self.complete)).collect::<Vec<_>>())?;
        let updates = state.updates.len();
        let model = self.assemble(state);
        if model.update_count() != updates {
            return Err(FileError::Section {
                section: "the updates".into(),
                why: "some split what another splits".into(),
            });
        }
        if count.min(self.complete) == self.header.chunks.len() {
            self.check_lossless(&model)?;
        }
        let certificate = model.certify()?;
        Ok((model, certificate))
    }

    /// Whether what is lossless has the position of every vertex of the finest mesh.
    fn check_lossless(&self, model: &Implicit) -> Result<(), FileError> {
        let is_leaf = |&node: &u32| model.update_of(node).is_none();
        let leaves = (0..model.node_count() as u32).filter(is_leaf);
        let bare = leaves.filter(|&leaf| model.exact().get(leaf).is_none()).count();
        if !self.is_lossless() || bare == 0 {
            return Ok(());
        }
        let why = format!("{bare} of its vertices have no position to the bit in a lossless file");
        Err(FileError::Section { section: "the finest mesh".into(), why })
    }

    /// The best cut with at most so many faces, as [`Extractor::at_most`](crate::Extractor::at_most).
    /// Of a uniform query only those chunks are read that may have a part in it.
    /// # Errors
    /// A query that is none; a file that is damaged, or made to mislead.
    pub fn extract_at_most(&self, faces: usize, query: &Query<'_>) -> Result<Extract, FileError> {
        let is_uniform = Criterion::new(query, &self.header.about.frame)?.is_uniform();
        let mut chunks = if is_uniform { self.chunks_for_faces(faces) } else { self.complete };
        loop {
            let model = Model::from_certified(&self.read_chunks(chunks)?.0);
            let level = model.extractor().at_most(faces, query)?.clone();
            // What is as urgent as something that was made may be in chunks further on.
            let least = model.implicit().least_error_above(&level.nodes).get();
            let rest = &self.header.chunks[chunks..self.complete];
            let urgent = rest.iter().rposition(|chunk| chunk.area.error >= least);
            let Some(more) = urgent.filter(|_| is_uniform) else {
                let bytes = self.chunk_ends().nth(chunks).unwrap_or(0);
                let updates = model.implicit().update_count();
                return Ok(Extract { level, chunks, updates, bytes });
            };
            chunks += more + 1;
        }
    }

    /// How many chunks it takes to have so many faces.
    fn chunks_for_faces(&self, faces: usize) -> usize {
        let mut all = self.header.base_faces as usize;
        let chunks = self.header.chunks[..self.complete].iter();
        let needed = chunks.take_while(|chunk| {
            let is_needed = all < faces;
            all = all.saturating_add(chunk.faces as usize);
            is_needed
        });
        needed.count()
    }

    /// The answer to a query. Reads only what it takes: chunks whose area the query wants.
    ///
    /// Nothing is proved here: a file that was made to mislead, with checksums that fit, may give a mesh
    /// with cracks. [`Archive::read`] finds that out.
    /// # Errors
    /// A query that is none; a file that is damaged.
    pub fn extract(&self, query: &Query<'_>) -> Result<Extract, FileError> {
        let criterion = Criterion::new(query, &self.header.about.frame)?;
        let wanted = |&chunk: &usize| criterion.may_refine_in(&self.header.chunks[chunk].area);
        let chunks: Vec<usize> = (0..self.complete).filter(wanted).collect();
        let state = self.load(&chunks)?;
        let stored = chunks.iter().map(|&chunk| u64::from(self.header.chunks[chunk].stored.bytes));
        let bytes = self.chunk_ends().next().unwrap_or(0) + stored.sum::<u64>();
        let updates = state.updates.len();
        let model = self.assemble(state);
        let level = Cut::at(&model, query)?.level();
        Ok(Extract { level, chunks: chunks.len(), updates, bytes })
    }

    fn assemble(&self, state: DecoderState) -> Implicit {
        let (base, updates, exact) = state.into_parts();
        Implicit::assemble(self.header.about, base, &updates, &exact)
    }

    /// The base and some chunks, by rising numbers.
    fn load(&self, chunks: &[usize]) -> Result<DecoderState, FileError> {
        let mut state = self.read_base()?;
        let (mut first, mut wanted) = (0, chunks.iter().peekable());
        for (at, (entry, offset)) in self.header.chunks.iter().zip(self.chunk_ends()).enumerate() {
            if wanted.next_if(|&&chunk| chunk == at).is_some() {
                let name = || format!("chunk {at}");
                let bytes = self.read_section(offset, entry.stored, name)?;
                let read = chunk::read(&mut state, &bytes, first, entry.updates as usize);
                read.map_err(|why| FileError::Section { section: name(), why: why.to_string() })?;
            }
            first += entry.updates;
        }
        Ok(state)
    }

    fn read_base(&self) -> Result<DecoderState, FileError> {
        let name = || "the coarsest mesh".to_owned();
        let bytes = self.read_section(self.header.len(), self.header.base, name)?;
        let read = base::read(&self.header, &bytes);
        read.map_err(|why| FileError::Section { section: name(), why: why.to_string() })
    }

    /// A piece of the file that is what was written.
    fn read_section(
        &self,
        offset: u64,
        stored: Section,
        name: impl Fn() -> String,
    ) -> Result<Vec<u8>, FileError> {
        let bytes = read_range(&self.source, offset, u64::from(stored.bytes), "a chunk")?;
        if Section::of(&bytes) == stored { Ok(bytes) } else { Err(FileError::Checksum(name())) }
    }
}
