//! The kernel with one thread and with two, with the mesh in file order and shuffled: wall time in
//! alternating rounds, and whether the levels are equal.
//!
//! ```text
//! cargo run --release -p meshlod-bench --example threads -- 5 dragon.ply igea.ply
//! ```
//! Takes a number of rounds and names of shared meshes.

use std::time::Instant;

use anyhow::{Context, Result};
use meshlod::measure::{DistanceOptions, PreparedSurface, surface_distance};
use meshlod::mesh::{Mesh, VertexId};
use meshlod::simplify::{Method, Options, Target, contract_to};
use meshlod_bench::read;

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let rounds: usize = args.next().context("give a number of rounds")?.parse()?;
    println!("mesh ratio | 1 thread s | speed with 2 threads | slowdown shuffled | means");
    for name in args {
        let mut mesh = read(&name)?.with_context(|| format!("{name} is not available"))?;
        mesh.attributes = None;
        let scrambled = scrambled(&mesh);
        for ratio in [0.1, 0.01] {
            line(&name, [&mesh, &scrambled], ratio, rounds)?;
        }
    }
    Ok(())
}

fn line(name: &str, [mesh, scrambled]: [&Mesh; 2], ratio: f64, rounds: usize) -> Result<()> {
    let one = pool(1)?;
    let two = pool(2)?;
    let (mut seconds, mut faster, mut slower) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..rounds {
        let (alone, first) = one.install(|| timed(mesh, ratio));
        let (together, second) = two.install(|| timed(mesh, ratio));
        let (without_order, _) = one.install(|| timed(scrambled, ratio));
        anyhow::ensure!(first == second, "two threads give another level than one");
        seconds.push(alone);
        faster.push(alone / together);
        slower.push(without_order / alone);
    }
    print!("{name} {ratio} | {:.3} | ", median(seconds));
    print!("{:.2} | {:.2} |", median(faster), median(slower));
    let original = PreparedSurface::new(mesh)?;
    let options = DistanceOptions { samples: 200_000, seed: 0 };
    for mesh in [mesh, scrambled] {
        let (_, level) = timed(mesh, ratio);
        let apart = surface_distance(&original, &PreparedSurface::new(&level)?, &options)?;
        print!(" {:.5}", apart.percent(apart.mean()));
    }
    println!();
    Ok(())
}

fn pool(threads: usize) -> Result<rayon::ThreadPool> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build()?)
}

/// Measures wall time, which is what threads save.
fn timed(mesh: &Mesh, ratio: f64) -> (f64, Mesh) {
    let options = Options { method: Method::LindstromTurk, ..Options::default() };
    let start = Instant::now();
    let (level, _) =
        contract_to(mesh, Target::Ratio(ratio), &options).expect("the mesh can be simplified");
    (start.elapsed().as_secs_f64(), level)
}

/// Shuffles the vertices and faces of a mesh.
fn scrambled(mesh: &Mesh) -> Mesh {
    let places = shuffled(mesh.positions.len(), 1);
    let mut positions = vec![[0.0; 3]; places.len()];
    for (&place, &position) in places.iter().zip(&mesh.positions) {
        positions[place as usize] = position;
    }
    let moved = |&f: &u32| mesh.faces[f as usize].map(|v| VertexId(places[v.index()]));
    Mesh::new(positions, shuffled(mesh.faces.len(), 2).iter().map(moved).collect())
}

/// Returns a reproducible shuffle of the numbers below `count`.
fn shuffled(count: usize, seed: u64) -> Vec<u32> {
    let mut all: Vec<u32> = (0..count as u32).collect();
    let mut state = seed;
    for i in (1..count).rev() {
        // The upper bits of a linear congruential generator are random enough.
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        all.swap(i, (state >> 33) as usize % (i + 1));
    }
    all
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
