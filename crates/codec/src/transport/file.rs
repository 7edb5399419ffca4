//! Transport files that have been opened.

use meshlod_mesh::{Mesh, VertexId};

use super::decode::{BlockBytes, Decoder, Lane};
use super::gather::{LayersBuilder, VertexNumbers};
use super::header::{BlockSpan, OpenHeader, SUMS_END, header_sum, read_version};
use super::lanes::LANES;
use super::layers::BlockLayers;
use super::predict::CellVec;
use crate::bytes::{Malformed, Reader};

/// Open `.mlz` file, whose blocks are decoded on request.
#[derive(Clone, Debug)]
pub struct TransportFile<'a> {
    header: OpenHeader,
    /// Bytes of all blocks and the resources, their checksum, and their offset in the file.
    rest: &'a [u8],
    checksum: u32,
    at: usize,
}

impl<'a> TransportFile<'a> {
    /// The first eight bytes of every `.mlz` file.
    pub const MAGIC: [u8; 8] = *b"meshlodz";

    /// Opens an `.mlz` file: reads its header and index, but decodes no block.
    /// # Errors
    /// Bytes that are not an `.mlz` file, or are damaged.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Malformed> {
        let mut reader = Reader::new(bytes);
        let version = read_version(&mut reader)?;
        let (expected, checksum) = (reader.u32()?, reader.u32()?);
        let header = OpenHeader::read(version, &mut reader)?;
        let at = bytes.len() - reader.left();
        if header_sum(version, &bytes[SUMS_END..at]) != expected {
            return Err(reader.wrong("the header is damaged: its checksum does not match"));
        }
        let rest = reader.take(header.block_bytes().saturating_add(header.resources))?;
        reader.finish()?;
        Ok(Self { header, rest, checksum, at })
    }

    /// Returns the number of blocks in the file.
    pub fn blocks(&self) -> usize {
        self.header.places.len()
    }

    /// Returns the number of vertices of the mesh.
    pub fn vertices(&self) -> usize {
        self.header.vertices
    }

    /// Returns the number of faces of the mesh.
    pub fn faces(&self) -> usize {
        self.header.faces
    }

    /// Returns the side of a quantization cell in model units.
    ///
    /// Positions are off by at most half of it along each axis.
    pub fn cell(&self) -> f64 {
        self.header.grid.cell
    }

    /// Returns the bytes that were given to [`Transport::encode_with_resources`](super::Transport).
    ///
    /// # Errors
    /// A damaged file.
    pub fn resources(&self) -> Result<&'a [u8], Malformed> {
        self.check()?;
        Ok(&self.rest[self.header.block_bytes()..])
    }

    /// Decodes one block as a mesh, reading only its own bytes and the file header.
    ///
    /// It has all vertices of the block, including those on its border.
    ///
    /// # Errors
    /// A damaged block.
    /// # Panics
    /// If there is no such block.
    pub fn block(&self, block: usize) -> Result<Mesh, Malformed> {
        let mut decoder = Decoder::new();
        let lanes = self.decode_blocks(&self.header.places[block..=block], &mut decoder)?;
        let lane = &lanes[0];
        let mut mesh = Mesh::default();
        let mut faces = Vec::new();
        let mut numbers = VertexNumbers::new(lane.cells().len());
        numbers.add(lane, |cell| mesh.positions.push(self.header.grid.place(cell)), &mut faces);
        mesh.faces = faces.into_iter().map(|face| face.map(VertexId)).collect();
        if let Some((format, _)) = &self.header.layers {
            let mut layers = LayersBuilder::new(format);
            lane.layers.iter().for_each(|block| layers.add(block));
            layers.finish(&mut mesh);
        }
        Ok(mesh)
    }

    /// Decodes the whole mesh, with each vertex once and the faces block by block.
    ///
    /// Wedges of a vertex with equal values are one.
    ///
    /// # Errors
    /// A damaged file.
    pub fn decode(&self) -> Result<Mesh, Malformed> {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        let mut layers = self.header.layers.as_ref().map(|(format, _)| LayersBuilder::new(format));
        let place = |cell| positions.push(self.header.grid.place(cell));
        self.decode_all(place, &mut faces, |block| {
            layers.iter_mut().for_each(|layers| layers.add(block));
        })?;
        let mut mesh = Mesh::new(positions, faces.iter().map(|face| face.map(VertexId)).collect());
        layers.into_iter().for_each(|layers| layers.finish(&mut mesh));
        Ok(mesh)
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
            let [x, y, z] = self.header.grid.place(cell);
            positions.push([x as f32, y as f32, z as f32]);
        };
        self.decode_all(place, faces, |_| ())
    }

    /// Returns the byte range of a block, from the first block on.
    #[cfg(test)]
    pub(super) fn range(&self, block: usize) -> std::ops::Range<usize> {
        let BlockSpan { at, bytes, .. } = self.header.places[block];
        at..at + bytes
    }

    /// Recomputes the checksums of a modified `.mlz` file, for tests of [`TransportFile::open`].
    #[doc(hidden)]
    pub fn seal(bytes: &mut [u8]) {
        let Some((version, header)) = header_end(bytes) else { return };
        let blocks = crc32fast::hash(&bytes[header..]);
        bytes[16..20].copy_from_slice(&blocks.to_le_bytes());
        let header = header_sum(version, &bytes[SUMS_END..header]);
        bytes[12..16].copy_from_slice(&header.to_le_bytes());
    }

    fn decode_all(
        &self,
        mut place: impl FnMut(CellVec),
        faces: &mut Vec<[u32; 3]>,
        mut layers: impl FnMut(&BlockLayers),
    ) -> Result<(), Malformed> {
        self.check()?;
        // About one border vertex for every five faces.
        let mut numbers = VertexNumbers::new(self.header.faces.min(self.header.block_bytes()) / 8);
        let mut decoder = Decoder::new();
        for places in self.header.places.chunks(LANES) {
            for lane in self.decode_blocks(places, &mut decoder)? {
                numbers.add(lane, &mut place, faces);
                lane.layers.iter().for_each(&mut layers);
            }
        }
        if numbers.vertices as usize == self.header.vertices {
            return Ok(());
        }
        let reason =
            format!("expected {} vertices, found {}", self.header.vertices, numbers.vertices);
        Err(Malformed { at: self.at, reason })
    }

    /// Checks the blocks and the resources by their checksum.
    fn check(&self) -> Result<(), Malformed> {
        if crc32fast::hash(self.rest) == self.checksum {
            return Ok(());
        }
        let reason = "a block is damaged: the checksum of all blocks does not match".into();
        Err(Malformed { at: self.at, reason })
    }

    fn decode_blocks<'d>(
        &self,
        places: &[BlockSpan],
        decoder: &'d mut Decoder,
    ) -> Result<&'d [Lane], Malformed> {
        let seal = |place: &BlockSpan| BlockBytes {
            bytes: &self.rest[place.at..][..place.bytes],
            faces: place.faces,
        };
        let mut blocks = [BlockBytes { bytes: &[], faces: 0 }; LANES];
        blocks.iter_mut().zip(places).for_each(|(block, place)| *block = seal(place));
        let lanes = decoder.decode(&blocks[..places.len()], &self.header);
        lanes.map_err(|(k, wrong)| Malformed { at: self.at + places[k].at, ..wrong })
    }
}

/// Returns the version, and where the blocks begin, if everything before can be read.
fn header_end(bytes: &[u8]) -> Option<(u32, usize)> {
    let mut reader = Reader::new(bytes);
    let version = read_version(&mut reader).ok()?;
    reader.take(8).ok()?;
    OpenHeader::read(version, &mut reader).ok()?;
    Some((version, bytes.len() - reader.left()))
}
