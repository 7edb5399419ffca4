//! Measures the change of volume by simplification, in the files written.

pub mod textured;

use anyhow::{Context, Result};
use meshlod::io::Precision;
use meshlod::measure::volume;
use meshlod::mesh::{Connectivity, Mesh};
use meshlod::samples;
use meshlod::simplify::{Method, Options, Target, contract_to};
use meshlod::{ReadOptions, Scene, WriteOptions, read, write};

use crate::lab::table::Table;

const MESHES: [&str; 5] =
    ["bunny-closed.ply", "horse.ply", "feline.ply", "igea.ply", "armadillo-173k.ply"];
const RATIOS: [f64; 3] = [0.5, 0.1, 0.01];
const METHODS: [Method; 6] = [
    Method::LeeJang,
    Method::KimJang,
    Method::LindstromTurk,
    Method::LindstromTurkFaces,
    Method::Wu,
    Method::Qem,
];

/// Returns a table of the relative change of volume of bare meshes by mesh, ratio and method.
pub fn section() -> Result<String> {
    let mut table = Table::new(
        ["mesh, ratio"].into_iter().chain(METHODS.map(Method::name)).collect::<Vec<_>>(),
    );
    let folder = tempfile::tempdir()?;
    for (name, mesh) in meshes()? {
        let before = volume(&mesh);
        for ratio in RATIOS {
            let mut row = vec![format!("{name}, {:.0} %", ratio * 100.0)];
            for method in METHODS {
                let options = Options { method, ..Options::default() };
                let (level, _) = contract_to(&mesh, Target::Ratio(ratio), &options)?;
                let level = through_file(level, &folder.path().join("level.ply"))?;
                row.push(format!("{:.1e}", (volume(&level) - before).abs() / before.abs()));
            }
            table.row(row);
        }
    }
    Ok(format!(
        "|ΔV| / V of closed meshes, of the level as read back from PLY. To reproduce a row: `meshlod \
         simplify MESH out.ply --ratio R --method M --precision f64`, `meshlod measure MESH \
         out.ply --json`.\n\n{}",
        table.markdown()
    ))
}

/// Reads the available closed meshes and adds a sample.
fn meshes() -> Result<Vec<(String, Mesh)>> {
    let mut meshes = vec![("gyroid (sample)".to_owned(), samples::gyroid(50_000))];
    for file in MESHES {
        if let Some(mesh) = crate::read(file)? {
            let closed = Connectivity::new(&mesh.faces, mesh.positions.len()).is_closed();
            let note = if closed { "" } else { " (open)" };
            meshes.push((format!("{file}{note}"), mesh));
        }
    }
    Ok(meshes)
}

fn through_file(level: Mesh, path: &std::path::Path) -> Result<Mesh> {
    let options = WriteOptions { precision: Precision::F64 };
    write(path, &Scene::from_mesh("level", level), &options)?;
    let scene = read(path, &ReadOptions::default())?;
    Ok(scene.meshes.into_iter().next().context("a file with a mesh")?.mesh)
}
