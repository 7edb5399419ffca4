//! Maximum distance of the default beside that of `qem`, and its mean beside what it was.

use anyhow::{Context, Result};
use meshlod::measure::PreparedSurface;

use super::Tools;
use super::deviation::{Deviation, is_at_most, ratio};
use super::inputs::{bare, read, write};
use crate::lab::table::Table;

/// Models, with the mean of the default at 10 % and at 3 % on 2026-11-23, before pieces could
/// vanish; skyscraper.obj then stopped at 404 faces of 369.
const MESHES: [(&str, [f64; 2]); 6] = [
    ("fandisk.off", [0.00187, 0.00911]),
    ("rocker-arm.obj", [0.02213, 0.06041]),
    ("bat-cover.stl", [0.01267, 0.16884]),
    ("turbine.off", [0.01966, 0.08905]),
    ("skyscraper.obj", [1.17393, 1.17393]),
    ("cesium-milk-truck.glb", [0.04506, 0.49206]),
];
const PERCENTS: [usize; 2] = [10, 3];
/// Factor by which the mean may be larger than it was.
const MEAN: f64 = 1.02;

/// Returns a table of the default beside `qem`, by mesh and ratio.
pub fn table(tools: &Tools) -> Result<String> {
    let mut table = Table::new([
        "mesh, ratio",
        "faces",
        "mean",
        "mean before",
        "max",
        "max by `qem`",
        "ratio of the maxima",
        "short of",
    ]);
    for (name, before) in MESHES {
        let Some(path) = crate::shared_mesh(name) else { continue };
        let mesh = bare(read(&path)?);
        eprintln!("  {name} …");
        let folder = tempfile::tempdir()?;
        let [input, output] = ["in.ply", "out.ply"].map(|file| folder.path().join(file));
        write(&input, &mesh)?;
        let surface = PreparedSurface::new(&mesh)?;
        let level = |faces: usize, more: &[&str]| -> Result<Deviation> {
            let level = tools.simplify(&input, &output, faces, more).context("no level")?;
            Deviation::of(&surface, &level)?.context("a level without faces")
        };
        for (percent, before) in PERCENTS.into_iter().zip(before) {
            let wanted = mesh.faces.len() * percent / 100;
            let ours = level(wanted, &[])?;
            let qem = level(ours.faces, &["--method", "qem"])?;
            table.row(row(&format!("{name}, {percent} %"), wanted, before, ours, qem));
        }
    }
    Ok(table.markdown())
}

fn row(what: &str, wanted: usize, before: f64, ours: Deviation, qem: Deviation) -> [String; 8] {
    let faults = [
        (ours.faces > wanted).then_some("faces"),
        (!is_at_most(ours.mean, MEAN, before)).then_some("mean"),
        (!is_at_most(ours.max, 1.0, qem.max)).then_some("max"),
    ];
    [
        what.to_owned(),
        ours.faces.to_string(),
        format!("{:.5}", ours.mean),
        format!("{before:.5}"),
        format!("{:.3}", ours.max),
        format!("{:.3}", qem.max),
        ratio(ours.max, qem.max),
        faults.into_iter().flatten().collect::<Vec<_>>().join(", "),
    ]
}
