//! Reading and writing the header of a transport file, and decoding its blocks:
//! docs/formats/mlz.md.

use meshlod_mesh::{Mesh, VertexId};

use super::border::MAX_FACES;
use super::decode::{BlockBytes, Decoder, Lane, Sharing};
use super::grid::{MAX_BITS, MAX_COORDINATE, QuantizationGrid};
use super::models::{ModelCodes, Models};
use super::predict::{CellVec, LANES, MAX_CELLS};
use super::weld_blocks::{WeldTable, key};
use crate::bits::Bits;
use crate::bytes::{Malformed, Reader};

/// Header of a file, with the index of its blocks.
#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) grid: QuantizationGrid,
    /// Bits of the first vertex of each block, along each axis.
    pub(super) first_bits: [u8; 3],
    pub(super) faces: usize,
    pub(super) vertices: usize,
    pub(super) codes: ModelCodes,
    pub(super) entries: Vec<Entry>,
}

/// Index entry of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) faces: usize,
    pub(super) bytes: usize,
}

const VERSION: u32 = 1;
/// Bytes of the coder's state, which every block begins with.
const LEAST_BYTES: usize = 4;
/// Faces per byte of a block at most, so that a short file cannot ask for much memory.
pub(super) const FACES_PER_BYTE: usize = 16;

impl Header {
    /// Encodes the header of a file with these blocks.
    pub(super) fn store(&self, blocks: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        for x in self.grid.origin.into_iter().chain([self.grid.cell]) {
            out.extend(x.to_le_bytes());
        }
        out.extend(self.first_bits);
        for number in [self.faces, self.vertices, self.entries.len()] {
            out.extend((number as u32).to_le_bytes());
        }
        self.codes.store(&mut out);
        self.store_index(&mut out);
        let mut file = TransportFile::MAGIC.to_vec();
        file.extend(VERSION.to_le_bytes());
        file.extend(crc32fast::hash(&out).to_le_bytes());
        file.extend(crc32fast::hash(blocks).to_le_bytes());
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

/// Open `.mlz` file, whose blocks are decoded on request.
#[derive(Clone, Debug)]
pub struct TransportFile<'a> {
    grid: QuantizationGrid,
    first_bits: [u8; 3],
    faces: usize,
    vertices: usize,
    models: Models,
    places: Vec<BlockSpan>,
    /// Bytes of all blocks, their checksum, and their offset in the file.
    blocks: &'a [u8],
    checksum: u32,
    at: usize,
}

/// Place of a block among all blocks.
#[derive(Clone, Copy, Debug)]
struct BlockSpan {
    at: usize,
    bytes: usize,
    faces: usize,
}

/// Part of a mesh, decoded from one block of an `.mlz` file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TransportBlock {
    /// Positions of the block's vertices, including those on its border, in model units.
    pub positions: Vec<[f64; 3]>,
    /// Faces of the block as indices into its positions, counter-clockwise.
    pub faces: Vec<[u32; 3]>,
}

impl<'a> TransportFile<'a> {
    /// The first eight bytes of every `.mlz` file.
    pub const MAGIC: [u8; 8] = *b"meshlodz";

