//! Measures the certified distance between two meshes, then asks which faces are farther apart than
//! parts of it; prints the time that each takes.
//!
//! `cargo run --release -p meshlod-measure --example certified A.ply B.ply`

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use meshlod_measure::{
    BeyondOptions, CertifiedOptions, PreparedSurface, certified_one_way, faces_beyond,
};
use meshlod_mesh::Mesh;

type Failure = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let read = |path: PathBuf| -> Result<Mesh, Failure> {
        Ok(meshlod_io::ply::read(&std::fs::read(path)?)?)
    };
    let mut files = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(a), Some(b)) = (files.next(), files.next()) else {
        return Err("give two PLY files".into());
    };
    let (a, b) = (read(a)?, read(b)?);
    let start = Instant::now();
    let (a, b) = (PreparedSurface::new(&a)?, PreparedSurface::new(&b)?);
    println!("ready: {:.3} s", start.elapsed().as_secs_f64());
    for (from, to) in [(&a, &b), (&b, &a)] {
        let start = Instant::now();
        let way = certified_one_way(from, to, &CertifiedOptions::default());
        let [lower, upper] = [way.lower, way.upper].map(|x| 100.0 * x / a.diagonal());
        let time = start.elapsed().as_secs_f64();
        println!("{lower:.5} % to {upper:.5} % in {time:.3} s, {} splits", way.splits);
        for part in [0.3, 0.9, 1.01] {
            let (start, limit) = (Instant::now(), part * way.upper);
            let beyond = faces_beyond(from, to, &|_| limit, &BeyondOptions::default());
            let time = start.elapsed().as_secs_f64();
            let (faces, splits) = (beyond.faces.len(), beyond.splits);
            println!("  beyond {part} of that: {faces} faces in {time:.3} s, {splits} splits");
        }
    }
    Ok(())
}
