//! Header of a transport file and the index of its blocks: docs/formats/mlz.md.

use super::TransportFile;
use super::border::MAX_FACES;
use super::grid::{MAX_BITS, MAX_COORDINATE, QuantizationGrid};
use super::layers::{LayerTables, LayersFormat, TableCodes};
use super::models::{ModelCodes, Models};
use super::predict::MAX_CELLS;
use crate::bits::Bits;
use crate::bytes::{Malformed, Reader};

/// Header of a file to be written, with the index of its blocks.
#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) grid: QuantizationGrid,
    /// Bits of the first vertex of each block, along each axis.
    pub(super) first_bits: [u8; 3],
    pub(super) faces: usize,
    pub(super) vertices: usize,
    pub(super) codes: ModelCodes,
    /// Attributes and labels that blocks have, and the tables by which it is coded; `None` if
    /// they have nothing and there are no resources.
    pub(super) layers: Option<(LayersFormat, TableCodes)>,
    /// Number of bytes after the last block.
    pub(super) resources: usize,
    pub(super) entries: Vec<Entry>,
}

/// Header of a file that has been opened.
#[derive(Clone, Debug)]
pub(super) struct OpenHeader {
    pub(super) grid: QuantizationGrid,
    pub(super) first_bits: [u8; 3],
    pub(super) faces: usize,
    pub(super) vertices: usize,
    pub(super) coding: FaceCoding,
    pub(super) models: Models,
    pub(super) layers: Option<(LayersFormat, LayerTables)>,
    pub(super) resources: usize,
    pub(super) places: Vec<BlockSpan>,
}

/// Index entry of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) faces: usize,
    pub(super) bytes: usize,
}

/// Place of a block among all blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockSpan {
    pub(super) at: usize,
    pub(super) bytes: usize,
    pub(super) faces: usize,
}

/// Coding of the faces of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FaceCoding {
    /// A symbol for each step at the border: versions 1 to 3.
    Steps,
    /// A symbol for all new vertices around one: versions 4 to 6.
    Fans,
}

/// Added to the version of a file whose faces are coded by fans: all that are written now.
const WITH_FANS: u32 = 3;
/// Version of files with positions and faces only.
const SURFACES: u32 = 1;
/// Version of files with attributes, labels or resources.
const WITH_LAYERS: u32 = 2;
/// Version of files in which a layer of directions follows its neighbours. Readers of version 2 would
/// take that mode for another one, and decode wrong directions.
const BY_NEIGHBOURS: u32 = 3;
/// Bytes before what the checksum of the header covers: magic bytes, version and two checksums.
pub(super) const SUMS_END: usize = 20;
/// Bytes of the coder's state, which every block begins with.
const LEAST_BYTES: usize = 4;
/// Faces per byte of a block at most, so that a short file cannot ask for much memory.
const FACES_PER_BYTE: usize = 16;
/// Attribute values per byte of a block at most, for the same reason.
const VALUES_PER_BYTE: usize = 256;

/// Returns the fewest bytes that a block of some faces and attribute values has.
pub(super) fn least_bytes(faces: usize, values: usize) -> usize {
    let least = (faces / FACES_PER_BYTE).max(values.div_ceil(VALUES_PER_BYTE));
    least.next_multiple_of(2)
}

/// Returns the most attribute values that a block of some bytes has.
pub(super) fn max_values(bytes: usize) -> usize {
    bytes * VALUES_PER_BYTE
}

impl Header {
    /// Encodes the header of a file, given all that follows it.
    pub(super) fn store(&self, rest: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        for x in self.grid.origin.into_iter().chain([self.grid.cell]) {
            out.extend(x.to_le_bytes());
        }
        out.extend(self.first_bits);
        for number in [self.faces, self.vertices, self.entries.len()] {
            out.extend((number as u32).to_le_bytes());
        }
        self.codes.store(&mut out);
        if let Some((format, codes)) = &self.layers {
            format.store(codes, &mut out);
            out.extend((self.resources as u64).to_le_bytes());
        }
        self.store_index(&mut out);
        let mut file = TransportFile::MAGIC.to_vec();
        let format = self.layers.as_ref().map(|(format, _)| format);
        let version = WITH_FANS + format.map_or(SURFACES, version_of);
        file.extend(version.to_le_bytes());
        file.extend(header_sum(version, &out).to_le_bytes());
        file.extend(crc32fast::hash(rest).to_le_bytes());
        file.extend(out);
        file
    }

    fn store_index(&self, out: &mut Vec<u8>) {
        let mut bits = Bits::default();
        let faces: Vec<u32> = self.entries.iter().map(|entry| entry.faces as u32).collect();
        let words: Vec<u32> = self.entries.iter().map(|entry| entry.bytes as u32 / 2).collect();
        for numbers in [faces, words] {
            let least = numbers.iter().copied().min().unwrap_or(0);
            let most = numbers.iter().copied().max().unwrap_or(0);
            let width = u32::BITS - (most - least).leading_zeros();
            out.extend(least.to_le_bytes());
            out.push(width as u8);
            numbers.iter().for_each(|number| bits.push(u64::from(number - least), width));
        }
        bits.store(out);
    }
}

