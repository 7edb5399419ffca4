//! Header and index of a `.mlod` file of contractions.

use glam::{DVec3, Vec3};
use meshlod_mesh::Frame;

use super::lattice::Lattice;
use super::resources::{self, OLD_RESOURCES_LEN, ResourceEntry};
use super::{FileError, MAGIC, VERSION};
use crate::error_kind::ErrorKind;
use crate::implicit::ModelInfo;
use crate::query::Area;

/// Decoded header of a file, with the index of its chunks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) about: ModelInfo,
    pub(super) lattice: Lattice,
    /// True if the vertices of the finest mesh have exact positions.
    pub(super) lossless: bool,
    /// True if it has attributes, materials or objects.
    pub(super) has_wedges: bool,
    /// Bounding-box diagonal of the finest mesh, in model units.
    pub(super) diagonal: f64,
    /// Largest distance that a vertex without an exact position was moved, in model units.
    pub(super) rounding: f64,
    pub(super) roots: u32,
    pub(super) base_faces: u32,
    pub(super) base: Section,
    pub(super) chunks: Vec<ChunkEntry>,
    /// Resources between the chunks, in the order of the file.
    pub(super) resources: Vec<ResourceEntry>,
    /// True if the resources have the form of an earlier version: materials and base colours.
    pub(super) has_old_resources: bool,
}

/// Length and checksum of a section of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Section {
    pub(super) bytes: u32,
    pub(super) checksum: u32,
}

/// Entry of the index for one chunk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ChunkEntry {
    pub(super) stored: Section,
    pub(super) updates: u32,
    /// Number of faces that its updates create.
    pub(super) faces: u32,
    /// Bounds of its updates and of all updates that depend on them, with the greatest error among
    /// these.
    pub(super) area: Area,
}

/// Form of the index of resources, which follows that of the chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ResourceIndex {
    /// No resources.
    None,
    /// Two entries, in the form of an earlier version.
    Old,
    /// A number of entries, and the entries.
    Counted,
}

/// Length of the header without its index, in bytes.
pub(super) const FIXED_LEN: usize = 88;
pub(super) const ENTRY_LEN: usize = 44;
/// Offset of length and checksum of the base mesh.
pub(super) const BASE_AT: usize = 28;
/// Offset of the checksum, followed by the offset from which it covers the header.
const CHECKSUM_AT: usize = 12;
const BODY_AT: usize = 16;

impl Section {
    pub(super) fn of(bytes: &[u8]) -> Self {
        Self { bytes: bytes.len() as u32, checksum: crc32fast::hash(bytes) }
    }
}

/// Returns the code of a kind of errors.
fn kind_code(kind: ErrorKind) -> u8 {
    match kind {
        ErrorKind::Estimate => 0,
        ErrorKind::Bound => 1,
        ErrorKind::Measured => 2,
    }
}

/// Returns the kind of errors with a code, or `None` for an unknown one.
fn kind_of_code(code: u8) -> Option<ErrorKind> {
    let all = [ErrorKind::Estimate, ErrorKind::Bound, ErrorKind::Measured];
    all.into_iter().find(|&kind| kind_code(kind) == code)
}

impl Header {
    /// Length of the header and its index, in bytes.
    pub(super) fn len(&self) -> u64 {
        let resources = match (self.has_old_resources, self.resources.len()) {
            (true, _) => OLD_RESOURCES_LEN,
            (false, 0) => 0,
            (false, count) => resources::COUNT_LEN + resources::ENTRY_LEN * count,
        };
        (FIXED_LEN + ENTRY_LEN * self.chunks.len() + resources) as u64
    }

