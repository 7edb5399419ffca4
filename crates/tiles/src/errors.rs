//! Errors of the levels, chosen from what some leaves lose when they are simplified.

use meshlod_mesh::Mesh;
use rayon::prelude::*;

use crate::coarser::Coarsen;
use crate::error::TilesError;
use crate::folder::Folder;
use crate::plan::Plan;

/// Number of leaves that are simplified to see what errors levels need.
const PROBED: usize = 8;

/// Levels above a leaf that it is simplified for.
const LEVELS: usize = 3;

/// Least and greatest factor from the error of a level to that of the next coarser one.
const GROWTH: [f64; 2] = [2.0, 4.0];

/// Factor where nothing is known.
const USUAL: f64 = 3.0;

/// Finds the error of each depth at which tiles have about as many faces as leaves: four children
/// are as many as a surface has. Errors are what each step from a level to the next may add, in
/// steps of the lattice.
///
/// # Errors
/// Errors of files and of the method.
pub fn find_errors<C: Coarsen + Sync>(
    plan: &Plan,
    folder: &Folder,
    method: &C,
) -> Result<Vec<f64>, TilesError> {
    let depth = usize::from(plan.tree.depth());
    let mut votes: Vec<Vec<f64>> = vec![Vec::new(); depth];
    let probed: Vec<(usize, Vec<f64>)> = probes(plan)
        .into_par_iter()
        .map(|task| {
            let cell = plan.cell(task)?;
            let leaf = folder.leaf(plan, task)?;
            let fail = |error: C::Error| simplify_error(cell, &error);
            let losses = losses(&leaf.mesh, method).map_err(fail)?;
            Ok::<_, TilesError>((usize::from(cell.depth), losses))
        })
        .collect::<Result<_, _>>()?;
    for (of, losses) in probed {
        for (i, loss) in losses.into_iter().enumerate().filter(|(i, _)| *i < of) {
            votes[of - 1 - i].push(loss);
        }
    }
    let width = f64::from(crate::lattice::END);
    let mut whole: Vec<f64> = vec![0.0; depth + 1];
    for at in (0..depth).rev() {
        votes[at].sort_by(f64::total_cmp);
        let last = whole[at + 1];
        let growth = match whole.get(at + 2) {
            Some(&before) if before > 0.0 => (last / before).clamp(GROWTH[0], GROWTH[1]),
            _ => USUAL,
        };
        let found = votes[at].get(votes[at].len() / 2).copied();
        let least = if last > 0.0 { GROWTH[0] * last } else { 2.0 };
        whole[at] = found.unwrap_or(growth * last).max(least).min(width);
    }
    Ok((0..=depth).map(|at| whole[at] - whole.get(at + 1).unwrap_or(&whole[at])).collect())
}

/// Returns leaves with many faces, from all over the model.
fn probes(plan: &Plan) -> Vec<usize> {
    let pieces = |task: usize| -> usize {
        let blocks = &plan.blocks[plan.tasks[task] as usize];
        blocks.iter().map(|block| block.pieces as usize).sum()
    };
    let is_probe = |&task: &usize| {
        plan.cell(task).is_ok_and(|cell| cell.depth > 0)
            && 4 * pieces(task) >= plan.options.most_faces
    };
    let all: Vec<usize> = (0..plan.tasks.len()).filter(is_probe).collect();
    let step = all.len().div_ceil(PROBED).max(1);
    all.into_iter().step_by(step).collect()
}

/// Returns the errors at a quarter of the faces of a leaf, at a quarter of those, and so on.
fn losses<C: Coarsen>(mesh: &Mesh, method: &C) -> Result<Vec<f64>, C::Error> {
    (1..=LEVELS as u32).map(|level| method.loss(mesh, mesh.faces.len() >> (2 * level))).collect()
}

pub(crate) fn simplify_error(tile: crate::Cell, reason: &impl ToString) -> TilesError {
    TilesError::Simplify { tile: tile.to_string(), reason: reason.to_string() }
}
