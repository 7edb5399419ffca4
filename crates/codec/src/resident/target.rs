//! Compression targets, and how each scheme meets them.

use meshlod_mesh::{AttributeBounds, Bounds, Mesh, VertexId};

use super::encode::check;
use super::{CompressError, Compressed};
use crate::blocks::{Accuracy, BlocksError, VertexBlocks};
use crate::lattice::{Lattice, LatticeBlocks};
use crate::parts::{Partitioner, Parts, PartsError, Reconstruction};

/// Storage scheme for vertex positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Scheme {
    /// Positions in 8 bits per axis, in parts of the mesh that share one grid [LCL10].
    Parts(Reconstruction),
    /// Positions rounded to a lattice with power-of-two cells, which several meshes can share.
    Lattice,
    /// Positions in blocks of 32 vertices, each with cells that are aligned with the surface.
    Blocks,
}

/// Accuracy or size that a compressed mesh should have.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum CompressionTarget {
    /// Accuracy of a uniform grid over the whole mesh with this many bits per axis, from 2 to 24.
    ///
    /// The grid has cubic cells of the longest side / (2^bits - 1) and puts each vertex in the
    /// middle of its cell. [`Reconstruction::Truncated`] is compared with the same grid, truncated.
    Bits(u32),
    /// Mean distance between the original and the decoded surface, in model units.
    Error(f64),
    /// Fraction of position storage to save, compared with three `f32` for each vertex.
    Reduction(f64),
}

/// Result of [`compress`]: the compressed mesh, and whether it meets the target.
#[derive(Clone, Debug, PartialEq)]
pub struct Compression {
    /// The compressed mesh.
    pub compressed: Compressed,
    /// Vertex of the input that each vertex of [`Compressed::decode`] comes from.
    pub vertices: Vec<VertexId>,
    /// True if the requested accuracy or size was reached.
    pub reached: bool,
}

/// Mean distance to the surface after rounding vertices to cubic cells, in cell sides.
///
/// A vertex leaves the surface by √1/12 of a side in the root mean square, a point between three of
/// them by √1/2 of that, and the mean is √(2/π) of that: .163. Seven meshes of
/// docs/notes/compression.md have .156 to .168.
const MEAN_OF_CELL: f64 = 1.0 / 6.0;
/// As [`MEAN_OF_CELL`] with vertices at the least corners of their cells: the same meshes have .42
/// to .48, and flat ones .51.
const MEAN_OF_TRUNCATED: f64 = 0.45;
const BITS: std::ops::RangeInclusive<u32> = 2..=24;

/// Compresses a mesh by a given storage scheme, to an accuracy or a size.
///
/// If the mesh is too small for a reduction, the result has the largest one that was found, and
/// [`Compression::reached`] is false.
/// # Errors
/// An invalid target, an invalid mesh, or a mesh that the scheme refuses.
pub fn compress(
    mesh: &Mesh,
    scheme: Scheme,
    target: CompressionTarget,
    bounds: &AttributeBounds,
) -> Result<Compression, CompressError> {
    check(mesh)?;
    scheme.compress(mesh, target, bounds)
}

impl Scheme {
    fn compress(
        self,
        mesh: &Mesh,
        target: CompressionTarget,
        bounds: &AttributeBounds,
    ) -> Result<Compression, CompressError> {
        match self {
            Self::Parts(reconstruction) => in_parts(mesh, reconstruction, target, bounds),
            Self::Lattice => on_lattice(mesh, target, bounds),
            Self::Blocks => in_blocks(mesh, target, bounds),
        }
    }
}

/// Target in terms that all schemes share.
enum Goal {
    /// Side of the cubic cells of an equally accurate grid over the whole mesh.
    Cell(f64),
    Reduction(f64),
}

