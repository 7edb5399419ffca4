//! `cargo xtask compare`: our simplification beside meshoptimizer's, by turns in one run.
//!
//! Ours is `lindstrom-turk` of bare geometry, theirs simplify with update, their most accurate. One
//! core, CPU time, files excluded.

use anyhow::{Context, Result, bail, ensure};
use meshlod::measure::{DistanceOptions, PreparedSurface, surface_distance, volume};
use meshlod::mesh::{Connectivity, Mesh};
use meshlod::simplify::{Method, Options, Target, simplify};
use meshlod_bench::peer::{Indexed, simplify_with_update};
use meshlod_bench::{Ratio, alternate, one_core};
use serde_json::{Value, json};

use crate::table::Table;

const OPTIONS: &str = "--meshes NAME,... --ratios 10%,... --rounds N --json";

const MESHES: [&str; 6] = ["bunny", "horse-97k", "igea", "dragon", "armadillo-173k", "fandisk-32k"];
const RATIOS: [f64; 2] = [0.1, 0.01];
const ROUNDS: usize = 7;
const SAMPLES: usize = 200_000;

/// What is asked for.
struct Wish {
    meshes: Vec<String>,
    ratios: Vec<f64>,
    rounds: usize,
    json: bool,
}

/// One mesh at one ratio.
struct Row {
    mesh: String,
    ratio: f64,
    input_faces: usize,
    took: Ratio,
    ours: Side,
    theirs: Side,
}

/// What one of the two made of it.
struct Side {
    faces: usize,
    /// Of the diagonal, in percent.
    mean: f64,
    max: f64,
    /// Relative, of the positions as a file of floats has them; none of an open mesh.
    volume: Option<f64>,
}

/// Prints the table, or one JSON object.
///
/// # Errors
/// Options that are none, meshes that are not here.
pub fn run(arguments: &[String]) -> Result<()> {
    let wish = Wish::of(arguments)?;
    let mut rows = Vec::new();
    for name in &wish.meshes {
        let mesh = read(name)?;
        for &ratio in &wish.ratios {
            eprintln!("{name}, {} …", percent(ratio));
            rows.push(row(name, &mesh, ratio, wish.rounds)?);
        }
    }
    if wish.json {
        let rows: Vec<Value> = rows.iter().map(Row::json).collect();
        println!("{}", json!({ "rounds": wish.rounds, "rows": rows }));
    } else {
        print!("{}", table(&rows));
    }
    Ok(())
}

impl Wish {
    fn of(arguments: &[String]) -> Result<Self> {
        let mut wish = Self {
            meshes: MESHES.map(str::to_owned).to_vec(),
            ratios: RATIOS.to_vec(),
            rounds: ROUNDS,
            json: false,
        };
        let mut arguments = arguments.iter();
        while let Some(option) = arguments.next() {
            let mut value = || arguments.next().with_context(|| format!("{option}: of what?"));
            match option.as_str() {
                "--meshes" => wish.meshes = value()?.split(',').map(str::to_owned).collect(),
                "--ratios" => {
                    wish.ratios = value()?.split(',').map(ratio).collect::<Result<_>>()?
                }
                "--rounds" => wish.rounds = value()?.parse().context("--rounds: a number")?,
                "--json" => wish.json = true,
                _ => bail!("{option} is no option: {OPTIONS}"),
            }
        }
        ensure!(wish.rounds > 0, "--rounds: at least 1");
        Ok(wish)
    }
}

/// `10%` or `0.1`.
fn ratio(text: &str) -> Result<f64> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    let ratio = unit * number.parse::<f64>().with_context(|| format!("{text} is no ratio"))?;
    ensure!((0.0..=1.0).contains(&ratio), "{text}: a ratio goes from 0% to 100%");
    Ok(ratio)
}

/// A shared mesh by its name, `.ply` where it has no suffix, as bare geometry.
fn read(name: &str) -> Result<Mesh> {
    let file = if name.contains('.') { name.to_owned() } else { format!("{name}.ply") };
    let mesh = meshlod_bench::read(&file)?.with_context(|| {
        format!("{file} is not among the shared meshes; MESHLOD_MESHES names their folder")
    })?;
    Ok(Mesh { attributes: None, ..mesh })
}

