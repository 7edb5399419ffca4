//! Measures the speed of reading files, against tobj, and of sampling distances.

use std::time::Instant;

use anyhow::{Context, Result};
use meshlod::measure::{DistanceOptions, PreparedSurface, surface_distance};
use meshlod::simplify::{Options, Target, contract_to};

use crate::lab::table::Table;
use crate::{alternate, one_core};

const ROUNDS: usize = 7;

/// Returns a table of speeds in reading files and sampling distances.
pub fn section() -> Result<String> {
    let mut table = Table::new(["on one core", "figure"]);
    one_core(|| -> Result<()> {
        if let Some(path) = crate::shared_mesh("dragon.ply") {
            let bytes = std::fs::read(&path)?;
            let read = || meshlod::io::ply::read(&bytes).map(|mesh| mesh.faces.len());
            let least = (0..ROUNDS).map(|_| seconds(read)).fold(f64::INFINITY, f64::min);
            table.row(["reading dragon.ply, best, ms".to_owned(), format!("{:.1}", least * 1e3)]);
        }
        if let Some(path) = crate::shared_mesh("sponza.obj") {
            let bytes = std::fs::read(&path)?;
            let ratio = alternate(
                ROUNDS,
                || meshlod::io::obj::read(&bytes, &mut |_| None).map(|scene| scene.meshes.len()),
                || tobj_read(&bytes),
            );
            let what = "reading sponza.obj, speed relative to tobj".to_owned();
            table.row([what, format!("{:.2}", ratio.ratio)]);
        }
        if let Some(mesh) = crate::read("dragon.ply")? {
            let (level, _) = contract_to(&mesh, Target::Ratio(0.1), &Options::default())?;
            let (fine, coarse) = (PreparedSurface::new(&mesh)?, PreparedSurface::new(&level)?);
            let options = DistanceOptions { samples: 500_000, seed: 1 };
            let start = Instant::now();
            let distance = surface_distance(&fine, &coarse, &options)?;
            let queries = 2 * options.samples + mesh.positions.len() + level.positions.len();
            let rate = queries as f64 / start.elapsed().as_secs_f64() / 1e6;
            let what =
                "distance of dragon to its 10 % level, million samples and vertices per second"
                    .to_owned();
            table.row([what, format!("{rate:.2}")]);
            anyhow::ensure!(distance.mean() > 0.0, "a level differs from its mesh");
        }
        Ok(())
    })
    .context("reading and measuring")?;
    Ok(table.markdown())
}

fn tobj_read(bytes: &[u8]) -> Option<usize> {
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let (models, _) = tobj::load_obj_buf(&mut &bytes[..], &options, |_| {
        tobj::MTLLoadResult::Ok(Default::default())
    })
    .ok()?;
    Some(models.len())
}

fn seconds<T>(work: impl Fn() -> T) -> f64 {
    let start = Instant::now();
    std::hint::black_box(work());
    start.elapsed().as_secs_f64()
}