impl CompressionTarget {
    /// Returns the side in model units of the cubic cells that meet the target if vertices are
    /// decoded to their middles.
    ///
    /// A reduction has no such cells: `None`.
    /// # Errors
    /// An invalid target.
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
                // A mesh of one point has no sides: cells are as fine as `f32` there.
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

/// Returns the longest side of a box, and the largest absolute coordinate in it.
fn extent(bounds: &Bounds) -> (f64, f64) {
    let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    let farthest = bounds.min.iter().chain(&bounds.max).fold(0.0, |most: f64, x| most.max(x.abs()));
    (longest, farthest)
}

/// Partitions a mesh as [`compress`] does for [`Scheme::Parts`], and returns whether the target is
/// met.
///
/// # Errors
/// An invalid target, a mesh without faces, or a coordinate that is not finite.
pub fn parts_for(
    mesh: &Mesh,
    reconstruction: Reconstruction,
    target: CompressionTarget,
) -> Result<(Parts, bool), CompressError> {
    let partitioner = Partitioner::new(mesh)?;
    let mean =
        if reconstruction == Reconstruction::Centred { MEAN_OF_CELL } else { MEAN_OF_TRUNCATED };
    match target.goal(mesh, mean)? {
        Goal::Cell(cell) => {
            let parts = partitioner.within_cell(cell, reconstruction);
            let reached = parts.mean_side() <= cell;
            Ok((parts, reached))
        }
        Goal::Reduction(part) => match partitioner.within_reduction(part, reconstruction) {
            Err(PartsError::TooSmall { .. }) => {
                Ok((partitioner.with_count(1, reconstruction), false))
            }
            parts => Ok((parts?, true)),
        },
    }
}

fn in_parts(
    mesh: &Mesh,
    reconstruction: Reconstruction,
    target: CompressionTarget,
    bounds: &AttributeBounds,
) -> Result<Compression, CompressError> {
    let (parts, reached) = parts_for(mesh, reconstruction, target)?;
    Ok(Compression { reached, ..Compressed::in_parts(mesh, &parts, bounds)? })
}

fn on_lattice(
    mesh: &Mesh,
    target: CompressionTarget,
    bounds: &AttributeBounds,
) -> Result<Compression, CompressError> {
    let (lattice, reached) = match target.goal(mesh, MEAN_OF_CELL)? {
        Goal::Cell(cell) => (Lattice::within(cell)?, true),
        Goal::Reduction(part) => finest(mesh, part)?,
    };
    let mut done = Compressed::on_lattice(mesh, lattice, bounds)?;
    if let (CompressionTarget::Reduction(part), true) = (target, reached) {
        // The order within blocks has changed since the estimate, and with it the size by a few
        // bits.
        if done.compressed.reduction() < part {
            done = Compressed::on_lattice(mesh, lattice.coarser()?, bounds)?;
        }
    }
    Ok(Compression { reached, ..done })
}

/// Returns the finest lattice that gives a reduction, or else one of a few cells, and whether it
/// does.
fn finest(mesh: &Mesh, part: f64) -> Result<(Lattice, bool), CompressError> {
    let (longest, farthest) = extent(&mesh.bounds());
    // The whole mesh in a few cells.
    let coarsest =
        Lattice::within(2.0 * longest.max(farthest * 2f64.powi(-50)).max(f64::MIN_POSITIVE))?;
    let keeps =
        |lattice| Ok::<_, CompressError>(LatticeBlocks::new(mesh, lattice)?.reduction() >= part);
    let mut best = (coarsest, keeps(coarsest)?);
    while let (true, Ok(finer)) = (best.1, best.0.finer()) {
        // A lattice that is too fine is refused.
        if !matches!(keeps(finer), Ok(true)) {
            break;
        }
        best.0 = finer;
    }
    Ok(best)
}

fn in_blocks(
    mesh: &Mesh,
    target: CompressionTarget,
    bounds: &AttributeBounds,
) -> Result<Compression, CompressError> {
    let (mut accuracy, reached) = match (target.goal(mesh, MEAN_OF_CELL)?, target) {
        (Goal::Reduction(part), _) => closest(mesh, part)?,
        (Goal::Cell(_), CompressionTarget::Bits(bits)) => (Accuracy::Bits(bits), true),
        (Goal::Cell(cell), _) => (Accuracy::Error(cell * MEAN_OF_CELL), true),
    };
    let mut done = Compressed::in_blocks(mesh, accuracy, bounds)?;
    if let (CompressionTarget::Reduction(part), true) = (target, reached) {
        // The order within blocks has changed since the estimate, and with it the size by a few
        // bits.
        while done.compressed.reduction() < part {
            let Some(coarser) = accuracy.coarser() else { break };
            accuracy = coarser;
            done = Compressed::in_blocks(mesh, accuracy, bounds)?;
        }
    }
    let reached = match target {
        CompressionTarget::Reduction(part) => done.compressed.reduction() >= part,
        _ => reached,
    };
    Ok(Compression { reached, ..done })
}

/// Returns the best accuracy found that gives a reduction, or else the least, and whether it does.
fn closest(mesh: &Mesh, part: f64) -> Result<(Accuracy, bool), CompressError> {
    // The error, if the reduction is reached.
    let keeps = |accuracy| match VertexBlocks::new(mesh, accuracy) {
        Ok((blocks, report)) => {
            Ok((blocks.reduction() >= part).then_some(report.blocks.error_estimate))
        }
        Err(BlocksError::TooFine(_)) => Ok(None),
        Err(error) => Err(error),
    };
    let mut best = (Accuracy::Bits(*BITS.start()), None);
    let [mut most, mut fails] = [*BITS.start() - 1, *BITS.end() + 1];
    while fails - most > 1 {
        let middle = most.midpoint(fails);
        match keeps(Accuracy::Bits(middle))? {
            Some(error) => (most, best) = (middle, (Accuracy::Bits(middle), Some(error))),
            None => fails = middle,
        }
    }
    // Refine between that and one more bit.
    for quarters in [3.0, 2.0, 1.0] {
        let Some(error) = best.1.filter(|error| *error > 0.0) else { break };
        let finer = Accuracy::Error(error * f64::exp2(-quarters / 4.0));
        if keeps(finer)?.is_some() {
            return Ok((finer, true));
        }
    }
    Ok((best.0, best.1.is_some()))
}
