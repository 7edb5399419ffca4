//! The faces sorted by cells: runs of vertices short enough that their records stay in the cache
//! while their rings are built, and that threads can share.

use rayon::prelude::*;

use crate::kernel::setup::vertex_order::is_face;

/// Number of vertices in a cell: 128 kB of records.
pub(crate) const CELL: usize = 1 << 10;

/// Smallest number of faces that one thread sorts at a time.
const BLOCK: usize = 1 << 16;

/// Largest number of blocks: each stores one number per cell.
const BLOCKS: usize = 64;

/// Faces of three different vertices by the cells of their corners, in input order. A face with
/// corners in two cells is in both.
pub(crate) struct CellFaces {
    blocks: Vec<Block>,
    /// Number of faces, each counted once.
    pub(crate) faces: usize,
}

/// A run of the faces, sorted by cell.
struct Block {
    by_cell: Vec<[u32; 3]>,
    /// End of each cell's faces in `by_cell`.
    ends: Vec<u32>,
    faces: usize,
}

impl CellFaces {
    /// Sorts `count` faces of this many vertices.
    pub(crate) fn new(
        vertices: usize,
        count: usize,
        face: impl Fn(usize) -> [u32; 3] + Sync,
    ) -> Self {
        let cells = vertices.div_ceil(CELL);
        let size = BLOCK.max(count.div_ceil(BLOCKS));
        let block = |i: usize| Block::new(cells, i * size..count.min((i + 1) * size), &face);
        let blocks: Vec<Block> = (0..count.div_ceil(size)).into_par_iter().map(block).collect();
        let faces = blocks.iter().map(|block| block.faces).sum();
        Self { blocks, faces }
    }

    /// Returns the faces with a corner in a cell.
    pub(crate) fn of(&self, cell: usize) -> impl Iterator<Item = &[[u32; 3]]> {
        self.blocks.iter().map(move |block| {
            let start = if cell == 0 { 0 } else { block.ends[cell - 1] };
            &block.by_cell[start as usize..block.ends[cell] as usize]
        })
    }
}

impl Block {
    fn new(cells: usize, range: std::ops::Range<usize>, face: &impl Fn(usize) -> [u32; 3]) -> Self {
        let faces: Vec<[u32; 3]> = range.map(face).filter(|&face| is_face(face)).collect();
        let mut slots = vec![0; cells];
        for &face in &faces {
            for_cells(face, |cell| slots[cell] += 1);
        }
        let mut sum = 0;
        for slot in &mut slots {
            sum += std::mem::replace(slot, sum);
        }
        let mut by_cell = vec![[0; 3]; sum as usize];
        for &face in &faces {
            for_cells(face, |cell| {
                by_cell[slots[cell] as usize] = face;
                slots[cell] += 1;
            });
        }
        Self { by_cell, ends: slots, faces: faces.len() }
    }
}

/// Calls `act` for each cell that contains a corner of a face.
#[inline(always)]
fn for_cells([a, b, c]: [u32; 3], mut act: impl FnMut(usize)) {
    let (a, b, c) = (a as usize / CELL, b as usize / CELL, c as usize / CELL);
    act(a);
    if b != a {
        act(b);
    }
    if c != a && c != b {
        act(c);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_has_the_faces_of_its_corners_once_and_in_order() {
        let far = 2 * CELL as u32 + 5;
        let faces = [[0, 1, 2], [3, far, 1], [far, far + 1, 0], [7, 7, 9], [2, 1, 0]];
        let cells = CellFaces::new(3 * CELL, faces.len(), |i| faces[i]);
        let of = |cell| cells.of(cell).flatten().copied().collect::<Vec<_>>();
        assert_eq!(of(0), [faces[0], faces[1], faces[2], faces[4]]);
        assert_eq!(of(1), [[0; 3]; 0]);
        assert_eq!(of(2), [faces[1], faces[2]]);
        assert_eq!(cells.faces, 4);
    }
}
