//! Survey of a model: its faces counted in cells, and the octree that follows from that.

use std::io;
use std::path::Path;

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::cell::{Cell, MOST_DEPTH};
use crate::error::TilesError;
use crate::lattice::{BITS, TileLattice};
use crate::octree::TileTree;
use crate::source::{Source, Triangles};

/// Depth of the grid in whose cells faces are counted first.
const FIRST_DEPTH: u8 = 7;

/// Depths that a crowded cell of the grid is counted anew by.
const MORE_DEPTHS: u8 = 4;

/// Model that has been gone through once, or more often where it is crowded.
#[derive(Clone, Debug)]
pub struct Survey {
    /// Lattice of all vertices.
    pub lattice: TileLattice,
    /// Octree of the tiles.
    pub tree: TileTree,
    /// Number of faces, without those whose corners the lattice joins.
    pub faces: usize,
    /// Number of faces whose corners the lattice joins.
    pub degenerate: usize,
}

impl Survey {
    /// Counts the faces of a model in cells, and divides those that have more than `most_faces`.
    ///
    /// # Errors
    /// Errors of the source, and a model without faces or extent.
    pub fn of(source: &dyn Source, most_faces: usize) -> Result<Self, TilesError> {
        let system = |error| TilesError::system(Path::new(""), error);
        let bounds = source.bounds().map_err(system)?;
        if bounds.is_empty() {
            return Err(TilesError::NoFaces);
        }
        let lattice = TileLattice::over(&bounds).ok_or(TilesError::NoExtent)?;
        let counted = Counted::of(source, &lattice, most_faces).map_err(system)?;
        if counted.faces == 0 {
            return Err(TilesError::NoFaces);
        }
        let tree = TileTree::divide(|cell| counted.faces_in(cell) > most_faces);
        Ok(Self { lattice, tree, faces: counted.faces, degenerate: counted.degenerate })
    }
}

/// Numbers of faces in cells, by the middle of each face.
struct Counted {
    faces: usize,
    degenerate: usize,
    /// By cell of any depth: number of faces in it.
    of_cell: FxHashMap<Cell, usize>,
}

impl Counted {
    fn of(source: &dyn Source, lattice: &TileLattice, most: usize) -> io::Result<Self> {
        let mut this = Self { faces: 0, degenerate: 0, of_cell: FxHashMap::default() };
        let mut fine: FxHashMap<Cell, usize> = FxHashMap::default();
        source.triangles(&mut |some| {
            let cells = cells_of(some, lattice, FIRST_DEPTH);
            this.degenerate += cells.iter().filter(|cell| cell.is_none()).count();
            this.faces += cells.iter().flatten().count();
            cells.into_iter().flatten().for_each(|cell| *fine.entry(cell).or_default() += 1);
            Ok(())
        })?;
        let mut depth = FIRST_DEPTH;
        this.add(fine, 0);
        // Few models have cells that are still crowded; each pass goes through all faces again.
        while depth < MOST_DEPTH {
            let is_crowded =
                |(cell, faces): &(&Cell, &usize)| cell.depth == depth && **faces > most;
            let crowded: FxHashMap<Cell, ()> =
                this.of_cell.iter().filter(is_crowded).map(|(cell, _)| (*cell, ())).collect();
            if crowded.is_empty() {
                break;
            }
            let next = (depth + MORE_DEPTHS).min(MOST_DEPTH);
            let mut fine: FxHashMap<Cell, usize> = FxHashMap::default();
            source.triangles(&mut |some| {
                let cells = cells_of(some, lattice, next);
                let is_inside = |cell: &Cell| crowded.contains_key(&above(*cell, depth));
                let inside = cells.into_iter().flatten().filter(is_inside);
                inside.for_each(|cell| *fine.entry(cell).or_default() += 1);
                Ok(())
            })?;
            this.add(fine, depth + 1);
            depth = next;
        }
        Ok(this)
    }

    /// Adds counts of cells of one depth, and their sums up to another.
    fn add(&mut self, fine: FxHashMap<Cell, usize>, up_to: u8) {
        for (cell, faces) in fine {
            for depth in up_to..=cell.depth {
                *self.of_cell.entry(above(cell, depth)).or_default() += faces;
            }
        }
    }

    fn faces_in(&self, cell: Cell) -> usize {
        self.of_cell.get(&cell).copied().unwrap_or(0)
    }
}

/// Returns the cell of a lesser depth that another one is in.
fn above(cell: Cell, depth: u8) -> Cell {
    let by = cell.depth - depth;
    Cell { depth, at: cell.at.map(|at| at >> by) }
}

/// Returns the cell of a depth that each triangle has its middle in; `None` where two corners are
/// at one point.
fn cells_of(some: &Triangles, lattice: &TileLattice, depth: u8) -> Vec<Option<Cell>> {
    let cell = |places: &[[f64; 3]; 3]| {
        let [a, b, c] = places.map(|place| lattice.point(place));
        if a == b || b == c || c == a {
            return None;
        }
        let at = [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) as u32 / 3);
        Some(Cell { depth, at: at.map(|x| x >> (BITS - u32::from(depth))) })
    };
    some.places.par_iter().with_min_len(1024).map(cell).collect()
}