    /// Total number of updates in all chunks.
    pub(super) fn updates(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.updates as usize).sum()
    }

    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.len() as usize);
        out.extend(MAGIC);
        out.extend(VERSION.to_le_bytes());
        out.extend([0; BODY_AT - CHECKSUM_AT]);
        let kind = self.about.error_kind;
        out.extend(self.lattice.to_bytes());
        let flags = [
            (LOSSLESS, self.lossless),
            (WEDGES, self.has_wedges),
            (RESOURCES, !self.resources.is_empty()),
            (STAGES, self.about.has_stages),
            (PREDICTED, self.has_wedges),
        ];
        let flags = flags.iter().filter(|(_, is_so)| *is_so).map(|(flag, _)| flag).sum();
        out.extend([kind_code(kind), flags]);
        let words = [self.roots, self.base_faces, self.base.bytes, self.base.checksum];
        out.extend(words.iter().flat_map(|word| word.to_le_bytes()));
        out.extend((self.chunks.len() as u32).to_le_bytes());
        let origin = self.about.frame.model([0.0; 3]);
        out.extend(origin.iter().flat_map(|x| x.to_le_bytes()));
        out.extend(self.about.frame.model_length(1.0).to_le_bytes());
        out.extend([self.diagonal, self.rounding].iter().flat_map(|x| x.to_le_bytes()));
        for ChunkEntry { stored, updates, faces, area } in &self.chunks {
            let words = [stored.bytes, stored.checksum, *updates, *faces];
            out.extend(words.iter().flat_map(|word| word.to_le_bytes()));
            let numbers = [area.min, area.max].map(|corner| corner.as_vec3().to_array());
            out.extend(numbers.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
            out.extend((area.error as f32).to_le_bytes());
        }
        resources::write_index(&self.resources, &mut out);
        let checksum = crc32fast::hash(&out[BODY_AT..]);
        out[CHECKSUM_AT..BODY_AT].copy_from_slice(&checksum.to_le_bytes());
        out
    }

    /// Returns the length of a header without the index of its resources, given at least its first
    /// [`FIXED_LEN`] bytes, and what follows it.
    pub(super) fn length(start: &[u8]) -> Result<(usize, ResourceIndex), FileError> {
        if !start.starts_with(MAGIC) {
            return Err(FileError::Magic);
        }
        let version = u32_at(start, MAGIC.len());
        if version != VERSION {
            return Err(FileError::Version(version));
        }
        let index = match start[BODY_AT + 3] & (RESOURCES | OLD_RESOURCES) {
            0 => ResourceIndex::None,
            OLD_RESOURCES => ResourceIndex::Old,
            _ => ResourceIndex::Counted,
        };
        Ok((FIXED_LEN + ENTRY_LEN * u32_at(start, 36) as usize, index))
    }

    /// Decodes a header with its whole index; [`Header::length`] returns where the resources begin.
    pub(super) fn from_bytes(bytes: &[u8]) -> Result<Self, FileError> {
        if crc32fast::hash(&bytes[BODY_AT..]) != u32_at(bytes, CHECKSUM_AT) {
            return Err(FileError::Checksum("the header".into()));
        }
        let origin = [0, 1, 2].map(|k| f64_at(bytes, 40 + 8 * k));
        let frame = Frame::from_unit(origin, f64_at(bytes, 64));
        let lattice = Lattice::from_bytes([bytes[BODY_AT], bytes[BODY_AT + 1]]);
        let bad = |why| FileError::Header(why);
        let (end, index) = Self::length(bytes)?;
        let chunks: Vec<ChunkEntry> =
            bytes[FIXED_LEN..end].chunks_exact(ENTRY_LEN).map(ChunkEntry::from_bytes).collect();
        let resources = match index {
            ResourceIndex::None => Vec::new(),
            ResourceIndex::Old => resources::read_old_index(&bytes[end..], chunks.len()),
            ResourceIndex::Counted => resources::read_index(&bytes[end..], chunks.len())
                .ok_or(bad("its resources are out of order"))?,
        };
        let this = Self {
            about: ModelInfo {
                frame: frame
                    .ok_or(bad("its origin is not finite or its unit is no power of two"))?,
                error_kind: kind_of_code(bytes[BODY_AT + 2])
                    .ok_or(bad("it has an unknown kind of errors"))?,
                has_stages: bytes[BODY_AT + 3] & STAGES != 0,
            },
            lattice: lattice.ok_or(bad("the cell size of its lattice is out of range"))?,
            lossless: bytes[BODY_AT + 3] & LOSSLESS != 0,
            has_wedges: bytes[BODY_AT + 3] & WEDGES != 0,
            diagonal: f64_at(bytes, 72),
            rounding: f64_at(bytes, 80),
            roots: u32_at(bytes, 20),
            base_faces: u32_at(bytes, 24),
            base: Section { bytes: u32_at(bytes, 28), checksum: u32_at(bytes, 32) },
            chunks,
            resources,
            has_old_resources: index == ResourceIndex::Old,
        };
        this.trouble(bytes[BODY_AT + 3]).map_or(Ok(this), |why| Err(bad(why)))
    }

    /// Returns what makes the fields of a decoded header invalid, given its flags.
    fn trouble(&self, flags: u8) -> Option<&'static str> {
        let has = |flag: u8| flags & flag != 0;
        if !self.has_wedges && has(OLD_PREDICTED | PREDICTED) {
            return Some(UNKNOWN_FLAGS);
        }
        if self.has_wedges && (has(OLD_PREDICTED) || !has(PREDICTED)) {
            return Some(OLD_WEDGES);
        }
        if self.updates() > MAX_UPDATES || self.roots as usize > MAX_UPDATES {
            return Some("it has too many updates");
        }
        let is_length = |length: f64| length >= 0.0 && length.is_finite();
        if !is_length(self.diagonal) || !is_length(self.rounding) {
            return Some("its diagonal or rounding is negative or not finite");
        }
        let is_area = |a: &Area| a.min.is_finite() && a.max.is_finite() && a.error >= 0.0;
        (!self.chunks.iter().all(|chunk| is_area(&chunk.area)))
            .then_some("a chunk has invalid bounds")
    }
}

