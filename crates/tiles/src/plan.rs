//! Plan of all tiles: a function of the model and the request alone.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use meshlod_io::{Image, Material};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

use crate::cell::{Cell, MOST_DEPTH};
use crate::cut::{Cutter, Piece};
use crate::error::TilesError;
use crate::lattice::{BITS, Point, TileLattice};
use crate::layout::Layout;
use crate::octree::TileTree;
use crate::scratch::{Blocks, ScratchWriter};
use crate::source::{Source, Triangles};
use crate::texture::DecodedImages;

/// Depth of the grid in whose cells faces are counted first.
const FIRST_DEPTH: u8 = 7;

/// Depths that a crowded cell of the grid is counted anew by.
const MORE_DEPTHS: u8 = 4;

/// Size and form of tiles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TileOptions {
    /// Number of faces from which a cell is divided.
    pub most_faces: usize,
    /// True if contents are compressed by meshopt.
    pub meshopt: bool,
    /// True if tiles have skirts, as deep as the error of the next coarser level.
    pub skirts: bool,
    /// Matrix from the axes of the model to those of the tileset, whose z is up, and to its place
    /// on the globe if it has one; column-major.
    pub placement: [[f64; 4]; 4],
    /// True if z is up in the model.
    pub is_z_up: bool,
}

/// Plan of all tiles.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// Text that is different for another model.
    pub key: String,
    /// Size and form of tiles.
    pub options: TileOptions,
    /// Lattice of all vertices.
    pub lattice: TileLattice,
    /// Octree of the tiles.
    pub tree: TileTree,
    /// Values that corners have beside their points.
    pub layout: Layout,
    /// Names of the labels of materials.
    pub labels: Vec<String>,
    /// Materials by label.
    pub materials: Vec<Material>,
    /// Images of the materials, without their bytes.
    pub images: Vec<String>,
    /// Blocks of each leaf in the scratch file, by index of the node.
    pub blocks: Blocks,
    /// Number of faces of the model, without those whose corners the lattice joins.
    pub faces: usize,
    /// Number of faces of the model whose corners the lattice joins.
    pub degenerate: usize,
    /// Error of each depth, in steps of the lattice; 0 for the deepest.
    pub errors: Vec<f64>,
    /// Tasks by number: the node of each tile. Those that a tile is made from come before it.
    pub tasks: Vec<u32>,
}

/// Materials of a model, and their images.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// Names of the labels of faces.
    pub labels: Vec<String>,
    /// Material of each label.
    pub materials: Vec<Material>,
    /// Images of the materials.
    pub images: Vec<Image>,
    /// These images decoded.
    pub decoded: DecodedImages,
}

impl Plan {
    /// Makes the plan of a model: counts its faces in cells, divides these, and writes the pieces of
    /// all faces to a scratch file. The errors of levels are left at 0.
    ///
    /// # Errors
    /// Errors of the source and the file, and a model without faces or extent.
    pub fn new(
        source: &dyn Source,
        look: &Look,
        options: &TileOptions,
        scratch: &Path,
    ) -> Result<Self, TilesError> {
        let system = |error| TilesError::system(scratch, error);
        let bounds = source.bounds().map_err(system)?;
        if bounds.is_empty() {
            return Err(TilesError::NoFaces);
        }
        let lattice = TileLattice::over(&bounds).ok_or(TilesError::NoExtent)?;
        let counted = Counted::of(source, &lattice, options.most_faces).map_err(system)?;
        if counted.faces == 0 {
            return Err(TilesError::NoFaces);
        }
        let tree = TileTree::divide(|cell| counted.faces_in(cell) > options.most_faces);
        let layout = source.layout().clone();
        let leaves = tree.nodes().iter().filter(|node| node.children.is_none()).count();
        let sizes = [leaves, tree.nodes().len()];
        let blocks = {
            let file = BufWriter::with_capacity(1 << 20, File::create(scratch).map_err(system)?);
            let writer = ScratchWriter::new(&layout, !look.labels.is_empty(), sizes, file);
            scatter(source, (&lattice, &tree), writer).map_err(system)?
        };
        let tasks = tasks(&tree, &blocks);
        Ok(Self {
            key: String::new(),
            options: options.clone(),
            lattice,
            layout,
            labels: look.labels.clone(),
            materials: look.materials.clone(),
            images: look.images.iter().map(|image| image.name.clone()).collect(),
            errors: vec![0.0; usize::from(tree.depth()) + 1],
            tree,
            blocks,
            faces: counted.faces,
            degenerate: counted.degenerate,
            tasks,
        })
    }

