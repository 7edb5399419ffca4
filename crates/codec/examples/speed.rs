//! Measures the time, size and error of each scheme at the accuracy of 11 bits for the whole mesh.
//!
//! Takes files, or names of samples with a number of faces (`gyroid:250000`). Names of schemes
//! among them leave out the other schemes.

use std::time::Instant;

use meshlod_codec::{CompressionTarget, Reconstruction, Scheme, compress};
use meshlod_measure::{DistanceOptions, distance};
use meshlod_mesh::{AttributeBounds, Mesh};
use meshlod_samples as samples;

const SCHEMES: [(&str, Scheme); 3] = [
    ("blocks", Scheme::Blocks),
    ("lattice", Scheme::Lattice),
    ("parts", Scheme::Parts(Reconstruction::Centred)),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("| | scheme | faces | bytes | mean, % | max, % | seconds | million faces a second |");
    println!("|---|---|--:|--:|--:|--:|--:|--:|");
    let is_scheme = |name: &String| SCHEMES.iter().any(|(title, _)| title == name);
    let (wanted, names): (Vec<_>, Vec<_>) = std::env::args().skip(1).partition(is_scheme);
    let is_wanted = |title: &str| wanted.is_empty() || wanted.iter().any(|name| name == title);
    for name in names {
        let mut mesh = load(&name)?;
        mesh.attributes = None;
        for (title, scheme) in SCHEMES.into_iter().filter(|(title, _)| is_wanted(title)) {
            let start = Instant::now();
            let done =
                compress(&mesh, scheme, CompressionTarget::Bits(11), &AttributeBounds::default())?;
            let seconds = start.elapsed().as_secs_f64();
            let options = DistanceOptions { samples: 200_000, ..Default::default() };
            let apart = distance(&mesh, &done.compressed.decode()?, &options)?;
            let diagonal = mesh.bounds().diagonal();
            println!(
                "| {name} | {title} | {} | {} | {:.5} | {:.4} | {seconds:.2} | {:.3} |",
                mesh.faces.len(),
                done.compressed.to_bytes().len(),
                100.0 * apart.mean() / diagonal,
                100.0 * apart.max() / diagonal,
                mesh.faces.len() as f64 / seconds / 1e6,
            );
        }
    }
    Ok(())
}

fn load(name: &str) -> Result<Mesh, Box<dyn std::error::Error>> {
    if let Some((sample, faces)) = name.split_once(':') {
        return samples::by_name(sample, Some(faces.parse()?))
            .ok_or_else(|| format!("no sample is called {sample}").into());
    }
    Ok(meshlod_io::read(name, &Default::default())?.flatten())
}
