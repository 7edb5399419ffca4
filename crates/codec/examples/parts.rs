//! Compares parts at a reduction of 70 % with 11 bits for the whole mesh: the table of [LCL10].

use std::path::Path;
use std::time::Instant;

use meshlod_codec::{Partitioner, Parts, Reconstruction};
use meshlod_fixtures::shared_mesh;
use meshlod_measure::{DistanceOptions, distance};
use meshlod_mesh::{Bounds, Mesh};

const MESHES: [&str; 5] =
    ["horse.ply", "feline.ply", "squirrel-20k.obj", "armadillo-173k.ply", "dragon-100k.ply"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "| | parts | overhead, % | reduction, % | truncated : 11 bits | centred : 11 bits | seconds |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|");
    for name in MESHES {
        let Some(path) = shared_mesh(name) else { continue };
        let mesh = read(&path)?;
        let start = Instant::now();
        let parting = Partitioner::new(&mesh)?;
        let centred = parting.within_reduction(0.7, Reconstruction::Centred)?;
        let seconds = start.elapsed().as_secs_f64();
        let truncated = parting.with_count(centred.parts().len(), Reconstruction::Truncated);
        let ratio = |parts: &Parts, rounding: f64| -> Result<f64, Box<dyn std::error::Error>> {
            let options = DistanceOptions { samples: 200_000, ..Default::default() };
            let of = |coarse: &Mesh| distance(&mesh, coarse, &options).map(|apart| apart.mean());
            Ok(of(&parts.decode())? / of(&in_11_bits(&mesh, rounding))?)
        };
        println!(
            "| {name} | {} | {:.1} | {:.2} | {:.2} | {:.2} | {seconds:.1} |",
            centred.parts().len(),
            100.0 * centred.overhead(),
            100.0 * centred.reduction(),
            ratio(&truncated, 0.0)?,
            ratio(&centred, 0.5)?,
        );
    }
    Ok(())
}

fn read(path: &Path) -> Result<Mesh, meshlod_io::IoError> {
    Ok(meshlod_io::read(path, &Default::default())?.flatten())
}

/// Rounds vertices to cubic cells, 2047 along the longest side; down, or to the nearest with .5.
fn in_11_bits(mesh: &Mesh, rounding: f64) -> Mesh {
    let bounds = Bounds::of(&mesh.positions);
    let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    let cell = longest / 2047.0;
    let mut coarse = mesh.clone();
    for place in &mut coarse.positions {
        *place = [0, 1, 2]
            .map(|k| bounds.min[k] + cell * ((place[k] - bounds.min[k]) / cell + rounding).floor());
    }
    coarse
}
