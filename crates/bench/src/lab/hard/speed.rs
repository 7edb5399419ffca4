//! Speed on models of many parts, with vanishing and without, beside meshoptimizer.

use anyhow::{Context, Result};
use meshlod::mesh::Mesh;
use meshlod::samples::by_seed;
use meshlod::simplify::{Options, Target, Topology};

use crate::lab::parts::inputs::{bare, part_count};
use crate::lab::table::Table;
use crate::peer::{Indexed, simplify_with_update};
use crate::{Ratio, alternate, one_core};

const ROUNDS: usize = 5;

/// A round goes through a model until it has seen this many faces.
const FACES_OF_A_ROUND: usize = 100_000;

const FILES: [&str; 5] = [
    "skyscraper.obj",
    "city.glb",
    "sponza.obj",
    "cesium-milk-truck.glb",
    "flight-helmet/FlightHelmet.gltf",
];

/// Returns a table of models to a tenth of their faces.
pub fn table() -> Result<String> {
    let headings = ["model", "faces", "parts", "free, million faces/s", "free, ms"];
    let more = ["keep, ms", "free / keep", "meshoptimizer, ms"];
    let mut table = Table::new(headings.into_iter().chain(more));
    for (name, mesh) in models()? {
        eprintln!("  {name} …");
        let (free, keep, theirs) = one_core(|| milliseconds(&mesh));
        table.row([
            name,
            mesh.faces.len().to_string(),
            part_count(&mesh).to_string(),
            format!("{:.2}", mesh.faces.len() as f64 / free / 1e3),
            format!("{free:.1}"),
            format!("{keep:.1}"),
            format!("{:.2}", free / keep),
            format!("{theirs:.1}"),
        ]);
    }
    Ok(format!(
        "To 10 % on one core: processor time, medians of {ROUNDS} rounds by turns, without reading \
         and writing, geometry alone, welded. `free` lets parts vanish and is the default. \
         meshoptimizer's level is farther off, see [Many parts](#many-parts).\n\n{}",
        table.markdown()
    ))
}

fn models() -> Result<Vec<(String, Mesh)>> {
    let mut models = Vec::new();
    for (faces, seed) in [(50_000, 1), (50_000, 2), (500_000, 1)] {
        let parts = by_seed("parts", Some(faces), seed).context("a sample")?;
        models.push((format!("`sample parts --faces {faces} --seed {seed}`"), bare(parts)));
    }
    for file in FILES {
        if let Some(mesh) = crate::read(file)? {
            models.push((file.to_owned(), bare(mesh)));
        }
    }
    Ok(models)
}

/// Returns the times of ours that may vanish, of ours that keeps topology, and of meshoptimizer.
fn milliseconds(mesh: &Mesh) -> (f64, f64, f64) {
    let runs = FACES_OF_A_ROUND.div_ceil(mesh.faces.len());
    let indexed = Indexed::from(mesh);
    let ours = |topology| {
        let options = Options { topology, ..Options::default() };
        move || {
            for _ in 0..runs {
                let level = meshlod::simplify(mesh, Target::Ratio(0.1), &options);
                std::hint::black_box(level.expect("a sound model"));
            }
        }
    };
    let theirs = || {
        for _ in 0..runs {
            std::hint::black_box(simplify_with_update(&indexed, mesh.faces.len() / 10));
        }
    };
    let Ratio { ours: free, theirs: keep, .. } =
        alternate(ROUNDS, ours(Topology::Free), ours(Topology::Keep));
    let theirs = alternate(ROUNDS, ours(Topology::Free), theirs).theirs;
    let each = |seconds: f64| seconds * 1e3 / runs as f64;
    (each(free), each(keep), each(theirs))
}
