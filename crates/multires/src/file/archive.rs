//! Reading of a `.mlod` file: the whole file, a prefix of it, or the chunks that a query needs.

use meshlod_mesh::Bounds;

use super::decoder_state::DecoderState;
use super::header::{self, FIXED_LEN, Header, ResourceIndex, Section};
use super::layout::Layout;
use super::resources::{self, OLD_RESOURCES_LEN};
use super::source::{Source, read_range};
use super::{FileError, Storage, base, chunk, write};
use crate::cut::{Certificate, Cut, Flaw};
use crate::error_kind::ErrorKind;
use crate::forest::Forest;
use crate::implicit::Implicit;
use crate::level::Level;
use crate::model::Model;
use crate::query::{Criterion, Query, closest_point};

/// Open `.mlod` file that stores all levels of a mesh as its contractions, coarsest level first.
#[derive(Debug)]
pub struct Archive<S> {
    pub(super) source: S,
    pub(super) header: Header,
    pub(super) layout: Layout,
    /// Number of chunks that are present in full.
    complete: usize,
}

/// Mesh extracted from a `.mlod` file, with statistics of what was read to build it.
#[derive(Clone, Debug)]
pub struct Extract {
    /// Mesh that satisfies the query.
    pub level: Level,
    /// Number of chunks of updates read from the file.
    pub chunks: usize,
    /// Number of updates (vertex splits) in the chunks that were read.
    pub updates: usize,
    /// Number of bytes read from the file.
    pub bytes: u64,
}

impl Archive<Vec<u8>> {
    /// Encodes recorded contractions as a `.mlod` file in memory, open, and certifies that no cut of
    /// the model has a crack. [`into_source`](Self::into_source) gives the bytes.
    ///
    /// Vertices are rounded to a lattice as fine as `storage` demands. If the forest is
    /// [lossless](Forest::lossless), the input's vertices keep their exact positions. Errors are
    /// rounded up by at most a sixteenth. Cost: linear.
    /// # Errors
    /// Too many vertices, or a rounding that is negative or larger than the diagonal. A model that
    /// cannot be certified is not written.
    pub fn write(forest: &Forest, storage: &Storage) -> Result<(Self, Certificate), FileError> {
        Self::encode(forest.clone(), storage)
    }

    /// Encodes a forest that nobody needs any more, as [`write`](Self::write) does, but in its place:
    /// it is gone before its model is encoded.
    /// # Errors
    /// As for [`write`](Self::write).
    pub fn encode(forest: Forest, storage: &Storage) -> Result<(Self, Certificate), FileError> {
        let (header, source, certificate) = write::write(forest, storage)?;
        let (layout, complete) = (Layout::new(&header), header.chunks.len());
        Ok((Self { source, header, layout, complete }, certificate))
    }

    /// Returns the bytes of the file.
    pub fn bytes(&self) -> &[u8] {
        &self.source
    }

    /// Recomputes all checksums of a modified `.mlod` file, for tests of [`Archive::read`].
    #[doc(hidden)]
    pub fn rewrite_checksums(bytes: &mut [u8]) {
        header::rewrite_checksums(bytes);
    }
}

impl<S: Source> Archive<S> {
    /// Opens a `.mlod` file and reads its header and index.
    /// # Errors
    /// A file of another format, a damaged header, or a file that ends before its base mesh does.
    pub fn open(source: S) -> Result<Self, FileError> {
        let length = source.length()?;
        let start = read_range(&source, 0, FIXED_LEN as u64, "the header")?;
        let (chunks_end, index) = Header::length(&start)?;
        let header = chunks_end as u64
            + match index {
                ResourceIndex::None => 0,
                ResourceIndex::Old => OLD_RESOURCES_LEN as u64,
                ResourceIndex::Counted => {
                    let count = read_range(&source, chunks_end as u64, 4, "the index")?;
                    resources::index_len(std::array::from_fn(|k| count[k])) as u64
                }
            };
        let header = Header::from_bytes(&read_range(&source, 0, header, "the index")?)?;
        let layout = Layout::new(&header);
        let mut this = Self { source, header, layout, complete: 0 };
        let there = this.chunk_ends().take_while(|&end| end <= length).count();
        let truncated = FileError::Truncated { at: length, what: "the coarsest mesh" };
        this.complete = there.checked_sub(1).ok_or(truncated)?;
        let end = this.layout.end;
        if end < length { Err(FileError::TrailingData { at: end }) } else { Ok(this) }
    }

    /// Returns the number of chunks of updates listed in the file's index, including any that are
    /// cut off.
    pub fn chunk_count(&self) -> usize {
        self.header.chunks.len()
    }