fn row(name: &str, mesh: &Mesh, ratio: f64, rounds: usize) -> Result<Row> {
    let options = Options { method: Some(Method::LindstromTurk), ..Options::default() };
    let (indexed, target) = (Indexed::from(mesh), Target::Ratio(ratio));
    let faces = target.faces_of(mesh.faces.len());
    let ours = || simplify(mesh, target, &options).expect("it can be simplified").0;
    let theirs = || simplify_with_update(&indexed, faces);
    let original = PreparedSurface::new(mesh)?;
    Ok(Row {
        mesh: name.to_owned(),
        ratio,
        input_faces: mesh.faces.len(),
        took: one_core(|| alternate(rounds, ours, theirs)),
        ours: Side::of(mesh, &original, &ours())?,
        theirs: Side::of(mesh, &original, &Mesh::from(&theirs()))?,
    })
}

impl Side {
    fn of(mesh: &Mesh, original: &PreparedSurface<'_>, level: &Mesh) -> Result<Self> {
        let options = DistanceOptions { samples: SAMPLES, seed: 0 };
        let apart = surface_distance(original, &PreparedSurface::new(level)?, &options)?;
        let closed = Connectivity::new(&mesh.faces, mesh.positions.len()).is_closed();
        let mut written = level.clone();
        written.positions.iter_mut().flatten().for_each(|x| *x = f64::from(*x as f32));
        Ok(Self {
            faces: level.faces.len(),
            mean: apart.percent(apart.mean()),
            max: apart.percent(apart.max()),
            volume: closed.then(|| volume(&written) / volume(mesh) - 1.0),
        })
    }

    fn json(&self) -> Value {
        let Self { faces, mean, max, volume } = self;
        json!({ "faces": faces, "mean_percent": mean, "max_percent": max, "volume_change": volume })
    }
}

impl Row {
    /// Million input faces a second, ours and theirs.
    fn rates(&self) -> [f64; 2] {
        [self.took.ours, self.took.theirs].map(|seconds| self.input_faces as f64 / seconds * 1e-6)
    }

    fn json(&self) -> Value {
        let [ours, theirs] = [&self.ours, &self.theirs].map(Side::json);
        let [our_rate, their_rate] = self.rates();
        json!({
            "mesh": self.mesh,
            "ratio": self.ratio,
            "input_faces": self.input_faces,
            "speed_ratio": self.took.ratio,
            "million_faces_per_second": { "ours": our_rate, "theirs": their_rate },
            "ours": ours,
            "theirs": theirs,
        })
    }
}

fn table(rows: &[Row]) -> String {
    let mut table = Table::new([
        "mesh, ratio",
        "faces",
        "million/s (theirs)",
        "speed ÷ theirs",
        "mean % (theirs)",
        "max % (theirs)",
        "max ÷ theirs",
        "volume (theirs)",
    ]);
    for row in rows {
        let Row { mesh, ratio, took, ours, theirs, .. } = row;
        let [our_rate, their_rate] = row.rates();
        table.row([
            format!("{mesh}, {}", percent(*ratio)),
            ours.faces.to_string(),
            format!("{our_rate:.2} ({their_rate:.2})"),
            format!("{:.2}", took.ratio),
            format!("{:.5} ({:.5})", ours.mean, theirs.mean),
            format!("{:.3} ({:.3})", ours.max, theirs.max),
            format!("{:.2}", ours.max / theirs.max),
            match (ours.volume, theirs.volume) {
                (Some(ours), Some(theirs)) => format!("{ours:.0e} ({theirs:.0e})"),
                _ => "open".to_owned(),
            },
        ]);
    }
    table.markdown()
}

fn percent(ratio: f64) -> String {
    format!("{} %", (ratio * 1e8).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_is_understood() {
        let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let wish = Wish::of(&words("--meshes horse-97k,igea --ratios 10%,0.01 --json")).unwrap();
        assert_eq!((wish.meshes.len(), wish.json, wish.rounds), (2, true, ROUNDS));
        assert!((wish.ratios[0] - 0.1).abs() < 1e-12 && wish.ratios[1] == 0.01);
        for bad in ["--rounds 0", "--rounds", "--ratios 200%", "horse", "--ratios ten"] {
            assert!(Wish::of(&words(bad)).is_err(), "{bad}");
        }
    }
}
