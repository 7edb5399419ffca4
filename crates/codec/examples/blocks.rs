//! Measures vertex blocks at the surface error of 11 bits for the whole mesh.

use std::time::Instant;

use meshlod_codec::{Accuracy, VertexBlocks};
use meshlod_fixtures::compression_meshes;
use meshlod_measure::{DistanceOptions, distance};
use meshlod_mesh::{Bounds, Mesh};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "| | bytes per vertex | reduction, % | mean : 11 bits | max : 11 bits | flipped | in 11 bits | normals : 11 bits | refined blocks, % | seconds |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
    for (name, path) in compression_meshes() {
        let mesh = meshlod_io::read(&path, &Default::default())?.flatten();
        let start = Instant::now();
        let (blocks, report) = VertexBlocks::new(&mesh, Accuracy::Bits(11))?;
        let seconds = start.elapsed().as_secs_f64();
        let mut decoded = mesh.clone();
        for (vertex, place) in blocks.vertices().iter().zip(blocks.positions()) {
            decoded.positions[vertex.index()] = place;
        }
        let cubes = in_cubes(&mesh, report.cube_side);
        let options = DistanceOptions { samples: 200_000, ..Default::default() };
        let [ours, theirs] = [&decoded, &cubes].map(|coarse| distance(&mesh, coarse, &options));
        let (ours, theirs) = (ours?, theirs?);
        println!(
            "| {name} | {:.3} | {:.1} | {:.2} | {:.2} | {} | {} | {:.2} | {:.1} | {seconds:.1} |",
            blocks.bytes() as f64 / blocks.vertices().len() as f64,
            100.0 * blocks.reduction(),
            ours.mean() / theirs.mean(),
            ours.max() / theirs.max(),
            report.blocks.flips,
            report.cubes.flips,
            turned(&mesh, &decoded) / turned(&mesh, &cubes),
            100.0 * report.refined_blocks as f64 / blocks.blocks() as f64,
        );
    }
    Ok(())
}

/// Rounds vertices to cubic cells from the least corner on.
fn in_cubes(mesh: &Mesh, cell: f64) -> Mesh {
    let low = Bounds::of(&mesh.positions).min;
    let mut coarse = mesh.clone();
    for place in &mut coarse.positions {
        *place = [0, 1, 2].map(|k| low[k] + cell * ((place[k] - low[k]) / cell).round());
    }
    coarse
}

/// Returns the mean angle by which faces are turned, weighted by area.
fn turned(mesh: &Mesh, coarse: &Mesh) -> f64 {
    let (mut sum, mut area) = (0.0, 0.0);
    for face in &mesh.faces {
        let double = |mesh: &Mesh| {
            let [a, b, c] = face.map(|v| glam::DVec3::from(mesh.positions[v.index()]));
            (b - a).cross(c - a)
        };
        let (was, is) = (double(mesh), double(coarse));
        sum += was.length() * was.cross(is).length().atan2(was.dot(is));
        area += was.length();
    }
    sum / area
}
