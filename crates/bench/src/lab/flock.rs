//! Measures flocks: triangles at equal image error, the paper's experiment, and the time of
//! simulation and selection.

use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result};
use meshlod::flock::levels::{ChainOptions, LevelTable, Look, ModelAxes};
use meshlod::flock::select::{Budget, PolicyName, Selector};
use meshlod::flock::{Flock, FlockCamera};
use meshlod::samples;
use meshlod_school::simulation::{SchoolOptions, Simulation, SimulationOptions};
use serde_json::Value;

use super::command::Program;
use crate::lab::table::Table;
use crate::one_core;

/// Shares of the triangles of full detail at which image errors are listed.
const SHARES: [f64; 4] = [0.01, 0.02, 0.05, 0.1];

/// Returns the tables of an evaluation in its quick version, and of times.
pub fn section() -> Result<String> {
    let program = Program::build()?;
    let folder = tempfile::tempdir()?;
    let out = folder.path().join("evaluation");
    let out_text = out.to_str().context("the folder's name is text")?;
    let answer = program.answer(["flock", "--evaluate", "--quick", "--out", out_text])?;
    let all: Value = serde_json::from_slice(&std::fs::read(out.join("evaluation.json"))?)?;
    Ok(format!(
        "150 sample fish of 3,984 faces, textured, in five scenes at 640 by 360 pixels: \
         `meshlod flock --evaluate --quick --out DIR`; a longer one without `--quick`. FLIP and SSIM \
         on the pixels that show the flock, against full detail, which differs from itself by \
         {} if its samples are shifted by a quarter of a pixel. Temporal error: change of the error \
         from a frame to the next, in parts of white; switches: changes of level that a member shows \
         in a second; both at 5 % of the triangles.\n\n{}{}\
         The paper's experiment, its camera circling one school, all arms with the same settings:\n\n{}\
         Times on a machine of two cores, the least of several runs: selection on one core, for a \
         school of a million fish seen whole; simulation with every member steering in every step on \
         two cores.\n\n{}{}",
        floors(&all),
        arms(&answer, &all)?,
        ratios(&answer)?,
        over_time(&all)?,
        selection()?,
        simulation()?,
    ))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Returns the mean of numbers, formatted, or a dash if there are none.
fn mean(values: impl Iterator<Item = f64>, digits: usize) -> String {
    let values: Vec<f64> = values.collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    if mean.is_finite() { format!("{mean:.digits$}") } else { "–".into() }
}

/// Returns the least and the greatest FLIP of the floors.
fn floors(all: &Value) -> String {
    let floors = list(&all["evaluation"]["floors"]).iter().map(|floor| number(&floor[1]["flip"]));
    let (low, high) = floors.fold((f64::INFINITY, 0f64), |(l, h), f| (l.min(f), h.max(f)));
    format!("{low:.3} to {high:.3}")
}

fn arms(answer: &Value, all: &Value) -> Result<String> {
    let mut table = Table::new([
        "arm",
        "triangles for FLIP .01, % of full detail",
        ".02",
        ".05",
        "FLIP at 1 % of the triangles",
        "2 %",
        "5 %",
        "10 %",
        "SSIM at 5 %",
        "temporal error",
        "switches",
    ]);
    for arm in list(&answer["arms"]) {
        let name = arm["arm"].as_str().context("arms have names")?;
        let rows = |share: f64| {
            let rows = list(&all["evaluation"]["rows"]).iter();
            rows.filter(move |row| row["arm"] == name && number(&row["share"]) == share)
        };
        let frames = |row: &Value, figure: &str| {
            list(&row["frames"]).iter().map(|frame| number(&frame[figure])).collect::<Vec<_>>()
        };
        let of_frames = |share: f64, figure: &'static str| {
            mean(rows(share).flat_map(move |row| frames(row, figure)), 3)
        };
        let needed = list(&arm["needed"]).iter();
        let mut cells = vec![name.to_owned()];
        cells.extend(needed.map(|n| match n["share"].as_f64() {
            Some(share) => format!("{:.1}", 100.0 * share),
            None => "–".into(),
        }));
        cells.extend(SHARES.map(|share| of_frames(share, "flip")));
        cells.push(of_frames(0.05, "ssim"));
        cells.push(mean(rows(0.05).map(|row| number(&row["temporal_error"])), 4));
        cells.push(mean(rows(0.05).map(|row| number(&row["switches_per_second"])), 2));
        table.row(cells);
    }
    Ok(table.markdown())
}

