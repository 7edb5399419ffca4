//! What a file starts with: what it holds, and where.

use glam::{DVec3, Vec3};

use super::lattice::Lattice;
use super::{FileError, MAGIC, VERSION};
use crate::bounds::ErrorKind;
use crate::frame::Frame;
use crate::implicit::ModelInfo;
use crate::query::Area;

/// What a file holds, without the updates.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) about: ModelInfo,
    pub(super) lattice: Lattice,
    /// Whether the vertices of the finest mesh have positions to the bit.
    pub(super) lossless: bool,
    /// Of the finest mesh, in model units.
    pub(super) diagonal: f64,
    /// By how much a vertex was moved at most that has no position to the bit, in model units.
    pub(super) rounding: f64,
    pub(super) roots: u32,
    pub(super) base_faces: u32,
    pub(super) base: Section,
    pub(super) chunks: Vec<ChunkEntry>,
}

/// A piece of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Section {
    pub(super) bytes: u32,
    pub(super) checksum: u32,
}

/// A chunk as the index has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ChunkEntry {
    pub(super) stored: Section,
    pub(super) updates: u32,
    /// How many faces its updates bring.
    pub(super) faces: u32,
    /// Around all of its updates and all that need any of them; the greatest error.
    pub(super) area: Area,
}

/// Length of the header without its index, in bytes.
pub(super) const FIXED_LEN: usize = 88;
const ENTRY_LEN: usize = 44;
/// Where the checksum is, and what it is of starts.
const CHECKSUM_AT: usize = 12;
const BODY_AT: usize = 16;

impl Section {
    pub(super) fn of(bytes: &[u8]) -> Self {
        Self { bytes: bytes.len() as u32, checksum: crc32fast::hash(bytes) }
    }
}

impl Header {
    /// How many bytes it takes itself.
    pub(super) fn len(&self) -> u64 {
        (FIXED_LEN + ENTRY_LEN * self.chunks.len()) as u64
    }

    /// How many updates all chunks have.
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
        let flags = if self.lossless { LOSSLESS } else { 0 };
        out.extend([u8::from(kind == ErrorKind::Bound), flags]);
        let words = [self.roots, self.base_faces, self.base.bytes, self.base.checksum];
        out.extend(words.iter().flat_map(|word| word.to_le_bytes()));
        out.extend((self.chunks.len() as u32).to_le_bytes());
        let origin = self.about.frame.model([0.0; 3]);
        out.extend(origin.iter().flat_map(|x| x.to_le_bytes()));
        out.extend(self.about.frame.length_of_model(1.0).to_le_bytes());
        out.extend([self.diagonal, self.rounding].iter().flat_map(|x| x.to_le_bytes()));
        for ChunkEntry { stored, updates, faces, area } in &self.chunks {
            let words = [stored.bytes, stored.checksum, *updates, *faces];
            out.extend(words.iter().flat_map(|word| word.to_le_bytes()));
            // Far beyond everything, but a number.
            let [min, max] =
                [area.min, area.max].map(|x| x.clamp(DVec3::splat(-FAR), DVec3::splat(FAR)));
            let numbers = [-round_up(-min), round_up(max)].map(|corner| corner.to_array());
            out.extend(numbers.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
            out.extend(round_up(DVec3::splat(area.error)).x.to_le_bytes());
        }
        let checksum = crc32fast::hash(&out[BODY_AT..]);
        out[CHECKSUM_AT..BODY_AT].copy_from_slice(&checksum.to_le_bytes());
        out
    }

    /// How long the header is that starts like this, at least [`FIXED_LEN`] bytes.
    pub(super) fn length(start: &[u8]) -> Result<usize, FileError> {
        if !start.starts_with(MAGIC) {
            return Err(FileError::Magic);
        }
        let version = u32_at(start, MAGIC.len());
        if version != VERSION {
            return Err(FileError::Version(version));
        }
        Ok(FIXED_LEN + ENTRY_LEN * u32_at(start, 36) as usize)
    }

