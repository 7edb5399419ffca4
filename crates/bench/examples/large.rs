//! The kernel on meshes of any size: copies of a shared mesh side by side, each slightly different,
//! so that no two costs are equal.
//!
//! ```text
//! cargo run --release -p meshlod-bench --example large -- dragon.ply 1 64
//! ```
//! Takes a shared mesh and sizes in million faces. Prints the time per million faces and the peak
//! memory of the process.

use std::time::Instant;

use anyhow::{Context, Result};
use meshlod::mesh::{Mesh, VertexId};
use meshlod::simplify::{Method, Options, Target, contract_to};
use meshlod_bench::read;

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let name = args.next().context("name a mesh")?;
    let mut mesh = read(&name)?.with_context(|| format!("{name} is not available"))?;
    mesh.attributes = None;
    println!("million faces | copies | s | s per million | peak, bytes per face | left");
    for millions in args {
        let faces = millions.parse::<usize>()? * 1_000_000;
        line(&tiled(&mesh, faces.div_ceil(mesh.faces.len())))?;
    }
    Ok(())
}

fn line(mesh: &Mesh) -> Result<()> {
    let options = Options { method: Method::LindstromTurk, ..Options::default() };
    let start = Instant::now();
    let (level, _) = contract_to(mesh, Target::Ratio(0.1), &options)?;
    let seconds = start.elapsed().as_secs_f64();
    let millions = mesh.faces.len() as f64 * 1e-6;
    println!(
        "{millions:.2} | {seconds:.2} | {:.3} | {:.0} | {}",
        seconds / millions,
        peak()? as f64 / mesh.faces.len() as f64,
        level.faces.len()
    );
    Ok(())
}

/// Places copies in a cubic grid, each vertex moved by up to a tenth of an edge.
fn tiled(mesh: &Mesh, copies: usize) -> Mesh {
    let bounds = mesh.bounds();
    let edge = bounds.diagonal() / (mesh.faces.len() as f64).sqrt();
    let along = (copies as f64).cbrt().ceil() as usize;
    let mut tiled = Mesh::default();
    tiled.positions.reserve_exact(copies * mesh.positions.len());
    tiled.faces.reserve_exact(copies * mesh.faces.len());
    let mut noise = Noise(0);
    for copy in 0..copies {
        let first = tiled.positions.len() as u32;
        let cell = [copy % along, copy / along % along, copy / along / along];
        tiled.positions.extend(mesh.positions.iter().map(|position| {
            let mut place = *position;
            for (axis, x) in place.iter_mut().enumerate() {
                let size = bounds.max[axis] - bounds.min[axis];
                *x += 1.1 * size * cell[axis] as f64 + 0.1 * edge * noise.next();
            }
            place
        }));
        let moved = |&[a, b, c]: &[VertexId; 3]| [a, b, c].map(|v| VertexId(v.0 + first));
        tiled.faces.extend(mesh.faces.iter().map(moved));
    }
    tiled
}

/// Reproducible random numbers between -1 and 1: splitmix64.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ z >> 31) as i64 as f64 / i64::MAX as f64
    }
}

/// Returns the peak memory of this process in bytes.
fn peak() -> Result<u64> {
    let status = std::fs::read_to_string("/proc/self/status")
        .context("peak memory is read from /proc, on Linux only")?;
    let line =
        status.lines().find_map(|line| line.strip_prefix("VmHWM:")).context("VmHWM is missing")?;
    let kilobytes: u64 = line.trim().trim_end_matches("kB").trim().parse()?;
    Ok(kilobytes * 1024)
}
