//! A mesh in few bytes: `.mlz` to send, `.mlq` to draw from, at several accuracies.
//!
//! `cargo run --release -p meshlod --example compress`

use std::error::Error;

use meshlod::codec::CompressionTarget;
use meshlod::measure::{DistanceOptions, distance};
use meshlod::{CompressOptions, compress, decompress, samples};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let mesh = samples::gyroid(20_000);
    let options = DistanceOptions { samples: 50_000, ..DistanceOptions::default() };
    println!("file  bits    bytes  bits a triangle  mean error");
    for suffix in ["mlz", "mlq"] {
        for bits in [8, 11, 14] {
            let path = folder.path().join(format!("gyroid.{suffix}"));
            let target = CompressionTarget::Bits(bits);
            let report = compress(&mesh, &path, &CompressOptions { target, ..Default::default() })?;
            let apart = distance(&mesh, &decompress(&path)?, &options)?;
            let a_triangle = 8.0 * report.bytes as f64 / report.faces as f64;
            let percent = apart.percent(apart.mean());
            println!(
                ".{suffix}  {bits:>4}  {:>7}  {a_triangle:>15.2}  {percent:.5}%",
                report.bytes
            );
        }
    }
    Ok(())
}
