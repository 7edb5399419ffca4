//! Tunnels that have to close: levels of few faces, beside other programs.

use std::path::Path;

use anyhow::Result;
use meshlod::measure::PreparedSurface;
use meshlod::mesh::{ConditionOptions, Locks, Mesh, condition, face_components};
use meshlod::samples::{GyroidSlabs, tunnels};

use crate::lab::command::Program;
use crate::lab::parts::deviation::{Deviation, cell};
use crate::lab::parts::inputs::{bare, read, write};
use crate::lab::parts::peers::{self, PEERS};
use crate::lab::table::Table;

/// Faces wanted, in thousandths of those of the input.
const THOUSANDTHS: [usize; 2] = [20, 5];

/// Returns a table of shapes with many tunnels at equal numbers of faces.
pub fn table(program: &Program) -> Result<String> {
    let names = PEERS.map(|(_, name)| name);
    let headings = ["shape", "faces", "wanted", "tunnels", "ours", "tunnels left"];
    let mut table = Table::new(headings.into_iter().chain(names));
    let shapes = [
        ("slab, `sample tunnels --seed 1`", tunnels(40_000, 1)),
        ("foam: a gyroid of 7³ periods", GyroidSlabs::with_periods(7, 8).mesh()),
    ];
    for (name, shape) in shapes {
        rows(program, &mut table, name, bare(shape))?;
    }
    Ok(format!(
        "Mean and maximum distance in % of the diagonal at 2 and .5 % of the faces; the number of \
         faces where it is above what was wanted. The other programs as in [Many \
         parts](#many-parts).\n\n{}",
        table.markdown()
    ))
}

fn rows(program: &Program, table: &mut Table, name: &str, shape: Mesh) -> Result<()> {
    eprintln!("  {name}: {} faces …", shape.faces.len());
    let folder = tempfile::tempdir()?;
    let [input, output] = ["in.ply", "out.ply"].map(|file| folder.path().join(file));
    write(&input, &shape)?;
    let surface = PreparedSurface::new(&shape)?;
    let wanted = THOUSANDTHS.map(|part| shape.faces.len() * part / 1000);
    let theirs = peers::deviations(&input, &surface, &wanted)?;
    for (wanted, theirs) in wanted.into_iter().zip(theirs) {
        let level = level(program, [&input, &output], wanted)?;
        let mut cells = vec![
            name.to_owned(),
            shape.faces.len().to_string(),
            wanted.to_string(),
            tunnel_count(&shape).to_string(),
            cell(Deviation::of(&surface, &level)?, wanted),
            tunnel_count(&level).to_string(),
        ];
        cells.extend(theirs.map(|level| cell(level, wanted)));
        table.row(cells);
    }
    Ok(())
}

fn level(program: &Program, [input, output]: [&Path; 2], faces: usize) -> Result<Mesh> {
    let faces = faces.to_string();
    let options = ["--faces", &faces].map(std::ffi::OsStr::new);
    let command = ["simplify".as_ref(), input.as_os_str(), output.as_os_str()];
    program.answer(command.into_iter().chain(options))?;
    read(output)
}

/// Returns the genus of a closed mesh, over all of its components.
fn tunnel_count(mesh: &Mesh) -> i64 {
    let split = condition(mesh, &Locks::default(), &ConditionOptions::default());
    let mesh = split.as_ref().map_or(mesh, |split| &split.mesh);
    let components = face_components(&mesh.faces, mesh.positions.len()).1 as i64;
    let used = mesh.used_vertices().iter().filter(|is_used| **is_used).count() as i64;
    // A closed mesh has three edges for two faces.
    components - (used - mesh.faces.len() as i64 / 2) / 2
}

#[cfg(test)]
mod tests {
    use meshlod::samples;

    use super::*;

    #[test]
    fn tunnels_are_the_genus() {
        assert_eq!(tunnel_count(&samples::torus(500)), 1);
        assert_eq!(tunnel_count(&samples::boxes(3_000, 0)), 0);
        assert_eq!(tunnel_count(&tunnels(25 * 113, 0)), 25);
    }
}
