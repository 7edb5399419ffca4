//! Encoding of a mesh as a transport file.

use meshlod_mesh::{Connectivity, Mesh, VertexId};

use super::encode::{residuals, symbols};
use super::face_blocks::face_blocks;
use super::file::{Entry, FACES_PER_BYTE, Header};
use super::fit::{fit, shapes};
use super::grid::QuantizationGrid;
use super::models::Models;
use super::predict::{CellVec, LANES};
use super::rans::{Symbol, encode};
use super::walk::{BlockWalk, Walker};
use super::weld_blocks::{WeldTable, checksum, key};
use super::{
    LeftOut, Transport, TransportError, TransportOptions, TransportSizes, max_block_faces,
};

/// Greatest number of faces, for 32-bit numbers of faces and of their sides.
const MAX_MESH_FACES: usize = 1 << 30;

impl Transport {
    /// Encodes a mesh as an `.mlz` file, with positions rounded to a grid.
    ///
    /// Faces are unchanged except for the corner they start at.
    ///
    /// Every vertex that a face uses comes back once. [`Transport::left_out`] lists what is not
    /// stored: attributes, materials, objects and unused vertices. Cost: O(n).
    /// # Errors
    /// A mesh without faces, an invalid position or vertex index, or an option out of range.
    pub fn encode(mesh: &Mesh, options: &TransportOptions) -> Result<Self, TransportError> {
        if mesh.faces.is_empty() {
            return Err(TransportError::Empty);
        }
        if mesh.faces.len() > MAX_MESH_FACES {
            return Err(TransportError::TooMany(mesh.faces.len()));
        }
        if !(16..=max_block_faces()).contains(&options.block_faces) {
            return Err(TransportError::Block(options.block_faces));
        }
        let (grid, cells) = QuantizationGrid::of(mesh, options.quantization)?;
        let walks = walks(&mesh.faces, &cells, options.block_faces);
        let mut this = write(grid, &cells, &walks, mesh.faces.len());
        this.left_out = left_out(mesh);
        Ok(this)
    }
}

fn left_out(mesh: &Mesh) -> Vec<LeftOut> {
    let is_left = [
        (mesh.attributes.is_some(), LeftOut::Attributes),
        (mesh.materials.is_some(), LeftOut::Materials),
        (mesh.objects.is_some(), LeftOut::Objects),
        (mesh.used_vertices().contains(&false), LeftOut::UnusedVertices),
    ];
    is_left.into_iter().filter(|(is_left, _)| *is_left).map(|(_, what)| what).collect()
}

/// Partitions faces into blocks and walks over each.
pub(super) fn walks(faces: &[[VertexId; 3]], cells: &[CellVec], size: usize) -> Vec<BlockWalk> {
    let connectivity = Connectivity::new(faces, cells.len());
    let blocks = face_blocks(faces, cells, &connectivity, size);
    let mut walker = Walker::new(faces, &connectivity, blocks.of.clone());
    blocks.members().zip(0..).map(|(members, block)| walker.walk(block, members)).collect()
}

fn write(
    grid: QuantizationGrid,
    cells: &[CellVec],
    walks: &[BlockWalk],
    faces: usize,
) -> Transport {
    let mut codes = fit(walks, cells);
    let models = Models::new(&codes);
    let residuals = walks.chunks(LANES).flat_map(|walks| residuals(walks, cells, &models));
    let residuals: Vec<_> = residuals.take(walks.len()).collect();
    codes.shapes = shapes(residuals.iter().flatten());
    let models = Models::new(&codes);
    let first_bits = [0, 1, 2].map(|k| {
        let most = walks.iter().map(|walk| cells[walk.vertices[0] as usize][k] as u32).max();
        (u32::BITS - most.unwrap_or(0).leading_zeros()) as u8
    });
    let (tags, vertices) = tags(walks, cells);
    let mut payload = Vec::new();
    let mut entries = Vec::with_capacity(walks.len());
    let mut row = Vec::new();
    let mut bits = SymbolBits::default();
    for ((walk, residuals), tags) in walks.iter().zip(&residuals).zip(&tags) {
        row.clear();
        let first = cells[walk.vertices[0] as usize];
        let parts = symbols(walk, (first, first_bits), tags, residuals, &models, &mut row);
        bits.add(&row, parts);
        let start = payload.len();
        let sum = checksum(walk.vertices.iter().map(|&v| cells[v as usize]));
        encode(&row, sum, &mut payload);
        let least = (walk.faces / FACES_PER_BYTE).next_multiple_of(2);
        payload.resize(payload.len().max(start + least), 0);
        entries.push(Entry { faces: walk.faces, bytes: payload.len() - start });
    }
    let header = Header { grid, first_bits, faces, vertices, codes, entries };
    let mut bytes = header.store(&payload);
    bytes.extend(payload);
    let positions = bits.positions / 8.0;
    let connectivity = bits.connectivity / 8.0;
    let headers = bytes.len() as f64 - positions - connectivity;
    let sizes = TransportSizes { positions, connectivity, headers };
    Transport { bytes, blocks: walks.len(), sizes, left_out: Vec::new() }
}

/// Counts the bits of symbols.
struct SymbolBits {
    positions: f64,
    connectivity: f64,
    log2: Vec<f64>,
}

impl Default for SymbolBits {
    fn default() -> Self {
        let log2 = (0..=4096).map(|size| f64::from(size).log2()).collect();
        Self { positions: 0.0, connectivity: 0.0, log2 }
    }
}

impl SymbolBits {
    /// Adds the symbols of a block. Residuals of positions are in the given range, all else is
    /// connectivity.
    fn add(&mut self, symbols: &[Symbol], [connectivity, positions]: [usize; 2]) {
        let bits = |symbols: &[Symbol]| -> f64 {
            let bits = |s: &Symbol| {
                f64::from(s.bits) + f64::from(s.low_bits) - self.log2[usize::from(s.size)]
            };
            symbols.iter().map(bits).sum()
        };
        let of_positions = bits(&symbols[connectivity..positions]);
        let all = bits(symbols);
        self.positions += of_positions;
        self.connectivity += all - of_positions;
    }
}

/// Returns the vertices of each block that need a tag, and the number of vertices of the mesh.
fn tags(walks: &[BlockWalk], cells: &[CellVec]) -> (Vec<Vec<(u16, u32)>>, usize) {
    let mut uses = vec![0u8; cells.len()];
    for &v in walks.iter().flat_map(|walk| &walk.vertices) {
        uses[v as usize] = uses[v as usize].saturating_add(1);
    }
    // Number of tags used in each cell so far.
    let mut welds = WeldTable::new(1 << 10);
    let mut tag_of = vec![u32::MAX; cells.len()];
    let tags = walks.iter().map(|walk| {
        let mut tags = Vec::new();
        for (local, (&v, &is_border)) in walk.vertices.iter().zip(&walk.borders).enumerate() {
            let v = v as usize;
            if !is_border && uses[v] == 1 {
                continue;
            }
            if tag_of[v] == u32::MAX {
                let next = welds.find_or_insert(key(cells[v]), 0, 0);
                tag_of[v] = *next;
                *next += 1;
            }
            if tag_of[v] > 0 || !is_border {
                tags.push((local as u16, tag_of[v]));
            }
        }
        tags
    });
    let tags = tags.collect();
    (tags, uses.iter().filter(|&&uses| uses > 0).count())
}
