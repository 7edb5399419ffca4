//! Task of a plan: one tile, from the pieces in its cell or from the tiles of its parts.

use crate::chain::chain_sum;
use crate::coarser::{Coarsen, Coarser, coarser};
use crate::content::content;
use crate::error::TilesError;
use crate::errors::simplify_error;
use crate::folder::Folder;
use crate::folder::record::TileRecord;
use crate::merge::merge;
use crate::plan::{Look, Plan};
use crate::samples::MeasuredError;
use crate::tile::TileMesh;

/// Makes a tile, unless it is done. The result depends on the plan alone.
///
/// # Errors
/// A task that needs another one first, errors of files and of the method.
pub fn run_task<C: Coarsen>(
    (plan, look): (&Plan, &Look),
    folder: &Folder,
    task: usize,
    method: &C,
) -> Result<TileRecord, TilesError> {
    let cell = plan.cell(task)?;
    if let Some(record) = folder.done(plan, task)? {
        return Ok(record);
    }
    let (tile, record) = match plan.parts(task)[..] {
        [] => {
            let tile = folder.leaf(plan, task)?;
            let bound = plan.lattice.rounding();
            (tile, TileRecord { bound, ..TileRecord::new(cell) })
        }
        ref parts => of_parts(plan, folder, (task, parts), method)?,
    };
    let record = record.with_chain(chain_sum(&tile));
    let made = content((plan, look), cell, &tile)
        .map_err(|source| TilesError::Content { tile: cell.to_string(), source })?;
    look.decoded.check()?;
    let record = TileRecord {
        faces: made.faces,
        error: record.bound + made.moved * plan.lattice.step,
        bounds: made.bounds,
        lost_images: made.lost_images,
        ..record
    };
    folder.write_tile(plan, (&tile, &made.glb), record)
}

/// Makes a tile from those of its parts.
fn of_parts<C: Coarsen>(
    plan: &Plan,
    folder: &Folder,
    (task, parts): (usize, &[usize]),
    method: &C,
) -> Result<(TileMesh, TileRecord), TilesError> {
    let cell = plan.cell(task)?;
    let mut meshes = Vec::new();
    let mut bound = 0f64;
    for &part in parts {
        let record = folder.record(plan, part)?;
        let record = record.ok_or(TilesError::NotDone { task, needs: part })?;
        meshes.push(folder.mesh(plan, part, &record)?);
        bound = bound.max(record.bound);
    }
    let merged = merge(meshes, cell);
    let error = plan.errors[usize::from(cell.depth)];
    let Coarser { tile, distance, is_unchanged } =
        coarser(merged.tile, (cell, &plan.tree), error, method)
            .map_err(|reason| simplify_error(cell, &reason))?;
    let bound = bound + distance * plan.lattice.step;
    let distances = method.distances(&tile.samples.mesh(), &tile.mesh);
    let measured = MeasuredError::of(&distances, plan.lattice.step);
    let new = TileRecord::new(cell);
    let record = TileRecord { bound, measured, open: merged.open, is_unchanged, ..new };
    Ok((tile, record))
}