fn ratios(answer: &Value) -> Result<String> {
    let mut table = Table::new(["triangles at equal FLIP", ".01", ".02", ".05"]);
    for ratio in list(&answer["ratios"]) {
        let name = |key: &str| ratio[key].as_str().context("arms have names");
        let mut cells = vec![format!("{} over {}", name("arm")?, name("over")?)];
        cells.extend(list(&ratio["at"]).iter().map(|at| match &at["ratio"] {
            Value::Null => "–".into(),
            r => {
                let [mean, low, high] = ["mean", "low", "high"].map(|key| number(&r[key]));
                format!("{mean:.2} ({low:.2} to {high:.2})")
            }
        }));
        table.row(cells);
    }
    Ok(table.markdown())
}

fn over_time(all: &Value) -> Result<String> {
    let mut table = Table::new(["arm", "triangles a frame: mean", "least", "most", "mean FLIP"]);
    for track in list(&all["over_time"]) {
        let triangles = list(&track["triangles"]).iter().map(number);
        let (least, most) =
            triangles.clone().fold((f64::INFINITY, 0f64), |(l, h), t| (l.min(t), h.max(t)));
        let name = track["arm"].as_str().context("arms have names")?;
        let flips = list(&track["flips"]).iter().map(|flip| number(&flip[1]));
        let (least, most) = (format!("{least:.0}"), format!("{most:.0}"));
        table.row([name.to_owned(), mean(triangles, 0), least, most, mean(flips, 3)]);
    }
    Ok(table.markdown())
}

/// Returns the least time of several runs, in seconds.
fn least(runs: usize, mut run: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    (0..runs).map(time).fold(f64::INFINITY, f64::min)
}

fn selection() -> Result<String> {
    const MEMBERS: usize = 1_000_000;
    let options = ChainOptions { axes: ModelAxes::FISH, ..ChainOptions::default() };
    let levels = LevelTable::new(&samples::fish(4_000), &Look::default(), &options)?;
    let levels = Arc::new(levels);
    let school = SimulationOptions {
        schools: vec![SchoolOptions::of(MEMBERS)],
        ..SimulationOptions::default()
    };
    let mut flock = Flock::default();
    Simulation::new(&school)?.snapshot(1.0, &mut flock);
    let (leader, radii) = (flock.schools[0].leader.to_array(), flock.schools[0].radii);
    let eye = [leader[0] + 1.5 * radii.z, leader[1] + 0.3 * radii.z, leader[2]];
    let camera = FlockCamera::look_at(eye, leader, 0.8, [1920, 1080])?;
    let budget = Budget { triangles: 60 * MEMBERS, detail: 1.0, ..Budget::default() };
    let mut table = Table::new(["selection, policy", "ns per member"]);
    for policy in PolicyName::ALL {
        let mut selector = Selector::new(policy, levels.clone());
        let seconds =
            one_core(|| least(15, || _ = selector.select(&flock, &camera, &budget).len()));
        table.row([policy.name().to_owned(), format!("{:.1}", 1e9 * seconds / MEMBERS as f64)]);
    }
    Ok(table.markdown())
}

fn simulation() -> Result<String> {
    let mut table = Table::new(["simulation, members", "members per ms", "neighbours"]);
    for members in [1_000, 10_000, 100_000, 1_000_000] {
        let mut options = SimulationOptions {
            schools: vec![SchoolOptions::of(members)],
            ..SimulationOptions::default()
        };
        if members <= 1_000 {
            // Most members of a small school are at its border: they must see farther.
            options.behaviour.neighbour_radius = 2.5;
        }
        let mut simulation = Simulation::new(&options)?;
        (0..30).for_each(|_| simulation.step());
        let runs = (2_000_000 / members).clamp(8, 500);
        let seconds = least(runs, || simulation.step());
        let looks = simulation.looks();
        let neighbours = looks.neighbours as f64 / looks.members as f64;
        let per_ms = members as f64 / (1e3 * seconds);
        table.row([members.to_string(), format!("{per_ms:.0}"), format!("{neighbours:.1}")]);
    }
    Ok(table.markdown())
}
