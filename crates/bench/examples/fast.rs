//! The fast engine beside meshoptimizer's simplify with update, on one core by turns: speed, distance,
//! volume.
//!
//! ```text
//! cargo run --release -p meshlod-bench --example fast -- 5 horse-97k.ply igea.ply dragon.ply bunny.ply
//! ```
//! Takes a number of rounds, 0 for none, and names of shared meshes.

use anyhow::{Context, Result};
use meshlod::measure::{DistanceOptions, Surface, surface_distance, volume};
use meshlod::mesh::Mesh;
use meshlod::simplify::{Method, Options, Target, simplify};
use meshlod_bench::peer::{Indexed, simplify_with_update};
use meshlod_bench::{alternate, one_core, read};

const SAMPLES: usize = 200_000;

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let rounds: usize = args.next().context("how many rounds?")?.parse()?;
    println!("mesh ratio | speed M/s ours theirs ratio | mean % max % | theirs | volume ppm");
    for name in args {
        let mut mesh = read(&name)?.with_context(|| format!("{name} is not here"))?;
        mesh.attributes = None;
        for ratio in [0.1, 0.01] {
            line(&name, &mesh, ratio, rounds)?;
        }
    }
    Ok(())
}

fn line(name: &str, mesh: &Mesh, ratio: f64, rounds: usize) -> Result<()> {
    let options = Options { method: Some(Method::LindstromTurk), ..Options::default() };
    let indexed = Indexed::from(mesh);
    let faces = (mesh.faces.len() as f64 * ratio) as usize;
    let ours = || simplify(mesh, Target::Ratio(ratio), &options).expect("it can be");
    let theirs = || simplify_with_update(&indexed, faces);
    let (level, report) = ours();
    print!("{name} {ratio} {} |", level.faces.len());
    if rounds > 0 {
        let took = one_core(|| alternate(rounds, ours, theirs));
        let rate = |seconds: f64| mesh.faces.len() as f64 / seconds * 1e-6;
        print!(" {:.2} {:.2} {:.2} |", rate(took.ours), rate(took.theirs), took.ratio);
    }
    let original = Surface::new(mesh)?;
    let options = DistanceOptions { samples: SAMPLES, seed: 0 };
    for level in [&level, &Mesh::from(&theirs())] {
        let apart = surface_distance(&original, &Surface::new(level)?, &options)?;
        print!(" {:.5} {:.3} |", apart.percent(apart.mean()), apart.percent(apart.max()));
    }
    let drift = (volume(&level) - volume(mesh)) / volume(mesh);
    println!(" {:.3} | {}", drift * 1e6, report.refusals);
    Ok(())
}
