//! Refinement of blocks with distant vertices or flipped faces.

use glam::DVec3;
use rayon::prelude::*;

use super::fit::{Attempt, Fit, MAX_DISTANCE};
use crate::kd::BLOCK;

/// Rounds of refining blocks at most.
const ROUNDS: usize = 8;
const FINER: f64 = 0.6;
const FINEST: f64 = 1.0 / 8.0;
/// Number of distant vertices of a block up to which other cells are sought for them. On a plate a
/// third of all vertices were distant, a search for each took most of the time, and nearly none
/// succeeded.
const FEW_FAR: usize = BLOCK / 4;

impl Fit {
    /// Refines blocks with distant vertices or flipped faces, and returns how many were refined.
    pub(super) fn refine(&self, attempt: &mut Attempt) -> Option<usize> {
        let mut finer = vec![1.0; self.frames.len()];
        let mut doubtful: Vec<usize> = (0..self.surface.places.len()).collect();
        for _ in 0..ROUNDS {
            let Attempt { grids, assignment, .. } = &mut *attempt;
            let most = MAX_DISTANCE * self.most();
            let is_coarse = |block: &usize| finer[*block] > FINEST;
            let mut bad = self.flipped_blocks(&assignment.moved);
            bad.retain(is_coarse);
            // Blocks that are refined anyway need not be repaired.
            doubtful.retain(|v| bad.binary_search(&(v / BLOCK)).is_err());
            let mut far = assignment.far(&self.surface, most, &doubtful);
            bad.extend(blocks_with_many(&far).filter(is_coarse));
            bad.sort_unstable();
            far.retain(|v| bad.binary_search(&(v / BLOCK)).is_err());
            let far = assignment.repair(&self.surface, grids, most, far);
            // The cause may be a neighbour of the distant vertex.
            let far = self.surface.with_neighbours(far.into_iter());
            bad.extend(far.into_iter().map(|v| v / BLOCK).filter(is_coarse));
            bad.sort_unstable();
            bad.dedup();
            if bad.is_empty() {
                break;
            }
            for &block in &bad {
                finer[block] *= FINER;
                let sizes = self.sizes(attempt.scale * finer[block]);
                let header =
                    self.block(block).header(self.frames[block], &attempt.units, &sizes)?;
                attempt.grids[block] = self.grid(block, &header, &attempt.units);
                attempt.headers[block] = header;
            }
            let Attempt { grids, assignment, .. } = &mut *attempt;
            assignment.assign(&self.surface, grids, &self.options(), &bad);
            let vertices = bad.iter().flat_map(|&block| self.range(block));
            doubtful = self.surface.with_neighbours(vertices);
        }
        Some(finer.iter().filter(|&&by| by < 1.0).count())
    }

    /// Returns the blocks of all flipped faces, sorted.
    fn flipped_blocks(&self, moved: &[DVec3]) -> Vec<usize> {
        let faces = self.surface.faces.par_iter();
        let flipped = faces.filter(|face| self.surface.is_flipped(face, moved));
        let mut blocks: Vec<_> =
            flipped.flat_map_iter(|face| face.corners.map(|v| v as usize / BLOCK)).collect();
        blocks.sort_unstable();
        blocks.dedup();
        blocks
    }
}

/// Returns the blocks that have more than [`FEW_FAR`] of these vertices, which are sorted.
fn blocks_with_many(vertices: &[usize]) -> impl Iterator<Item = usize> {
    let of_blocks = vertices.chunk_by(|a, b| a / BLOCK == b / BLOCK);
    of_blocks.filter(|of| of.len() > FEW_FAR).map(|of| of[0] / BLOCK)
}