    /// Opens an `.mlz` file: reads its header and index, but decodes no block.
    /// # Errors
    /// Bytes that are not an `.mlz` file, or are damaged.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Malformed> {
        let mut reader = Reader::new(bytes);
        if reader.take(Self::MAGIC.len())? != Self::MAGIC {
            return Err(reader.wrong("not an .mlz file: the magic bytes are missing"));
        }
        let version = reader.u32()?;
        if version != VERSION {
            return Err(reader
                .wrong(format!("unknown version {version}; this reader knows version {VERSION}")));
        }
        let (header_sum, checksum) = (reader.u32()?, reader.u32()?);
        let from = bytes.len() - reader.left();
        let origin = [reader.f64()?, reader.f64()?, reader.f64()?];
        let grid = QuantizationGrid { origin, cell: reader.f64()? };
        check_grid(&grid, &reader)?;
        let first_bits = [reader.u8()?, reader.u8()?, reader.u8()?];
        if first_bits.iter().any(|&bits| u32::from(bits) > MAX_BITS) {
            return Err(reader.wrong("a coordinate has too many bits"));
        }
        let [faces, vertices, blocks] = [reader.u32()?, reader.u32()?, reader.u32()?];
        let codes = ModelCodes::restore(&mut reader)?;
        let places = read_index(blocks as usize, &mut reader)?;
        let at = bytes.len() - reader.left();
        if crc32fast::hash(&bytes[from..at]) != header_sum {
            return Err(reader.wrong("the header is damaged: its checksum does not match"));
        }
        let last = places.last().map_or(0, |place| place.at + place.bytes);
        let blocks = reader.take(last)?;
        reader.finish()?;
        if places.iter().map(|place| place.faces).sum::<usize>() != faces as usize {
            return Err(reader.wrong("the faces of the blocks do not add up to those of the mesh"));
        }
        let (faces, vertices) = (faces as usize, vertices as usize);
        let models = Models::new(&codes);
        Ok(Self { grid, first_bits, faces, vertices, models, places, blocks, checksum, at })
    }

    /// Returns the number of blocks in the file.
    pub fn blocks(&self) -> usize {
        self.places.len()
    }

    /// Returns the number of vertices of the mesh.
    pub fn vertices(&self) -> usize {
        self.vertices
    }

    /// Returns the number of faces of the mesh.
    pub fn faces(&self) -> usize {
        self.faces
    }

    /// Returns the side of a quantization cell in model units.
    ///
    /// Positions are off by at most half of it along each axis.
    pub fn cell(&self) -> f64 {
        self.grid.cell
    }

    /// Decodes one block, reading only its own bytes and the file header.
    ///
    /// # Errors
    /// A damaged block.
    /// # Panics
    /// If there is no such block.
    pub fn block(&self, block: usize) -> Result<TransportBlock, Malformed> {
        let mut decoder = Decoder::new();
        let lanes = self.decode_blocks(&self.places[block..=block], &mut decoder)?;
        let mut out = TransportBlock::default();
        let mut gather = MeshBuilder::new(lanes[0].cells().len());
        gather.add(&lanes[0], |cell| out.positions.push(self.grid.place(cell)), &mut out.faces);
        Ok(out)
    }

    /// Decodes the whole mesh, with each vertex once and the faces block by block.
    ///
    /// # Errors
    /// A damaged file.
    pub fn decode(&self) -> Result<Mesh, Malformed> {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        self.decode_all(|cell| positions.push(self.grid.place(cell)), &mut faces)?;
        Ok(Mesh::new(positions, faces.iter().map(|face| face.map(VertexId)).collect()))
    }

    /// Decodes the whole mesh into GPU buffers, replacing their contents.
    ///
    /// Positions are those of [`TransportFile::decode`], rounded to `f32`.
    ///
    /// # Errors
    /// A damaged file.
    pub fn decode_into(
        &self,
        positions: &mut Vec<[f32; 3]>,
        faces: &mut Vec<[u32; 3]>,
    ) -> Result<(), Malformed> {
        positions.clear();
        faces.clear();
        let place = |cell| {
            let [x, y, z] = self.grid.place(cell);
            positions.push([x as f32, y as f32, z as f32]);
        };
        self.decode_all(place, faces)
    }

    /// Returns the byte range of a block, from the first block on.
    #[cfg(test)]
    pub(super) fn range(&self, block: usize) -> std::ops::Range<usize> {
        let BlockSpan { at, bytes, .. } = self.places[block];
        at..at + bytes
    }

    /// Recomputes the checksums of a modified `.mlz` file, for tests of [`TransportFile::open`].
    #[doc(hidden)]
    pub fn seal(bytes: &mut [u8]) {
        let Some(header) = header_end(bytes) else { return };
        let blocks = crc32fast::hash(&bytes[header..]);
        bytes[16..20].copy_from_slice(&blocks.to_le_bytes());
        let header = crc32fast::hash(&bytes[20..header]);
        bytes[12..16].copy_from_slice(&header.to_le_bytes());
    }

    fn decode_all(
        &self,
        mut place: impl FnMut(CellVec),
        faces: &mut Vec<[u32; 3]>,
    ) -> Result<(), Malformed> {
        if crc32fast::hash(self.blocks) != self.checksum {
            let reason = "a block is damaged: the checksum of all blocks does not match".into();
            return Err(Malformed { at: self.at, reason });
        }
        // About one border vertex for every five faces.
        let mut gather = MeshBuilder::new(self.faces.min(self.blocks.len()) / 8);
        let mut decoder = Decoder::new();
        for places in self.places.chunks(LANES) {
            for lane in self.decode_blocks(places, &mut decoder)? {
                gather.add(lane, &mut place, faces);
            }
        }
        if gather.vertices as usize == self.vertices {
            return Ok(());
        }
        let reason = format!("expected {} vertices, found {}", self.vertices, gather.vertices);
        Err(Malformed { at: self.at, reason })
    }

    fn decode_blocks<'d>(
        &self,
        places: &[BlockSpan],
        decoder: &'d mut Decoder,
    ) -> Result<&'d [Lane], Malformed> {
        let seal = |place: &BlockSpan| BlockBytes {
            bytes: &self.blocks[place.at..][..place.bytes],
            faces: place.faces,
        };
        let mut blocks = [BlockBytes { bytes: &[], faces: 0 }; LANES];
        blocks.iter_mut().zip(places).for_each(|(block, place)| *block = seal(place));
        let lanes = decoder.decode(&blocks[..places.len()], &self.models, self.first_bits);
        lanes.map_err(|(k, wrong)| Malformed { at: self.at + places[k].at, ..wrong })
    }
}

