//! `cargo xtask compare`: compares simplification by meshlod and by meshoptimizer, in alternating
//! rounds.
//!
//! Compares `lindstrom-turk` on bare geometry with meshoptimizer's simplify with update, its most
//! accurate. CPU time on one core, without file input and output.

use anyhow::{Context, Result, bail, ensure};
use meshlod::measure::{DistanceOptions, PreparedSurface, surface_distance, volume};
use meshlod::mesh::{Connectivity, Mesh};
use meshlod::simplify::{Method, Options, Target, contract_to};
use serde_json::{Value, json};

use crate::lab::table::Table;
use crate::peer::{Indexed, simplify_with_update};
use crate::{Ratio, alternate, one_core};

const OPTIONS: &str = "--meshes NAME,... --ratios 10%,... --rounds N --json";

const MESHES: [&str; 6] = ["bunny", "horse-97k", "igea", "dragon", "armadillo-173k", "fandisk-32k"];
const RATIOS: [f64; 2] = [0.1, 0.01];
const ROUNDS: usize = 7;
const SAMPLES: usize = 200_000;

/// Parsed command-line options.
struct Arguments {
    meshes: Vec<String>,
    ratios: Vec<f64>,
    rounds: usize,
    json: bool,
}

/// Result for one mesh at one ratio.
struct Comparison {
    mesh: String,
    ratio: f64,
    input_faces: usize,
    took: Ratio,
    ours: Side,
    theirs: Side,
}

/// Result of one of the two programs.
struct Side {
    faces: usize,
    /// Mean distance in percent of the diagonal.
    mean: f64,
    max: f64,
    /// Relative change of the volume after rounding positions to f32; `None` for an open mesh.
    volume: Option<f64>,
}

/// Prints the comparison as a table or as one JSON object.
///
/// # Errors
/// Invalid options; a mesh that is not available.
pub fn run(arguments: &[String]) -> Result<()> {
    let parsed = Arguments::of(arguments)?;
    let mut rows = Vec::new();
    for name in &parsed.meshes {
        let mesh = read(name)?;
        for &ratio in &parsed.ratios {
            eprintln!("{name}, {} …", percent(ratio));
            rows.push(row(name, &mesh, ratio, parsed.rounds)?);
        }
    }
    if parsed.json {
        let rows: Vec<Value> = rows.iter().map(Comparison::json).collect();
        println!("{}", json!({ "rounds": parsed.rounds, "rows": rows }));
    } else {
        print!("{}", table(&rows));
    }
    Ok(())
}

impl Arguments {
    fn of(arguments: &[String]) -> Result<Self> {
        let mut parsed = Self {
            meshes: MESHES.map(str::to_owned).to_vec(),
            ratios: RATIOS.to_vec(),
            rounds: ROUNDS,
            json: false,
        };
        let mut arguments = arguments.iter();
        while let Some(option) = arguments.next() {
            let mut value = || arguments.next().with_context(|| format!("{option} needs a value"));
            match option.as_str() {
                "--meshes" => parsed.meshes = value()?.split(',').map(str::to_owned).collect(),
                "--ratios" => {
                    parsed.ratios = value()?.split(',').map(ratio).collect::<Result<_>>()?
                }
                "--rounds" => {
                    parsed.rounds = value()?.parse().context("--rounds must be a number")?
                }
                "--json" => parsed.json = true,
                _ => bail!("unknown option {option}; the options are {OPTIONS}"),
            }
        }
        ensure!(parsed.rounds > 0, "--rounds must be at least 1");
        Ok(parsed)
    }
}

/// Parses `10%` or `0.1`.
fn ratio(text: &str) -> Result<f64> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    let ratio = unit * number.parse::<f64>().with_context(|| format!("invalid ratio {text}"))?;
    ensure!((0.0..=1.0).contains(&ratio), "a ratio must be between 0% and 100%, not {text}");
    Ok(ratio)
}

/// Reads a shared mesh as bare geometry; `.ply` is appended to a name without suffix.
fn read(name: &str) -> Result<Mesh> {
    let file = if name.contains('.') { name.to_owned() } else { format!("{name}.ply") };
    let mesh = crate::read(&file)?.with_context(|| {
        format!("{file} is not among the shared meshes; set MESHLOD_MESHES to their folder")
    })?;
    Ok(Mesh { attributes: None, ..mesh })
}

fn row(name: &str, mesh: &Mesh, ratio: f64, rounds: usize) -> Result<Comparison> {
    let options = Options { method: Method::LindstromTurk, ..Options::default() };
    let (indexed, target) = (Indexed::from(mesh), Target::Ratio(ratio));
    let faces = target.faces_of(mesh.faces.len());
    let ours = || contract_to(mesh, target, &options).expect("the mesh can be simplified").0;
    let theirs = || simplify_with_update(&indexed, faces);
    let original = PreparedSurface::new(mesh)?;
    Ok(Comparison {
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

impl Comparison {
    /// Returns our rate and theirs in million input faces per second.
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

fn table(rows: &[Comparison]) -> String {
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
        let Comparison { mesh, ratio, took, ours, theirs, .. } = row;
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
    fn arguments_are_parsed() {
        let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let parsed =
            Arguments::of(&words("--meshes horse-97k,igea --ratios 10%,0.01 --json")).unwrap();
        assert_eq!((parsed.meshes.len(), parsed.json, parsed.rounds), (2, true, ROUNDS));
        assert!((parsed.ratios[0] - 0.1).abs() < 1e-12 && parsed.ratios[1] == 0.01);
        for bad in ["--rounds 0", "--rounds", "--ratios 200%", "horse", "--ratios ten"] {
            assert!(Arguments::of(&words(bad)).is_err(), "{bad}");
        }
    }
}
