//! Scratch file of the pieces of all triangles, in blocks of one leaf each.

use std::io::{self, Read, Seek, SeekFrom, Write};

use rustc_hash::FxHashMap;

use crate::lattice::Point;
use crate::layout::Layout;
use crate::tile::TileBuilder;

/// Largest number of pieces in a block, whose corners 16 bits must number.
const MOST_PIECES: usize = 16_384;

/// Least number of pieces that are gathered for a leaf before they are written.
const LEAST_PIECES: usize = 64;

/// Memory for pieces that are gathered before they are written, in bytes.
const GATHERED: usize = 256 << 20;

/// Block of pieces in a scratch file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// First byte in the file.
    pub offset: u64,
    /// Number of different corners.
    pub corners: u32,
    /// Number of pieces.
    pub pieces: u32,
    /// Checksum of its bytes.
    pub checksum: u32,
}

/// Blocks of the leaves of an octree, by index of the node.
pub type Blocks = Vec<Vec<Block>>;

/// Writes pieces of triangles, gathered for each leaf.
#[derive(Debug)]
pub struct ScratchWriter<'l, W> {
    layout: &'l Layout,
    has_materials: bool,
    out: W,
    length: u64,
    /// By node: bytes of the corners of pieces that are not written yet, and their materials.
    waiting: Vec<Waiting>,
    most: usize,
    blocks: Blocks,
}

#[derive(Clone, Debug, Default)]
struct Waiting {
    corners: Vec<u8>,
    materials: Vec<u16>,
}

impl<'l, W: Write> ScratchWriter<'l, W> {
    /// Creates the writer for an octree with so many leaves and nodes.
    pub fn new(
        layout: &'l Layout,
        has_materials: bool,
        [leaves, nodes]: [usize; 2],
        out: W,
    ) -> Self {
        let piece = 3 * record(layout) + 2;
        let most = (GATHERED / piece / leaves.max(1)).clamp(LEAST_PIECES, MOST_PIECES);
        let (waiting, blocks) = (vec![Waiting::default(); nodes], vec![Vec::new(); nodes]);
        Self { layout, has_materials, out, length: 0, waiting, most, blocks }
    }

    /// Adds a piece of a triangle to a leaf: points, values of the corners, and material.
    ///
    /// # Errors
    /// Errors of the file.
    pub fn add(
        &mut self,
        node: usize,
        points: [Point; 3],
        values: [&[f32]; 3],
        material: u16,
    ) -> io::Result<()> {
        let waiting = &mut self.waiting[node];
        for (point, values) in points.iter().zip(values) {
            point.iter().for_each(|x| waiting.corners.extend(x.to_le_bytes()));
            self.layout.pack(values, &mut waiting.corners);
        }
        waiting.materials.push(material);
        match waiting.materials.len() == self.most {
            true => self.flush(node),
            false => Ok(()),
        }
    }

    /// Writes what is waiting for a leaf as a block.
    fn flush(&mut self, node: usize) -> io::Result<()> {
        let Waiting { corners, materials } = &mut self.waiting[node];
        if materials.is_empty() {
            return Ok(());
        }
        let mut known: FxHashMap<&[u8], u16> = FxHashMap::default();
        let (mut records, mut indices) = (Vec::new(), Vec::new());
        for corner in corners.chunks_exact(record(self.layout)) {
            let next = known.len() as u16;
            let index = *known.entry(corner).or_insert_with(|| {
                records.extend_from_slice(corner);
                next
            });
            indices.extend(index.to_le_bytes());
        }
        let mut block = Block {
            offset: self.length,
            corners: known.len() as u32,
            pieces: materials.len() as u32,
            checksum: 0,
        };
        if self.has_materials {
            materials.iter().for_each(|material| indices.extend(material.to_le_bytes()));
        }
        block.checksum = checksum(&records, &indices);
        self.out.write_all(&records)?;
        self.out.write_all(&indices)?;
        self.length += (records.len() + indices.len()) as u64;
        self.blocks[node].push(block);
        corners.clear();
        materials.clear();
        Ok(())
    }

    /// Writes the rest. Returns the blocks of each node, and the number of bytes.
    ///
    /// # Errors
    /// Errors of the file.
    pub fn finish(mut self) -> io::Result<(Blocks, u64)> {
        for node in 0..self.waiting.len() {
            self.flush(node)?;
            self.waiting[node] = Waiting::default();
        }
        self.out.flush()?;
        Ok((self.blocks, self.length))
    }
}

fn checksum(records: &[u8], rest: &[u8]) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    sum.update(records);
    sum.update(rest);
    sum.finalize()
}

/// Reads the blocks of a leaf into the builder of its mesh.
///
/// # Errors
/// Errors of the file, and [`io::ErrorKind::InvalidData`] for a block that is not as it was written.
pub fn read_blocks(
    file: &mut (impl Read + Seek),
    blocks: &[Block],
    layout: &Layout,
    has_materials: bool,
    builder: &mut TileBuilder,
) -> io::Result<()> {
    let width = layout.width();
    let end = file.seek(SeekFrom::End(0))?;
    for block in blocks {
        let (corners, pieces) = (block.corners as usize, block.pieces as usize);
        let records = corners * record(layout);
        let length = records + pieces * if has_materials { 8 } else { 6 };
        if block.offset.saturating_add(length as u64) > end {
            return Err(invalid("is cut off"));
        }
        let mut bytes = vec![0; length];
        file.seek(SeekFrom::Start(block.offset))?;
        file.read_exact(&mut bytes)?;
        if crc32fast::hash(&bytes) != block.checksum {
            return Err(invalid("is changed"));
        }
        let (records, rest) = bytes.split_at(records);
        let (indices, materials) = rest.split_at(6 * pieces);
        let (mut points, mut values) = (Vec::new(), Vec::new());
        for bytes in records.chunks_exact(record(layout)) {
            let (at, rest) = bytes.split_at(12);
            let at = at.as_chunks().0;
            points.push([0, 1, 2].map(|axis| i32::from_le_bytes(at[axis])));
            layout.unpack(rest, &mut values);
        }
        let materials = materials.as_chunks().0;
        for (i, indices) in indices.as_chunks::<6>().0.iter().enumerate() {
            let indices = indices.as_chunks().0;
            let index = [0, 1, 2].map(|corner| usize::from(u16::from_le_bytes(indices[corner])));
            if index.iter().any(|&i| i >= corners) {
                return Err(invalid("is changed"));
            }
            let corner = index.map(|i| (points[i], &values[i * width..][..width]));
            let material = materials.get(i).map_or(0, |&bytes| u16::from_le_bytes(bytes));
            builder.add_face(corner, material.into());
        }
    }
    Ok(())
}

fn invalid(reason: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, reason)
}

/// Returns the number of bytes of a corner.
fn record(layout: &Layout) -> usize {
    12 + layout.bytes()
}
