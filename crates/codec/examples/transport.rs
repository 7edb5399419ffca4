//! Measures the size of `.mlz` files at 11 bits, and the speed of encoding and decoding.

use std::time::{Duration, Instant};

use meshlod_codec::{Transport, TransportFile, TransportOptions};
use meshlod_fixtures::shared_mesh;
use meshlod_mesh::Mesh;

/// Meshes, and Draco's bytes per triangle at 11 bits and compression level 7, without random
/// access.
const MESHES: [(&str, f64); 10] = [
    ("igea.ply", 0.567),
    ("horse-97k.ply", 0.645),
    ("bunny.ply", 0.676),
    ("armadillo-173k.ply", 0.865),
    ("fandisk-32k.ply", 0.985),
    ("nefertiti.ply", 0.977),
    ("feline.ply", 0.970),
    ("dragon-100k.ply", 1.015),
    ("horse.ply", 1.036),
    ("squirrel-20k.obj", 1.210),
];
/// Number of runs, of which the fastest counts.
const ROUNDS: usize = 9;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "| | connectivity | positions | headers | bytes per triangle | ratio to Draco | Mtri/s in | MB/s out |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|");
    let mut sum = 0.0;
    for (name, draco) in MESHES {
        let Some(path) = shared_mesh(name) else { continue };
        let mesh = meshlod_io::read(&path, &Default::default())?.flatten();
        // Draco was given neither attributes nor objects.
        let mesh = Mesh::new(mesh.positions, mesh.faces);
        sum += row(&mesh, name, draco)?;
    }
    println!("mean {:.3} bytes per triangle", sum / MESHES.len() as f64);
    Ok(())
}

/// Prints the row of a mesh and returns its bytes per triangle.
fn row(mesh: &Mesh, name: &str, draco: f64) -> Result<f64, Box<dyn std::error::Error>> {
    let faces = mesh.faces.len() as f64;
    let options = TransportOptions::default();
    let (encoded, encoding) = least(|| Transport::encode(mesh, &options));
    let encoded = encoded?;
    let (mut positions, mut corners) = (Vec::new(), Vec::new());
    let (decoded, decoding) =
        least(|| TransportFile::open(&encoded.bytes)?.decode_into(&mut positions, &mut corners));
    decoded?;
    let out = 12.0 * (positions.len() + corners.len()) as f64;
    let size = encoded.bytes.len() as f64 / faces;
    let sizes = encoded.sizes;
    let parts = [sizes.connectivity, sizes.positions, sizes.headers].map(|part| part / faces);
    println!(
        "| {name} | {:.3} | {:.3} | {:.3} | {size:.3} | {:.2} | {:.2} | {:.0} |",
        parts[0],
        parts[1],
        parts[2],
        size / draco,
        faces / encoding.as_secs_f64() / 1e6,
        out / decoding.as_secs_f64() / 1e6,
    );
    Ok(size)
}

fn least<T>(mut work: impl FnMut() -> T) -> (T, Duration) {
    let mut least = Duration::MAX;
    let mut last = None;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        last = Some(work());
        least = least.min(start.elapsed());
    }
    (last.expect("a round"), least)
}