/// Builds one mesh from blocks by welding their borders.
struct MeshBuilder {
    welds: WeldTable,
    vertices: u32,
    sharing: Vec<Sharing>,
    numbers: Vec<u32>,
}

impl MeshBuilder {
    fn new(welds: usize) -> Self {
        Self { welds: WeldTable::new(welds), vertices: 0, sharing: Vec::new(), numbers: Vec::new() }
    }

    #[inline(never)]
    fn add(&mut self, lane: &Lane, mut place: impl FnMut(CellVec), faces: &mut Vec<[u32; 3]>) {
        lane.sharing(&mut self.sharing);
        self.numbers.clear();
        for (cell, &sharing) in lane.cells().zip(&self.sharing) {
            let number = match sharing {
                Sharing::Inside => self.vertices,
                Sharing::Shared(tag) => *self.welds.find_or_insert(key(cell), tag, self.vertices),
            };
            if number == self.vertices {
                self.vertices += 1;
                place(cell);
            }
            self.numbers.push(number);
        }
        let numbers = &self.numbers;
        let number = |v: u16| numbers[usize::from(v)];
        faces.extend(lane.faces.iter().map(|&[a, b, c]| [number(a), number(b), number(c)]));
    }
}

/// Returns where the blocks begin, if everything before can be read.
fn header_end(bytes: &[u8]) -> Option<usize> {
    let mut reader = Reader::new(bytes.get(20..)?);
    reader.take(4 * 8 + 3 + 2 * 4).ok()?;
    let blocks = reader.u32().ok()?;
    ModelCodes::restore(&mut reader).ok()?;
    read_index(blocks as usize, &mut reader).ok()?;
    Some(bytes.len() - reader.left())
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
        let is_valid = (1..=MAX_FACES).contains(&faces) && faces / FACES_PER_BYTE <= bytes;
        if !is_valid || bytes > reader.left() {
            return Err(reader.wrong(format!("block {k} has an impossible size")));
        }
        places.push(BlockSpan { at, bytes, faces });
        at += bytes;
    }
    Ok(places)
}
