//! What a user asks for, and what a scheme must do for it.

use meshlod_mesh::{Bounds, Mesh, VertexId};

use super::{CompressError, Compressed};
use crate::attributes::AttributeBounds;
use crate::blocks::{BlocksError, Closeness, VertexBlocks};
use crate::lattice::{Lattice, LatticeBlocks};
use crate::parts::{Cells, Parting, Parts, PartsError};

/// How positions are told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Eight bits an axis, in parts that share one grid [LCL10].
    Parts(Cells),
    /// On a lattice that meshes can share, with cells of a power of two.
    Lattice,
    /// In blocks of 32 vertices, each in cells that lie as the surface does.
    Blocks,
}

/// How well, or in how little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// As close to the surface as cubic cells of the longest side / (2^bits - 1), from 2 to 24, for the whole mesh, each
    /// vertex in the middle of its own. What is [`Cells::Truncated`] is held against the same, truncated.
    Bits(u32),
    /// The mean distance between the surfaces, in model units.
    Error(f64),
    /// How much less than three `f32` a vertex positions take, as a part.
    Reduction(f64),
}

/// A mesh that is compressed as well as it could be.
#[derive(Clone, Debug, PartialEq)]
pub struct Compression {
    /// The mesh.
    pub compressed: Compressed,
    /// The vertex of the input that each of [`Compressed::decode`] is.
    pub vertices: Vec<VertexId>,
    /// Whether it is what was asked for.
    pub reached: bool,
}

/// The mean distance of a surface whose vertices are rounded to cubic cells, in their sides: a vertex leaves the surface by
/// √1/12 of one in the root of the mean square, what is between three of them by √1/2 of that, and a mean is √2/π of that:
/// .163. Seven meshes of docs/notes/compression.md have .156 to .168.
const MEAN_OF_CELL: f64 = 1.0 / 6.0;
/// Where vertices are at the least corner of their cells: the same meshes have .42 to .48, and what is flat .51.
const MEAN_OF_TRUNCATED: f64 = 0.45;
const BITS: std::ops::RangeInclusive<u32> = 2..=24;

/// Compresses a mesh by a scheme, as well or as small as asked.
///
/// A reduction that the mesh is too small for is met as far as it goes.
/// # Errors
/// A target that is none, no mesh, or what the scheme refuses.
pub fn compress(
    mesh: &Mesh,
    scheme: Scheme,
    target: Target,
    bounds: &AttributeBounds,
) -> Result<Compression, CompressError> {
    super::check(mesh)?;
    match scheme {
        Scheme::Parts(cells) => in_parts(mesh, cells, target, bounds),
        Scheme::Lattice => on_lattice(mesh, target, bounds),
        Scheme::Blocks => in_blocks(mesh, target, bounds),
    }
}

/// A target as schemes see it.
enum Goal {
    /// Cells of this side, for the whole mesh.
    Cell(f64),
    Reduction(f64),
}

impl Target {
    /// The side of cubic cells that are as good for a mesh, each vertex in the middle of its own; none of a reduction.
    ///
    /// # Errors
    /// A target that is none.
    pub fn cell(self, mesh: &Mesh) -> Result<Option<f64>, CompressError> {
        Ok(match self.goal(mesh, MEAN_OF_CELL)? {
            Goal::Cell(side) => Some(side),
            Goal::Reduction(_) => None,
        })
    }

    fn goal(self, mesh: &Mesh, mean_of_cell: f64) -> Result<Goal, CompressError> {
        match self {
            Self::Bits(bits) if BITS.contains(&bits) => {
                let (longest, farthest) = extent(&mesh.bounds());
                // What is in one place has no sides: cells there are as fine as `f32`.
                let side = if longest > 0.0 { longest } else { farthest.max(1.0) * 2f64.powi(-24) };
                Ok(Goal::Cell(side / f64::from((1u32 << bits) - 1)))
            }
            Self::Bits(bits) => Err(CompressError::Bits(bits)),
            Self::Error(mean) if mean > 0.0 && mean.is_finite() => {
                Ok(Goal::Cell(mean / mean_of_cell))
            }
            Self::Error(mean) => Err(CompressError::Error(mean)),
            Self::Reduction(part) if part > 0.0 && part < 1.0 => Ok(Goal::Reduction(part)),
            Self::Reduction(part) => Err(CompressError::Reduction(part)),
        }
    }
}

/// The longest side of a box, and how far from the origin it goes.
fn extent(bounds: &Bounds) -> (f64, f64) {
    let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    let farthest = bounds.min.iter().chain(&bounds.max).fold(0.0, |most: f64, x| most.max(x.abs()));
    (longest, farthest)
}

