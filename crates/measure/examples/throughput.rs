//! Measures closest point queries per second, on one thread, for samples near the surface.
//!
//! `cargo run --release -p meshlod-measure --example throughput [A.ply [B.ply]]`: without B, A is
//! compared with itself after moving each vertex by up to 0.1 % of the diagonal; without A, A is
//! the shared dragon.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

use meshlod_measure::{DistanceOptions, PreparedSurface, surface_distance};
use meshlod_mesh::Mesh;

type Failure = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let mut files = std::env::args_os().skip(1).map(PathBuf::from);
    let first = files.next().or_else(|| meshlod_fixtures::shared_mesh("dragon.ply"));
    let first = first.ok_or("the shared dragon.ply was not found: give a PLY file")?;
    let a = read(&first)?;
    let b = match files.next() {
        Some(second) => read(&second)?,
        None => shaken(&a, a.bounds().diagonal() * 0.001),
    };
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| measure(&a, &b))
}

fn read(path: &Path) -> Result<Mesh, Failure> {
    Ok(meshlod_io::ply::read(&std::fs::read(path)?)?)
}

/// Copies a mesh and displaces each coordinate by up to `reach`.
fn shaken(mesh: &Mesh, reach: f64) -> Mesh {
    let mut shaken = mesh.clone();
    for (i, x) in shaken.positions.iter_mut().flatten().enumerate() {
        let part = (i as f64 * 0.618_033_988_749_894_9).fract();
        *x += reach * (2.0 * part - 1.0);
    }
    shaken
}

fn measure(a: &Mesh, b: &Mesh) -> Result<(), Failure> {
    let options = DistanceOptions::default();
    let start = Instant::now();
    let (from, to) = (PreparedSurface::new(a)?, PreparedSurface::new(b)?);
    println!(
        "ready: {:.3} s for {} faces",
        start.elapsed().as_secs_f64(),
        a.faces.len() + b.faces.len()
    );
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        let apart = surface_distance(&from, &to, &options)?;
        best = best.min(start.elapsed().as_secs_f64());
        let [mean, rms, max] = [apart.mean(), apart.rms(), apart.max()].map(|x| apart.percent(x));
        println!("mean {mean:.4} %, RMS {rms:.4} %, max {max:.4} % of the diagonal");
    }
    let used = |mesh: &Mesh| mesh.used_vertices().iter().filter(|&&used| used).count();
    let points = 2 * options.samples + used(a) + used(b);
    println!("{points} points in {best:.3} s: {:.2} million a second", points as f64 / best / 1e6);
    Ok(())
}
