//! Measures the peak memory of `meshlod`, and tests whether its output depends on the number of
//! threads.

use std::path::Path;

use anyhow::{Context, Result};

use super::command::Program;
use crate::lab::table::Table;

/// Returns a table of the peak resident memory of whole runs, and compares the outputs with 1 and 2
/// threads.
pub fn section() -> Result<String> {
    let mut table = Table::new([
        "meshlod simplify MESH out.ply --ratio 10%",
        "peak, MB",
        "bytes per input face",
        "same output with 1 and 2 threads",
    ]);
    let program = Program::build()?;
    let mut runs = Vec::new();
    for file in ["horse-97k.ply", "dragon.ply"] {
        let Some(path) = crate::shared_mesh(file) else { continue };
        runs.push((file, run(&program, &path)?));
    }
    // Read the mesh only now: memory held by this process would count in the peak of its children.
    for (file, (peak, same)) in runs {
        let faces = crate::read(file)?.context("the mesh was read before")?.faces.len();
        table.row([
            file.to_owned(),
            format!("{:.0}", peak as f64 / 1e6),
            format!("{:.0}", peak as f64 / faces as f64),
            if same { "yes" } else { "NO" }.to_owned(),
        ]);
    }
    Ok(table.markdown())
}

/// Returns the larger peak of two runs, in bytes, and whether their outputs are equal.
fn run(program: &Program, path: &Path) -> Result<(u64, bool)> {
    let folder = tempfile::tempdir()?;
    let mut peak = 0;
    let mut outputs = Vec::new();
    for threads in ["1", "2"] {
        let out = folder.path().join("out.ply");
        let arguments = ["simplify", "--ratio", "10%", "--threads", threads];
        peak = peak.max(program.run(&arguments, [path, &out])?.maxrss);
        outputs.push(std::fs::read(out)?);
    }
    Ok((peak, outputs[0] == outputs[1]))
}
