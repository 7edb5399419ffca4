//! A mesh in few bytes: `.mlz` to send, `.mlq` to draw from, at several accuracies.
//!
//! `cargo run --release -p meshlod --example compress`

use std::error::Error;

use meshlod::jobs::{CompressRequest, CompressTarget, Packing, compress};
use meshlod::measure::{DistanceOptions, distance};
use meshlod::{AnyFile, FileKind, ReadOptions, Scene, samples};

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = samples::gyroid(20_000);
    let (options, read) =
        (DistanceOptions { samples: 50_000, ..DistanceOptions::default() }, ReadOptions::default());
    println!("file  bits    bytes  bits a triangle  mean error");
    for (suffix, kind) in [("mlz", FileKind::Sent), ("mlq", FileKind::Resident)] {
        for bits in [8, 11, 14] {
            let request = CompressRequest {
                packing: Packing::of(kind).unwrap_or_default(),
                target: CompressTarget::Bits(bits),
                ..CompressRequest::default()
            };
            let scene = Scene::from_mesh("gyroid", mesh.clone());
            let (bytes, report) = compress(scene, &request, &())?;
            let file = AnyFile::from_bytes("gyroid", kind, bytes, &mut |_| None, &read)?;
            let apart = distance(&mesh, &file.into_scene()?.into_mesh(), &options)?;
            let a_triangle = 8.0 * report.bytes_per_triangle;
            let percent = apart.percent(apart.mean());
            println!(
                ".{suffix}  {bits:>4}  {:>7}  {a_triangle:>15.2}  {percent:.5}%",
                report.bytes_total
            );
        }
    }
    Ok(())
}