    /// Returns the number of chunks of updates present in full; in a truncated file this is less
    /// than [`chunk_count`](Self::chunk_count).
    pub fn complete_chunks(&self) -> usize {
        self.complete
    }

    /// Iterates over byte offsets in the file: the end of the base mesh, then the end of each
    /// chunk.
    pub fn chunk_ends(&self) -> impl Iterator<Item = u64> + '_ {
        let chunks = self.layout.chunks.iter().zip(&self.header.chunks);
        let ends = chunks.map(|(&start, entry)| start + u64::from(entry.stored.bytes));
        std::iter::once(self.layout.base_end).chain(ends)
    }

    /// Returns the number of bytes of each chunk, including any that are cut off.
    pub fn chunk_lengths(&self) -> Vec<u64> {
        self.header.chunks.iter().map(|chunk| u64::from(chunk.stored.bytes)).collect()
    }

    /// Returns the number of bytes of the header, the base mesh and these chunks.
    fn bytes_of(&self, chunks: impl Iterator<Item = usize>) -> u64 {
        let stored = chunks.map(|chunk| u64::from(self.header.chunks[chunk].stored.bytes));
        self.layout.base_end + stored.sum::<u64>()
    }

    /// Returns the number of updates (vertex splits) listed in the file's index, including any that
    /// are cut off.
    pub fn update_count(&self) -> usize {
        self.header.updates()
    }

    /// Returns whether the errors of the updates are estimates or proven bounds.
    pub fn error_kind(&self) -> ErrorKind {
        self.header.about.error_kind
    }

    /// Returns the number of faces of the base mesh, the coarsest level.
    pub fn base_faces(&self) -> usize {
        self.header.base_faces as usize
    }

    /// Closes the archive and returns the source of bytes that it was reading.
    pub fn into_source(self) -> S {
        self.source
    }

    /// Returns the bounding-box diagonal of the finest mesh, in model units.
    pub fn diagonal(&self) -> f64 {
        self.header.diagonal
    }

    /// Returns true if the vertices of the finest mesh have exactly the input's positions, bit for
    /// bit.
    ///
    /// The error of that level is then 0, whatever [`rounding`](Self::rounding) returns. In coarser
    /// levels, vertices that belong to the finest mesh are exact too.
    pub fn is_lossless(&self) -> bool {
        self.header.lossless
    }

    /// Returns the largest distance that rounding to the file's lattice moved a vertex, in model
    /// units.
    ///
    /// In a [lossless](Self::is_lossless) file this concerns only vertices of coarser levels that
    /// are not vertices of the input.
    pub fn rounding(&self) -> f64 {
        self.header.rounding
    }

    /// Reads all complete chunks and certifies that no cut of the model has a crack.
    /// # Errors
    /// A file that is damaged or was crafted to mislead.
    pub fn read(&self) -> Result<(Implicit, Certificate), FileError> {
        self.read_chunks(self.complete)
    }

    /// Reads the base mesh and the first `count` chunks, and certifies that no cut of the resulting
    /// model has a crack.
    ///
    /// If these are all chunks of a lossless file, it also checks that every vertex of the finest
    /// mesh has its exact position.
    /// # Errors
    /// A file that is damaged or was crafted to mislead.
    pub fn read_chunks(&self, count: usize) -> Result<(Implicit, Certificate), FileError> {
        let state = self.load(&(0..count.min(self.complete)).collect::<Vec<_>>())?;
        let updates = state.updates.len();
        let model = state.assemble(self.header.about)?;
        if model.update_count() != updates {
            return Err(FileError::Section {
                section: "the updates".into(),
                why: "a node is split by more than one update".into(),
            });
        }
        if count.min(self.complete) == self.header.chunks.len() {
            self.check_lossless(&model)?;
        }
        let certificate = model.certify()?;
        Ok((model, certificate))
    }

    /// Checks that every leaf of a complete lossless model has an exact position.
    fn check_lossless(&self, model: &Implicit) -> Result<(), FileError> {
        let is_leaf = |&node: &u32| model.update_of(node).is_none();
        let leaves = (0..model.node_count() as u32).filter(is_leaf);
        let bare = leaves.filter(|&leaf| model.exact().get(leaf).is_none()).count();
        if !self.is_lossless() || bare == 0 {
            return Ok(());
        }
        let why = format!("{bare} of its vertices lack the exact position of a lossless file");
        Err(FileError::Section { section: "the finest mesh".into(), why })
    }

    /// Extracts the finest mesh of at most `faces` faces for a query, like
    /// [`Extractor::at_most`](crate::Extractor::at_most).
    ///
    /// For a uniform query of a model without attributes, only chunks that may contribute to the
    /// answer are read.
    /// # Errors
    /// An invalid query, or a file that is damaged or was crafted to mislead.
    pub fn extract_at_most(&self, faces: usize, query: &Query<'_>) -> Result<Extract, FileError> {
        let is_uniform = Criterion::new(query, &self.header.about.frame)?.is_uniform();
        // Chunks are in the order of errors, which the stages are not.
        let by_error = is_uniform && !self.header.about.has_stages;
        let mut chunks = if by_error { self.chunks_for_faces(faces) } else { self.complete };
        loop {
            let model = Model::from_certified(&self.read_chunks(chunks)?.0);
            let level = model.extractor().at_most(faces, query)?.clone();
            // Later chunks may hold updates with errors as large as that of an applied one.
            let least = model.implicit().least_error_above(&level.nodes).get();
            let rest = &self.header.chunks[chunks..self.complete];
            let urgent = rest.iter().rposition(|chunk| chunk.area.error >= least);
            let Some(more) = urgent.filter(|_| by_error) else {
                let bytes = self.bytes_of(0..chunks);
                let updates = model.implicit().update_count();
                return Ok(Extract { level, chunks, updates, bytes });
            };
            chunks += more + 1;
        }
    }

    /// Returns the number of leading chunks that together reach the given number of faces.
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

    /// Extracts the mesh that satisfies a query, reading only the chunks whose area the query may
    /// refine.
    ///
    /// Only the wedges of the result are checked: a file crafted to mislead, with matching checksums,
    /// may give a mesh with cracks. [`Archive::read`] detects that.
    /// # Errors
    /// An invalid query, or a damaged file.
    pub fn extract(&self, query: &Query<'_>) -> Result<Extract, FileError> {
        let criterion = Criterion::new(query, &self.header.about.frame)?;
        let wanted = |&chunk: &usize| criterion.may_require_in(&self.header.chunks[chunk].area);
        let chunks: Vec<usize> = (0..self.complete).filter(wanted).collect();
        let state = self.load(&chunks)?;
        let bytes = self.bytes_of(chunks.iter().copied());
        let updates = state.updates.len();
        let model = state.assemble(self.header.about)?;
        let level = Cut::at(&model, query)?.level();
        if !level.has_own_wedges() {
            return Err(FileError::Section {
                section: "the attributes".into(),
                why: Flaw::BadWedge.to_string(),
            });
        }
        Ok(Extract { level, chunks: chunks.len(), updates, bytes })
    }

    /// Returns the error that the file has for one of its levels, in model units: the greatest of the
    /// updates that are not applied in it. It is of the [kind](Self::error_kind) of all errors in the
    /// file, and excludes rounding. Updates that a truncated file lacks are not known. Reads the whole
    /// file.
    /// # Errors
    /// A damaged file.
    pub fn error_of(&self, level: &Level) -> Result<f64, FileError> {
        let (model, _) = self.read()?;
        let is_known = |&node: &u32| (node as usize) < model.node_count();
        let nodes: Vec<u32> = level.nodes.iter().copied().filter(is_known).collect();
        Ok(model.frame().model_length(model.greatest_error_below(&nodes)))
    }

    /// Returns the point of the finest surface in the file that is closest to a point in model
    /// units; `None` if the surface is empty. Only chunks around the point are read.
    /// # Errors
    /// A coordinate that is not finite, or a damaged file.
    pub fn closest_point(&self, point: [f64; 3]) -> Result<Option<[f64; 3]>, FileError> {
        let (middle, half) = (self.header.about.frame.model([0.0; 3]), 0.5 * self.diagonal());
        let bounds = Bounds { min: middle.map(|x| x - half), max: middle.map(|x| x + half) };
        closest_point(point, &bounds, |query| self.extract(query).map(|found| found.level))
    }

    /// Decodes the base and the given chunks, which are in ascending order.
    pub(super) fn load(&self, chunks: &[usize]) -> Result<DecoderState, FileError> {
        let mut state = self.read_base()?;
        let (mut first, mut wanted) = (0, chunks.iter().peekable());
        for (at, (entry, &offset)) in self.header.chunks.iter().zip(&self.layout.chunks).enumerate()
        {
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

    /// Reads a section and verifies its checksum.
    pub(super) fn read_section(
        &self,
        offset: u64,
        stored: Section,
        name: impl Fn() -> String,
    ) -> Result<Vec<u8>, FileError> {
        let bytes = read_range(&self.source, offset, u64::from(stored.bytes), "a chunk")?;
        if Section::of(&bytes) == stored { Ok(bytes) } else { Err(FileError::Checksum(name())) }
    }
}
