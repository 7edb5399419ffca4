//! A sample made non-manifold, beside the sample itself.

use anyhow::Result;
use meshlod::measure::PreparedSurface;
use meshlod::mesh::Mesh;
use meshlod::samples;

use super::Tools;
use super::deviation::{Deviation, cell, is_at_most, ratio};
use super::inputs::{bare, write};
use crate::fixtures::{doubled_back_to_back, with_merged_vertices};
use crate::lab::table::Table;

const FACES: usize = 100_000;
const PAIRS: usize = 1_000;
/// Factor by which the mean may be larger than that of the sample itself.
const MEAN: f64 = 1.1;

/// Returns a table of the sample and its non-manifold versions, bare and with attributes.
pub fn table(tools: &Tools) -> Result<String> {
    let mut table = Table::new([
        "fish to 1 %",
        "faces wanted",
        "faces",
        "mean / max",
        "mean relative to the sample",
        "short of",
    ]);
    let painted = samples::fish(FACES);
    for (form, fish) in [("bare", bare(painted.clone())), ("with attributes", painted)] {
        let mut of_sample = None;
        let merged = with_merged_vertices(&fish, PAIRS, 20);
        let doubled = doubled_back_to_back(&fish);
        for (name, mesh) in [("sample", fish), ("pairs merged", merged), ("doubled", doubled)] {
            eprintln!("  {form}, {name} …");
            let wanted = mesh.faces.len() / 100;
            let level = level(tools, &mesh, wanted)?;
            let sample = *of_sample.get_or_insert(level.map_or(0.0, |level| level.mean));
            let reached = level.filter(|level| level.faces <= wanted);
            let fault = match reached {
                None => "not reached",
                Some(level) if !is_at_most(level.mean, MEAN, sample) => "mean",
                Some(_) => "",
            };
            table.row([
                format!("{name}, {form}"),
                wanted.to_string(),
                level.map_or("–".to_owned(), |level| level.faces.to_string()),
                cell(level, usize::MAX),
                level.map_or("–".to_owned(), |level| ratio(level.mean, sample)),
                fault.to_owned(),
            ]);
        }
    }
    Ok(table.markdown())
}

/// Simplifies a mesh by way of an OBJ file, which holds its attributes, and measures the level.
fn level(tools: &Tools, mesh: &Mesh, wanted: usize) -> Result<Option<Deviation>> {
    let folder = tempfile::tempdir()?;
    let [input, output] = ["in.obj", "out.obj"].map(|file| folder.path().join(file));
    write(&input, mesh)?;
    let surface = PreparedSurface::new(mesh)?;
    let level = tools.simplify(&input, &output, wanted, &[]);
    Ok(level.map(|level| Deviation::of(&surface, &level)).transpose()?.flatten())
}