/// The parts of a mesh that meet a target, and whether they do: as [`compress`] makes them.
///
/// # Errors
/// A target that is none, a mesh without faces or with coordinates that are none.
pub fn parts_for(
    mesh: &Mesh,
    cells: Cells,
    target: Target,
) -> Result<(Parts, bool), CompressError> {
    let parting = Parting::new(mesh)?;
    let mean = if cells == Cells::Centred { MEAN_OF_CELL } else { MEAN_OF_TRUNCATED };
    match target.goal(mesh, mean)? {
        Goal::Cell(cell) => {
            let parts = parting.within_cell(cell, cells);
            let reached = parts.mean_side() <= cell;
            Ok((parts, reached))
        }
        Goal::Reduction(part) => match parting.within_reduction(part, cells) {
            Err(PartsError::TooSmall { .. }) => Ok((parting.into_count(1, cells), false)),
            parts => Ok((parts?, true)),
        },
    }
}

fn in_parts(
    mesh: &Mesh,
    cells: Cells,
    target: Target,
    bounds: &AttributeBounds,
) -> Result<Compression, CompressError> {
    let (parts, reached) = parts_for(mesh, cells, target)?;
    Ok(Compression { reached, ..Compressed::in_parts(mesh, &parts, bounds)? })
}

fn on_lattice(
    mesh: &Mesh,
    target: Target,
    bounds: &AttributeBounds,
) -> Result<Compression, CompressError> {
    let (lattice, reached) = match target.goal(mesh, MEAN_OF_CELL)? {
        Goal::Cell(cell) => (Lattice::within(cell)?, true),
        Goal::Reduction(part) => finest(mesh, part)?,
    };
    let mut done = Compressed::on_lattice(mesh, lattice, bounds)?;
    if let (Target::Reduction(part), true) = (target, reached) {
        // Within blocks the order is another now, and so may be a bit.
        if done.compressed.reduction() < part {
            done = Compressed::on_lattice(mesh, lattice.coarser()?, bounds)?;
        }
    }
    Ok(Compression { reached, ..done })
}

/// The finest lattice that leaves a reduction, or that of a single cell, and whether it does.
fn finest(mesh: &Mesh, part: f64) -> Result<(Lattice, bool), CompressError> {
    let (longest, farthest) = extent(&mesh.bounds());
    // All of the mesh in a few cells.
    let coarsest =
        Lattice::within(2.0 * longest.max(farthest * 2f64.powi(-50)).max(f64::MIN_POSITIVE))?;
    let keeps =
        |lattice| Ok::<_, CompressError>(LatticeBlocks::new(mesh, lattice)?.reduction() >= part);
    let mut best = (coarsest, keeps(coarsest)?);
    while let (true, Ok(finer)) = (best.1, best.0.finer()) {
        // What is too fine is refused.
        if !matches!(keeps(finer), Ok(true)) {
            break;
        }
        best.0 = finer;
    }
    Ok(best)
}

fn in_blocks(
    mesh: &Mesh,
    target: Target,
    bounds: &AttributeBounds,
) -> Result<Compression, CompressError> {
    let (mut closeness, reached) = match (target.goal(mesh, MEAN_OF_CELL)?, target) {
        (Goal::Reduction(part), _) => closest(mesh, part)?,
        (Goal::Cell(_), Target::Bits(bits)) => (Closeness::Bits(bits), true),
        (Goal::Cell(cell), _) => (Closeness::Error(cell * MEAN_OF_CELL), true),
    };
    let mut done = Compressed::in_blocks(mesh, closeness, bounds)?;
    if let (Target::Reduction(part), true) = (target, reached) {
        // Within blocks the order is another now, and so may be a bit.
        while done.compressed.reduction() < part {
            let Some(coarser) = closeness.coarser() else { break };
            closeness = coarser;
            done = Compressed::in_blocks(mesh, closeness, bounds)?;
        }
    }
    let reached = match target {
        Target::Reduction(part) => done.compressed.reduction() >= part,
        _ => reached,
    };
    Ok(Compression { reached, ..done })
}

/// The least distance that is found to leave a reduction, or the greatest, and whether it does.
fn closest(mesh: &Mesh, part: f64) -> Result<(Closeness, bool), CompressError> {
    // The error of what keeps it.
    let keeps = |closeness| match VertexBlocks::new(mesh, closeness) {
        Ok((blocks, report)) => {
            Ok((blocks.reduction() >= part).then_some(report.blocks.error_estimate))
        }
        Err(BlocksError::TooFine(_)) => Ok(None),
        Err(error) => Err(error),
    };
    let mut best = (Closeness::Bits(*BITS.start()), None);
    let [mut most, mut fails] = [*BITS.start() - 1, *BITS.end() + 1];
    while fails - most > 1 {
        let middle = most.midpoint(fails);
        match keeps(Closeness::Bits(middle))? {
            Some(error) => (most, best) = (middle, (Closeness::Bits(middle), Some(error))),
            None => fails = middle,
        }
    }
    // Between that and a bit more.
    for quarters in [3.0, 2.0, 1.0] {
        let Some(error) = best.1.filter(|error| *error > 0.0) else { break };
        let finer = Closeness::Error(error * f64::exp2(-quarters / 4.0));
        if keeps(finer)?.is_some() {
            return Ok((finer, true));
        }
    }
    Ok((best.0, best.1.is_some()))
}
