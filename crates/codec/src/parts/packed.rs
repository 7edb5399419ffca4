//! Positions of parts as files store them, in a given order.

use meshlod_mesh::VertexId;

use super::grid::{MAX_OFFSET, Reconstruction, SharedGrid};
use super::stored::{StoredPart, StoredParts};
use super::{HEADER, Part, Parts, part_header};
use crate::bytes::{Malformed, Reader};
use crate::patch::Rows;

/// Positions of nodes; each part is a row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PackedParts {
    grid: SharedGrid,
    /// Number of vertices that the nodes belong to.
    vertices: u32,
    rows: Rows,
    offsets: Vec<[i32; 3]>,
    positions: Vec<[u8; 3]>,
}

/// Flag: vertices are in the middles of their cells.
const CENTRED: u8 = 1;
/// Flag: offsets have 32 bits per axis.
const LONG: u8 = 2;

impl PackedParts {
    /// Packs the positions of nodes, given as vertices in the order of the parts.
    ///
    /// # Panics
    /// If a part does not have its node.
    pub(crate) fn new(parts: &Parts, rows: Rows, nodes: &[VertexId]) -> Self {
        let position = |(row, part): (usize, &Part)| {
            let of =
                |v: &VertexId| part.positions[part.vertices.binary_search(v).expect("its own")];
            nodes[rows.range(row)].iter().map(of).collect::<Vec<_>>()
        };
        let positions = parts.parts.iter().enumerate().flat_map(position).collect();
        let offsets = parts.parts.iter().map(|part| part.offset).collect();
        Self { grid: parts.grid, vertices: parts.vertices as u32, rows, offsets, positions }
    }

    pub(crate) fn vertices(&self) -> usize {
        self.vertices as usize
    }

    /// Returns the nodes of each part.
    pub(crate) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Returns the grid cell of each node.
    pub(crate) fn cells(&self) -> Vec<[i32; 3]> {
        self.each(|offset, position| [0, 1, 2].map(|k| offset[k] + i32::from(position[k])))
    }

    /// Decodes the position of each node.
    pub(crate) fn positions(&self) -> Vec<[f64; 3]> {
        self.each(|offset, position| self.grid.place(offset, position))
    }

    /// Decodes the position of one node.
    pub(crate) fn position(&self, node: usize) -> [f64; 3] {
        let (part, _) = self.rows.place(node as u32);
        self.grid.place(self.offsets[part], self.positions[node])
    }

    /// Returns the parts as they are stored.
    pub(crate) fn stored(&self) -> StoredParts<'_> {
        let part = |(row, &offset): (usize, &[i32; 3])| {
            let nodes = self.rows.range(row);
            StoredPart { offset, nodes: nodes.start as u32..nodes.end as u32 }
        };
        StoredParts {
            cell: self.grid.cell(),
            within: if self.grid.is_centred() { 0.5 } else { 0.0 },
            parts: self.offsets.iter().enumerate().map(part).collect(),
            positions: &self.positions,
        }
    }

    fn each<T>(&self, of: impl Fn([i32; 3], [u8; 3]) -> T) -> Vec<T> {
        let rows = self.offsets.iter().enumerate();
        let nodes =
            rows.flat_map(|(row, &offset)| self.rows.range(row).map(move |at| (offset, at)));
        nodes.map(|(offset, at)| of(offset, self.positions[at])).collect()
    }

    pub(crate) fn bytes(&self) -> usize {
        HEADER + self.offsets.len() * part_header(&self.offsets) + 3 * self.positions.len()
    }

    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        let is_long = part_header(&self.offsets) > part_header(&[]);
        out.push(if is_long { LONG } else { 0 } | if self.grid.is_centred() { CENTRED } else { 0 });
        out.extend(self.vertices.to_le_bytes());
        out.extend((self.offsets.len() as u32).to_le_bytes());
        out.extend(self.grid.cell().iter().flat_map(|side| side.to_le_bytes()));
        for (row, offset) in self.offsets.iter().enumerate() {
            out.extend((self.rows.range(row).len() as u32).to_le_bytes());
            for x in offset {
                let bytes = x.to_le_bytes();
                out.extend(if is_long { &bytes[..] } else { &bytes[..2] });
            }
        }
        out.extend(self.positions.as_flattened());
    }

    pub(crate) fn restore(reader: &mut Reader) -> Result<Self, Malformed> {
        let flags = reader.u8()?;
        if flags & !(CENTRED | LONG) != 0 {
            return Err(reader.wrong(format!("unknown flags {flags:#x}")));
        }
        let (vertices, count) = (reader.u32()?, reader.u32()?);
        let cell = [reader.f32()?, reader.f32()?, reader.f32()?];
        let cells =
            if flags & CENTRED == 0 { Reconstruction::Truncated } else { Reconstruction::Centred };
        let grid = SharedGrid::of_cells(cell, cells)
            .ok_or_else(|| reader.wrong("the cells have no size"))?;
        let (mut sizes, mut offsets) = (Vec::new(), Vec::new());
        for _ in 0..count {
            sizes.push(reader.u32()? as usize);
            let mut axis = || match flags & LONG {
                0 => reader.u16().map(|x| i32::from(x as i16)),
                _ => reader.i32(),
            };
            let offset = [axis()?, axis()?, axis()?];
            if offset.iter().any(|x| x.abs_diff(0) > MAX_OFFSET) {
                return Err(reader.wrong("a part is too far from the origin for f32"));
            }
            offsets.push(offset);
        }
        let nodes: u64 = sizes.iter().map(|&size| size as u64).sum();
        if nodes > u32::MAX.into() || u64::from(vertices) > nodes || (vertices == 0) != (nodes == 0)
        {
            return Err(reader.wrong(format!("{vertices} vertices cannot have {nodes} positions")));
        }
        let size = usize::try_from(3 * nodes).unwrap_or(usize::MAX);
        let (positions, _) = reader.take(size)?.as_chunks();
        Ok(Self { grid, vertices, rows: Rows::new(sizes), offsets, positions: positions.to_vec() })
    }
}