/// Limit on the bounds written to the index, in stored units.
const MAX_BOUND: f64 = 1e30;
/// Flag of a file with exact positions.
const LOSSLESS: u8 = 1;
/// Flag of a file with attributes, materials or objects.
const WEDGES: u8 = 2;
/// Flag of a file whose resources have the form of an earlier version.
const OLD_RESOURCES: u8 = 4;
/// Flag of a file with resources.
const RESOURCES: u8 = 8;
/// Flag of a file whose updates have stages.
const STAGES: u8 = 16;
/// Flags of files whose values of wedges have one of the later forms that were never released; those
/// of the first have none.
const OLD_PREDICTED: u8 = 32 | 64;
/// Flag of a file whose values of wedges are predicted by their shares.
const PREDICTED: u8 = 128;
/// Message for a file of these forms.
const OLD_WEDGES: &str = "its attributes are in a form that was never released; build it again";
/// Message for any other flag.
pub(super) const UNKNOWN_FLAGS: &str = "it has flags unknown to this program";
/// Upper limit on updates and on roots, so that roots and two nodes per update stay below 2³¹.
const MAX_UPDATES: usize = 1 << 29;

/// Returns an area in the precision of the file: 32 bits, rounded outwards.
pub(super) fn rounded(area: &Area) -> Area {
    // Infinite bounds become finite ones beyond everything.
    let [min, max] =
        [area.min, area.max].map(|x| x.clamp(DVec3::splat(-MAX_BOUND), DVec3::splat(MAX_BOUND)));
    Area {
        min: (-round_up(-min)).as_dvec3(),
        max: round_up(max).as_dvec3(),
        error: round_up(DVec3::splat(area.error)).x.into(),
    }
}

impl ChunkEntry {
    fn from_bytes(bytes: &[u8]) -> Self {
        let number = |at| f64::from(f32::from_bits(u32_at(bytes, at)));
        Self {
            stored: Section { bytes: u32_at(bytes, 0), checksum: u32_at(bytes, 4) },
            updates: u32_at(bytes, 8),
            faces: u32_at(bytes, 12),
            area: Area {
                min: DVec3::new(number(16), number(20), number(24)),
                max: DVec3::new(number(28), number(32), number(36)),
                error: number(40),
            },
        }
    }
}

/// Recomputes the checksums of the header, the base, all chunks and the resources that are present.
pub(super) fn rewrite_checksums(bytes: &mut [u8]) {
    let start = bytes.get(..FIXED_LEN).and_then(|start| Header::length(start).ok());
    let Some((chunks_end, kind)) = start else { return };
    let count = bytes.get(chunks_end..).and_then(|rest| rest.first_chunk());
    let index = match (kind, count) {
        (ResourceIndex::None, _) => chunks_end,
        (ResourceIndex::Old, _) => chunks_end + OLD_RESOURCES_LEN,
        (ResourceIndex::Counted, Some(&count)) => chunks_end + resources::index_len(count),
        (ResourceIndex::Counted, None) => return,
    };
    if bytes.len() < index {
        return;
    }
    let mut from = index;
    for at in resources::sections(bytes, chunks_end, kind) {
        let size = u32_at(bytes, at) as usize;
        let Some(piece) = bytes.get(from..).and_then(|rest| rest.get(..size)) else { break };
        let checksum = crc32fast::hash(piece);
        bytes[at + 4..at + 8].copy_from_slice(&checksum.to_le_bytes());
        from += size;
    }
    let checksum = crc32fast::hash(&bytes[BODY_AT..index]);
    bytes[CHECKSUM_AT..BODY_AT].copy_from_slice(&checksum.to_le_bytes());
}

pub(super) fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(std::array::from_fn(|k| bytes[at + k]))
}

fn f64_at(bytes: &[u8], at: usize) -> f64 {
    f64::from_le_bytes(std::array::from_fn(|k| bytes[at + k]))
}

/// Rounds each coordinate up to the next `f32`.
fn round_up(x: DVec3) -> Vec3 {
    let near = x.as_vec3();
    Vec3::select(near.as_dvec3().cmplt(x), near.map(f32::next_up), near)
}