impl OpenHeader {
    /// Reads what follows the checksums.
    pub(super) fn read(version: u32, reader: &mut Reader) -> Result<Self, Malformed> {
        let origin = [reader.f64()?, reader.f64()?, reader.f64()?];
        let grid = QuantizationGrid { origin, cell: reader.f64()? };
        check_grid(&grid, reader)?;
        let first_bits = [reader.u8()?, reader.u8()?, reader.u8()?];
        if first_bits.iter().any(|&bits| u32::from(bits) > MAX_BITS) {
            return Err(reader.wrong("a coordinate has too many bits"));
        }
        let [faces, vertices, blocks] = [reader.u32()?, reader.u32()?, reader.u32()?];
        let codes = ModelCodes::restore(reader)?;
        let (mut layers, mut resources) = (None, 0);
        let (coding, content) = match version {
            ..=WITH_FANS => (FaceCoding::Steps, version),
            _ => (FaceCoding::Fans, version - WITH_FANS),
        };
        if content != SURFACES {
            let (format, tables) = LayersFormat::restore(reader)?;
            let expected = version - content + version_of(&format);
            if version != expected {
                let found = format!("version {version}, but its layers are of version {expected}");
                return Err(reader.wrong(found));
            }
            layers = (!format.is_empty()).then_some((format, tables));
            resources = usize::try_from(reader.u64()?).unwrap_or(usize::MAX);
        }
        let places = read_index(blocks as usize, reader)?;
        if places.iter().map(|place| place.faces).sum::<usize>() != faces as usize {
            return Err(reader.wrong("the faces of the blocks do not add up to those of the mesh"));
        }
        let (faces, vertices) = (faces as usize, vertices as usize);
        let models = Models::new(&codes);
        Ok(Self { grid, first_bits, faces, vertices, coding, models, layers, resources, places })
    }

    /// Returns the number of bytes of all blocks.
    pub(super) fn block_bytes(&self) -> usize {
        self.places.last().map_or(0, |place| place.at + place.bytes)
    }
}

/// Returns the checksum of a header, given the bytes after both checksums. From version 4 on, it
/// covers the version: by another one, the faces of a block would be other faces.
pub(super) fn header_sum(version: u32, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    if version > WITH_FANS {
        hasher.update(&version.to_le_bytes());
    }
    hasher.update(bytes);
    hasher.finalize()
}

/// Returns the first version that has all that layers need.
fn version_of(format: &LayersFormat) -> u32 {
    if format.follows_neighbours() { BY_NEIGHBOURS } else { WITH_LAYERS }
}

/// Reads the magic bytes and the version.
pub(super) fn read_version(reader: &mut Reader) -> Result<u32, Malformed> {
    if reader.take(TransportFile::MAGIC.len())? != TransportFile::MAGIC {
        return Err(reader.wrong("not an .mlz file: the magic bytes are missing"));
    }
    let version = reader.u32()?;
    const LAST: u32 = WITH_FANS + BY_NEIGHBOURS;
    if !(SURFACES..=LAST).contains(&version) {
        let known = format!("this reader knows versions {SURFACES} to {LAST}");
        return Err(reader.wrong(format!("unknown version {version}; {known}")));
    }
    Ok(version)
}

/// Checks that all cells have finite positions, also in `f32`.
fn check_grid(grid: &QuantizationGrid, reader: &Reader) -> Result<(), Malformed> {
    let farthest = |x: f64| x.abs() <= 2.0 * MAX_COORDINATE;
    let is_known = grid.cell > 0.0 && grid.origin.iter().all(|&x| farthest(x));
    if is_known && farthest(grid.cell * f64::from(MAX_CELLS)) {
        return Ok(());
    }
    Err(reader.wrong("the cells have no finite positions"))
}

/// Reads the places of all blocks, and checks their number and sizes.
fn read_index(count: usize, reader: &mut Reader) -> Result<Vec<BlockSpan>, Malformed> {
    let mut ranges = [(0, 0); 2];
    for range in &mut ranges {
        *range = (reader.u32()?, u32::from(reader.u8()?));
        if range.1 > u32::BITS {
            return Err(reader.wrong("the index has numbers of more than 32 bits"));
        }
    }
    if count > reader.left() / LEAST_BYTES {
        return Err(reader.wrong(format!("too few bytes for {count} blocks")));
    }
    let [(least_faces, face_bits), (least_words, word_bits)] = ranges;
    let bits = Bits::restore(count * (face_bits + word_bits) as usize, reader)?;
    let mut places = Vec::with_capacity(count);
    let mut at = 0;
    for k in 0..count {
        let faces = bits.get(k * face_bits as usize, face_bits) + u64::from(least_faces);
        let word = count * face_bits as usize + k * word_bits as usize;
        let bytes = 2 * (bits.get(word, word_bits) + u64::from(least_words));
        let (faces, bytes) = (faces as usize, bytes as usize);
        let is_valid = (1..=MAX_FACES).contains(&faces) && least_bytes(faces, 0) <= bytes;
        if !is_valid || bytes > reader.left() {
            return Err(reader.wrong(format!("block {k} has an impossible size")));
        }
        places.push(BlockSpan { at, bytes, faces });
        at += bytes;
    }
    Ok(places)
}
