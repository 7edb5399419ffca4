//! Measures the speed of simplification against meshoptimizer, in alternating rounds on one core.

use anyhow::Result;
use meshlod::simplify::{Method, Options, Target, contract_to};

use crate::lab::table::Table;
use crate::peer::{Indexed, simplify_with_update};
use crate::{Ratio, alternate, one_core};

const ROUNDS: usize = 5;
const METHODS: [Method; 6] = [
    Method::Qem,
    Method::QemEndpoint,
    Method::LindstromTurk,
    Method::LindstromTurkFaces,
    Method::LeeJang,
    Method::KimJang,
];
const MESHES: [&str; 4] = ["bunny.ply", "horse-97k.ply", "igea.ply", "dragon.ply"];

/// Returns a table of seconds and speed ratios by mesh and method.
pub fn section() -> Result<String> {
    let mut table = Table::new([
        "mesh to 10 %, method",
        "ours, s",
        "million faces/s",
        "meshoptimizer, s",
        "speed ratio",
    ]);
    for file in MESHES {
        let Some(mesh) = crate::read(file)? else { continue };
        let indexed = Indexed::from(&mesh);
        for method in METHODS {
            let options = Options { method, ..Options::default() };
            let Ratio { ours, theirs, ratio } = one_core(|| {
                alternate(
                    ROUNDS,
                    || contract_to(&mesh, Target::Ratio(0.1), &options),
                    || simplify_with_update(&indexed, mesh.faces.len() / 10),
                )
            });
            let rate = mesh.faces.len() as f64 / ours / 1e6;
            let figures = [format!("{ours:.3}"), format!("{rate:.2}"), format!("{theirs:.3}")];
            let [ours, rate, theirs] = figures;
            let what = format!("{file}, {}", method.name());
            table.row([what, ours, rate, theirs, format!("{ratio:.2}")]);
        }
    }
    Ok(format!(
        "CPU time on one core, medians of {ROUNDS} alternating rounds. File input and output are \
         excluded; connectivity and the output mesh are included. meshoptimizer runs simplify with \
         update. To reproduce: `cargo xtask results speed`.\n\n{}",
        table.markdown()
    ))
}