    /// Of as many bytes as [`Header::length`] says.
    pub(super) fn from_bytes(bytes: &[u8]) -> Result<Self, FileError> {
        if crc32fast::hash(&bytes[BODY_AT..]) != u32_at(bytes, CHECKSUM_AT) {
            return Err(FileError::Checksum("the header".into()));
        }
        let origin = [0, 1, 2].map(|k| f64_at(bytes, 40 + 8 * k));
        let frame = Frame::from_parts(origin, f64_at(bytes, 64));
        let lattice = Lattice::from_bytes([bytes[BODY_AT], bytes[BODY_AT + 1]]);
        let bad = |why| FileError::Header(why);
        let this = Self {
            about: ModelInfo {
                frame: frame.ok_or(bad("its frame is no place"))?,
                error_kind: match bytes[BODY_AT + 2] {
                    0 => ErrorKind::Estimate,
                    1 => ErrorKind::Bound,
                    _ => return Err(bad("its errors are of no kind")),
                },
            },
            lattice: lattice.ok_or(bad("its lattice is none"))?,
            lossless: bytes[BODY_AT + 3] & LOSSLESS != 0,
            diagonal: f64_at(bytes, 72),
            rounding: f64_at(bytes, 80),
            roots: u32_at(bytes, 20),
            base_faces: u32_at(bytes, 24),
            base: Section { bytes: u32_at(bytes, 28), checksum: u32_at(bytes, 32) },
            chunks: bytes[FIXED_LEN..]
                .chunks_exact(ENTRY_LEN)
                .map(ChunkEntry::from_bytes)
                .collect(),
        };
        if bytes[BODY_AT + 3] & !LOSSLESS != 0 {
            return Err(bad(UNKNOWN_FLAGS));
        }
        if this.updates() > MAX_UPDATES || this.roots as usize > MAX_UPDATES {
            return Err(bad("it has more updates than can be numbered"));
        }
        let is_length = |length: f64| length >= 0.0 && length.is_finite();
        if !is_length(this.diagonal) || !is_length(this.rounding) {
            return Err(bad("its diagonal or its rounding is no length"));
        }
        let is_area = |a: &Area| a.min.is_finite() && a.max.is_finite() && a.error >= 0.0;
        if !this.chunks.iter().all(|chunk| is_area(&chunk.area)) {
            return Err(bad("a chunk is nowhere"));
        }
        Ok(this)
    }
}

/// In units: the bounds of areas that have none.
const FAR: f64 = 1e30;
/// The one flag that there is.
const LOSSLESS: u8 = 1;
/// What is wrong with others, here and elsewhere.
pub(super) const UNKNOWN_FLAGS: &str = "it has flags that this program does not know";
/// Nodes are numbered up to 2³¹: roots, and two an update.
const MAX_UPDATES: usize = 1 << 29;

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

/// Writes the checksums that fit.
pub(super) fn rewrite_checksums(bytes: &mut [u8]) {
    let Some(index) = bytes.get(..FIXED_LEN).and_then(|start| Header::length(start).ok()) else {
        return;
    };
    if bytes.len() < index {
        return;
    }
    // Of the base, whose size and checksum are in the header, and of each chunk.
    let mut from = index;
    for at in std::iter::once(28).chain((FIXED_LEN..index).step_by(ENTRY_LEN)) {
        let size = u32_at(bytes, at) as usize;
        let Some(piece) = bytes.get(from..).and_then(|rest| rest.get(..size)) else { break };
        let checksum = crc32fast::hash(piece);
        bytes[at + 4..at + 8].copy_from_slice(&checksum.to_le_bytes());
        from += size;
    }
    let checksum = crc32fast::hash(&bytes[BODY_AT..index]);
    bytes[CHECKSUM_AT..BODY_AT].copy_from_slice(&checksum.to_le_bytes());
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(std::array::from_fn(|k| bytes[at + k]))
}

fn f64_at(bytes: &[u8], at: usize) -> f64 {
    f64::from_le_bytes(std::array::from_fn(|k| bytes[at + k]))
}

/// The least of `f32` that are no less.
fn round_up(x: DVec3) -> Vec3 {
    let near = x.as_vec3();
    Vec3::select(near.as_dvec3().cmplt(x), near.map(f32::next_up), near)
}