    /// Returns the cell of a task.
    ///
    /// # Errors
    /// There is no such task.
    pub fn cell(&self, task: usize) -> Result<Cell, TilesError> {
        let tasks = self.tasks.len();
        let node = self.tasks.get(task).ok_or(TilesError::NoTask { task, tasks })?;
        Ok(self.tree.nodes()[*node as usize].cell)
    }

    /// Returns the tasks of the parts of a tile, by number; none for a leaf.
    pub fn parts(&self, task: usize) -> Vec<usize> {
        let node = &self.tree.nodes()[self.tasks[task] as usize];
        let of = |child: u32| self.tasks.binary_search_by(|node| child.cmp(node)).ok();
        let children = node.children.map_or(0..0, |first| first..first + 8);
        children.rev().filter_map(of).collect()
    }
}

/// Returns the nodes of all tiles that have faces, the last ones first.
fn tasks(tree: &TileTree, blocks: &Blocks) -> Vec<u32> {
    let mut is_used = vec![false; tree.nodes().len()];
    let mut tasks = Vec::new();
    for (i, node) in tree.nodes().iter().enumerate().rev() {
        is_used[i] = match node.children {
            Some(first) => (first as usize..first as usize + 8).any(|child| is_used[child]),
            None => !blocks[i].is_empty(),
        };
        if is_used[i] {
            tasks.push(i as u32);
        }
    }
    tasks
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

/// Number of triangles that are cut by one thread at a time.
const CUT_AT_ONCE: usize = 2048;

/// Cuts all triangles of a source, and writes their pieces.
fn scatter<W: io::Write>(
    source: &dyn Source,
    (lattice, tree): (&TileLattice, &TileTree),
    mut writer: ScratchWriter<'_, W>,
) -> io::Result<Blocks> {
    let cutter = Cutter::new(tree);
    let layout = source.layout();
    let width = layout.width();
    source.triangles(&mut |some| {
        let cut = |(chunk, places): (usize, &[[[f64; 3]; 3]])| {
            let mut pieces: Vec<(usize, usize, Piece)> = Vec::with_capacity(2 * places.len());
            for (i, places) in places.iter().enumerate() {
                let points = places.map(|place| lattice.point(place));
                let triangle = chunk * CUT_AT_ONCE + i;
                cutter.cut(points, &mut |leaf, piece| pieces.push((triangle, leaf, piece)));
            }
            pieces
        };
        let cut: Vec<_> = some.places.par_chunks(CUT_AT_ONCE).enumerate().map(cut).collect();
        let mut values = Vec::new();
        for (triangle, leaf, piece) in cut.into_iter().flatten() {
            let of = &some.values[triangle * 3 * width..][..3 * width];
            let own = [0, 1, 2].map(|i| &of[i * width..][..width]);
            values.clear();
            for corner in piece {
                match corner.weights.iter().position(|&weight| weight == 1.0) {
                    Some(i) => values.extend_from_slice(own[i]),
                    None => layout.blend(own, corner.weights, &mut values),
                }
            }
            let values = [0, 1, 2].map(|i| &values[i * width..][..width]);
            let points: [Point; 3] = piece.map(|corner| corner.at);
            writer.add(leaf, points, values, some.materials[triangle])?;
        }
        Ok(())
    })?;
    Ok(writer.finish()?.0)
}
