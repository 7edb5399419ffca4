//! Bare models of many parts at equal numbers of faces, beside PyMeshLab and meshoptimizer.

use std::path::Path;

use anyhow::Result;
use meshlod::measure::PreparedSurface;

use super::Tools;
use super::deviation::{Deviation, cell, is_at_most, ratio};
use super::inputs::{bare, part_count, read, write};
use super::peers::{self, PEERS};
use crate::lab::table::Table;

/// Models that are always measured, of several components or not.
const NAMED: [&str; 11] = [
    "skyscraper.obj",
    "city.glb",
    "sponza.obj",
    "fish-bream.obj",
    "teapot-ascii.stl",
    "cesium-milk-truck.glb",
    "fish-clown.obj",
    "turbine.off",
    "dragon-attenuation.glb",
    "pirate.obj",
    "FlightHelmet.gltf",
];
const PERCENTS: [usize; 4] = [50, 25, 10, 3];

/// Returns the counts of the rows that are as good as the best peer, and all rows.
pub fn table(tools: &Tools) -> Result<String> {
    let mut rows = Vec::new();
    for path in crate::shared_meshes() {
        if let Some(of_mesh) = rows_of(tools, &path)? {
            rows.extend(of_mesh);
        }
    }
    let (short, others): (Vec<_>, Vec<_>) = rows.iter().partition(|row| !row.faults().is_empty());
    Ok(format!(
        "{}Rows that fall short somewhere:\n\n{}The others:\n\n{}",
        counts(&rows),
        listed(&short),
        listed(&others)
    ))
}

/// Level of one mesh at one number of faces, by us and by the peers.
struct BareRow {
    what: String,
    wanted: usize,
    ours: Option<Deviation>,
    theirs: [Option<Deviation>; 3],
}

/// Measures a mesh, or returns `None` if it is of one component and not among the named ones.
fn rows_of(tools: &Tools, path: &Path) -> Result<Option<Vec<BareRow>>> {
    let mesh = read(path)?;
    let parts = part_count(&mesh);
    let name = super::name_of(path);
    if parts < 2 && !NAMED.contains(&name.as_str()) {
        return Ok(None);
    }
    eprintln!("  {name}: {} faces, {parts} parts …", mesh.faces.len());
    let mesh = bare(mesh);
    let folder = tempfile::tempdir()?;
    let [input, output] = ["in.ply", "out.ply"].map(|file| folder.path().join(file));
    write(&input, &mesh)?;
    let surface = PreparedSurface::new(&mesh)?;
    let wanted = PERCENTS.map(|percent| mesh.faces.len() * percent / 100);
    let theirs = peers::deviations(&input, &surface, &wanted)?;
    let row = |((percent, wanted), theirs)| -> Result<BareRow> {
        let level = tools.simplify(&input, &output, wanted, &[]);
        let ours = level.map(|level| Deviation::of(&surface, &level)).transpose()?.flatten();
        Ok(BareRow { what: format!("{name}, {percent} %"), wanted, ours, theirs })
    };
    let rows = PERCENTS.into_iter().zip(wanted).zip(theirs).map(row);
    rows.collect::<Result<_>>().map(Some)
}

impl BareRow {
    fn is_reached(&self) -> bool {
        self.ours.is_some_and(|level| level.faces <= self.wanted)
    }

    /// Returns the least of one figure over the peers that reach the number of faces.
    fn best(&self, figure: Figure) -> Option<f64> {
        let reached = |level: &&Deviation| 100 * level.faces <= 101 * self.wanted;
        self.theirs.iter().flatten().filter(reached).map(figure).min_by(f64::total_cmp)
    }

    /// Returns whether a figure of ours is at most `times` the best of theirs.
    fn is_within(&self, times: f64, figure: Figure) -> bool {
        let ours = self.ours.filter(|_| self.is_reached());
        let is_at_most = |ours: Deviation| {
            self.best(figure).is_none_or(|best| is_at_most(figure(&ours), times, best))
        };
        ours.is_some_and(is_at_most)
    }

    /// Lists where the row falls short: of the number of faces, of the best mean, of 1.25 times the
    /// best maximum.
    fn faults(&self) -> Vec<String> {
        let Some(ours) = self.ours.filter(|_| self.is_reached()) else {
            return vec!["not reached".to_owned()];
        };
        let mut faults = Vec::new();
        for (name, most, figure) in CRITERIA {
            if !self.is_within(most, figure) {
                let best = self.best(figure).unwrap_or_default();
                faults.push(format!("{name} {}", ratio(figure(&ours), best)));
            }
        }
        faults
    }
}

/// Figures that are compared, with their names and how many times the best of theirs they may be.
const CRITERIA: [(&str, f64, Figure); 2] =
    [("mean", 1.0, |level| level.mean), ("max", 1.25, |level| level.max)];

/// A figure of a level, such as its mean distance.
type Figure = fn(&Deviation) -> f64;
/// A condition that rows are counted by.
type Condition<'c> = &'c dyn Fn(&BareRow) -> bool;

fn counts(rows: &[BareRow]) -> String {
    let [(_, _, mean), (_, _, max)] = CRITERIA;
    let count = |is: Condition<'_>| {
        let found = rows.iter().filter(|row| is(row)).count();
        [found.to_string(), format!("{:.1}", 100.0 * found as f64 / rows.len().max(1) as f64)]
    };
    let mut table = Table::new([&format!("of {} rows", rows.len())[..], "rows", "%"]);
    let lines: [(&str, Condition<'_>); 5] = [
        ("number of faces reached", &BareRow::is_reached),
        ("mean at most the best of theirs", &|row| row.is_within(1.0, mean)),
        ("mean at most 1.1 times", &|row| row.is_within(1.1, mean)),
        ("maximum at most 1.25 times the best of theirs", &|row| row.is_within(1.25, max)),
        ("maximum at most 2 times", &|row| row.is_within(2.0, max)),
    ];
    for (what, is) in lines {
        let [rows, percent] = count(is);
        table.row([what.to_owned(), rows, percent]);
    }
    table.markdown()
}

fn listed(rows: &[&BareRow]) -> String {
    let names = PEERS.map(|(_, name)| name);
    let headings = ["mesh, ratio", "faces wanted", "ours"].into_iter().chain(names);
    let mut table = Table::new(headings.chain(["short of"]));
    for row in rows {
        let mut cells = vec![row.what.clone(), row.wanted.to_string(), cell(row.ours, row.wanted)];
        cells.extend(row.theirs.map(|level| cell(level, row.wanted)));
        cells.push(row.faults().join(", "));
        table.row(cells);
    }
    table.markdown()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(faces: usize, mean: f64, max: f64) -> Option<Deviation> {
        Some(Deviation { faces, mean, max })
    }

    fn row(ours: Option<Deviation>) -> BareRow {
        let theirs = [level(100, 1.0, 4.0), level(99, 2.0, 2.0), level(150, 0.1, 0.1)];
        BareRow { what: "mesh".to_owned(), wanted: 100, ours, theirs }
    }

    #[test]
    fn the_best_of_theirs_is_by_figure_and_only_where_they_reach_the_number() {
        assert!(row(level(100, 1.0, 2.5)).faults().is_empty());
        assert_eq!(row(level(100, 1.2, 3.0)).faults(), ["mean 1.20 ×", "max 1.50 ×"]);
    }

    #[test]
    fn a_row_that_is_not_reached_is_within_nothing() {
        let row = row(level(101, 0.0, 0.0));
        assert_eq!(row.faults(), ["not reached"]);
        assert!(!row.is_within(2.0, |level| level.mean));
    }
}
