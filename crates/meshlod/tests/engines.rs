//! The fast engine and the general one, on the same method: the same accuracy, and the same volume.

use meshlod::measure::{DistanceOptions, Surface, surface_distance, volume};
use meshlod::mesh::sample;
use meshlod::simplify::Simplifier;
use meshlod::{Mesh, Method, Options, Target};

/// The mean distance of a level, in % of the diagonal, and the part of the volume that it has lost.
fn figures(mesh: &Mesh, mut simplifier: Simplifier<'_>, ratio: f64) -> [f64; 2] {
    simplifier.run(Target::Ratio(ratio), &mut ()).unwrap();
    let level = simplifier.level();
    let surfaces = [mesh, &level].map(|mesh| Surface::new(mesh).unwrap());
    let options = DistanceOptions { samples: 100_000, ..DistanceOptions::default() };
    let apart = surface_distance(&surfaces[0], &surfaces[1], &options).unwrap();
    [apart.percent(apart.mean()), 1.0 - volume(&level) / volume(mesh)]
}

#[test]
fn both_engines_are_as_near_and_keep_the_volume() {
    let closed = [sample::knot(40_000), sample::gyroid(40_000), sample::torus(40_000)];
    for ratio in [0.2, 0.05] {
        let mut times = 0.0;
        for mesh in &closed {
            let mesh = Mesh { attributes: None, ..mesh.clone() };
            let options = Options { method: Method::LindstromTurk, ..Options::default() };
            let fast = Simplifier::new(&mesh, &options).unwrap();
            let general = Simplifier::with_general_engine(&mesh, &options).unwrap();
            let [fast, general] = [fast, general].map(|engine| figures(&mesh, engine, ratio));
            eprintln!("{ratio}: {fast:?} {general:?}");
            assert!(fast[1].abs() < 1e-6 && general[1].abs() < 1e-12);
            times += fast[0] / general[0] / closed.len() as f64;
        }
        assert!((0.98..1.02).contains(&times), "{times} times as far off at {ratio}");
    }
}
