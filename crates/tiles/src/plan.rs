//! Plan of all tiles: a function of the model and the request alone.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use meshlod_io::{Image, Material};
use meshlod_picture::MAX_TEXELS;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::cell::Cell;
use crate::cut::{Cutter, Piece};
use crate::error::TilesError;
use crate::lattice::{Point, TileLattice};
use crate::layout::Layout;
use crate::octree::TileTree;
use crate::scratch::{Blocks, ScratchWriter};
use crate::source::Source;
use crate::survey::Survey;
use crate::texture::DecodedImages;

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
    pub images: Vec<PlanImage>,
    /// Blocks of each leaf in the scratch file, by index of the node, for as long as the plan is
    /// being made; then they are in a file of their own.
    #[serde(skip)]
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

/// Image of a plan's materials, which has a file of its own.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlanImage {
    /// Its name.
    pub name: String,
    /// Checksum of its bytes.
    pub checksum: u32,
}

impl PlanImage {
    fn of(image: &Image) -> Self {
        Self { name: image.name.clone(), checksum: crc32fast::hash(&image.bytes) }
    }
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

impl Look {
    /// Returns the number of images that are too large to be decoded at the resolution they have.
    pub fn large_images(&self) -> usize {
        let texels = |[width, height]: [u32; 2]| u64::from(width) * u64::from(height);
        let pixels = self.images.iter().filter_map(|image| image.header()?.pixels);
        pixels.filter(|&size| texels(size) > MAX_TEXELS).count()
    }
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
        Self::of_survey(Survey::of(source, options.most_faces)?, (source, look), options, scratch)
    }

    /// Makes the plan of a model that has been surveyed: as [`new`](Self::new), which counts first.
    ///
    /// # Errors
    /// Errors of the source and the file.
    pub fn of_survey(
        survey: Survey,
        (source, look): (&dyn Source, &Look),
        options: &TileOptions,
        scratch: &Path,
    ) -> Result<Self, TilesError> {
        let system = |error| TilesError::system(scratch, error);
        let file = File::create(scratch).map_err(system)?;
        let out = BufWriter::with_capacity(1 << 20, &file);
        let has_materials = !look.labels.is_empty();
        let (blocks, _) = scatter(source, &survey, has_materials, out).map_err(system)?;
        // A disk that is full may only say so now.
        file.sync_all().map_err(system)?;
        let Survey { lattice, tree, faces, degenerate } = survey;
        let tasks = tasks(&tree, &blocks);
        Ok(Self {
            key: String::new(),
            options: options.clone(),
            lattice,
            layout: source.layout().clone(),
            labels: look.labels.clone(),
            materials: look.materials.clone(),
            images: look.images.iter().map(PlanImage::of).collect(),
            errors: vec![0.0; usize::from(tree.depth()) + 1],
            tree,
            blocks,
            faces,
            degenerate,
            tasks,
        })
    }

    /// Returns true if the parts of a plan that was read fit together.
    pub(crate) fn is_sound(&self) -> bool {
        let depth = usize::from(self.tree.depth());
        let nodes = self.tree.nodes().len() as u32;
        let is_number = |x: &f64| x.is_finite();
        self.errors.len() == depth + 1
            && self.errors.iter().all(|error| is_number(error) && *error >= 0.0)
            && self.labels.len() == self.materials.len()
            && self.lattice.step.is_normal()
            && self.lattice.origin.iter().all(is_number)
            && self.options.placement.as_flattened().iter().all(is_number)
            && self.tasks.first().is_some_and(|&node| node < nodes)
            && self.tasks.last() == Some(&0)
            && self.tasks.is_sorted_by(|a, b| a > b)
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

/// Number of triangles that are cut by one thread at a time.
const CUT_AT_ONCE: usize = 2048;

/// Cuts all triangles of a source, and writes their pieces. Returns the blocks of each node, and the
/// number of bytes.
pub(crate) fn scatter<W: io::Write>(
    source: &dyn Source,
    survey: &Survey,
    has_materials: bool,
    out: W,
) -> io::Result<(Blocks, u64)> {
    let Survey { lattice, tree, .. } = survey;
    let leaves = tree.nodes().iter().filter(|node| node.children.is_none()).count();
    let sizes = [leaves, tree.nodes().len()];
    let mut writer = ScratchWriter::new(source.layout(), has_materials, sizes, out);
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
    writer.finish()
}
