//! Volume lost at the boundaries of open meshes, textured or not, behind the cones that close them:
//! the figures of `docs/notes/boundaries.md`.
//!
//! `cargo run --release -p meshlod-bench --example boundaries -- bunny.ply lion-head.off`

use std::error::Error;
use std::path::Path;

use meshlod::measure::{distance, volume};
use meshlod::simplify::{Simplifier, VolumeLoss};
use meshlod::{Method, Options, ReadOptions, Target, Topology, io};

const METHODS: [Method; 5] = [
    Method::KimJang,
    Method::LindstromTurkFaces,
    Method::LeeJang,
    Method::LindstromTurk,
    Method::Qem,
];

fn main() -> Result<(), Box<dyn Error>> {
    for path in std::env::args().skip(1) {
        let mesh = io::read(Path::new(&path), &ReadOptions::default())?.into_mesh();
        let whole = volume(&mesh).abs();
        for method in METHODS {
            for ratio in [0.5, 0.1, 0.02] {
                let options = Options { method, topology: Topology::Keep, ..Options::default() };
                let mut simplifier = Simplifier::new(&mesh, &options)?;
                // The kernel's own report has no cones.
                let mut seen = VolumeLoss::default();
                let report = simplifier.run(Target::Ratio(ratio), &mut seen)?;
                let measured = distance(&mesh, &simplifier.level(), &Default::default())?;
                println!(
                    "{path} {} to {} faces: {} contractions at boundaries, {:+.1e} of the volume, \
                     mean {:.5} %, max {:.3} %",
                    method.name(),
                    report.output_faces,
                    report.volume.at_boundaries.contractions,
                    seen.behind_boundary_cones.unwrap_or(0.0) / whole,
                    measured.percent(measured.mean()),
                    measured.percent(measured.max()),
                );
            }
        }
    }
    Ok(())
}
