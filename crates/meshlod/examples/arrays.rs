//! From raw arrays to a chain of levels, and back to arrays.
//!
//! `cargo run --release -p meshlod --example arrays`

use std::error::Error;

use meshlod::measure::{DistanceOptions, distance};
use meshlod::mesh::MeshArrays;
use meshlod::{Mesh, Options, Target, samples, simplify};

fn main() -> Result<(), Box<dyn Error>> {
    let (points, faces) = points_and_faces();
    // Points may be f32 or f64, or vectors of glam or mint with the features of these names. For a
    // flat list of indices, pass `indices.as_chunks().0`.
    let mesh = Mesh::from_arrays(MeshArrays::new(&points, &faces))?;
    println!("{:>6}  {:>7}  {:>7}  max error", "level", "points", "faces");
    let options = DistanceOptions { samples: 50_000, ..DistanceOptions::default() };
    for ratio in [0.5, 0.25, 0.1, 0.02] {
        let (level, _) = simplify(&mesh, Target::Ratio(ratio), &Options::default())?;
        let apart = distance(&mesh, &level, &options)?;
        let MeshArrays { positions, faces, .. } = level.into_arrays();
        let percent = apart.percent(apart.max());
        println!(
            "{:>5}%  {:>7}  {:>7}  {percent:.4}%",
            100.0 * ratio,
            positions.len(),
            faces.len()
        );
    }
    Ok(())
}

/// Returns arrays as they might come from anywhere: three `f32` a point, three indices a face.
fn points_and_faces() -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let arrays = samples::knot(20_000).into_arrays();
    let points = arrays.positions.iter().map(|point| point.map(|x| x as f32));
    (points.collect(), arrays.faces)
}
