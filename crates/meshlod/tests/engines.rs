//! The kernel and the policy engine on the same methods: equal accuracy, and equal volume.

use meshlod::measure::{DistanceOptions, PreparedSurface, surface_distance, volume};
use meshlod::samples;
use meshlod::simplify::Simplifier;
use meshlod::{Mesh, Method, Options, Target, Topology};

/// The mean distance of a level, in % of the diagonal, and the part of the volume that it has lost.
fn figures(mesh: &Mesh, mut simplifier: Simplifier<'_>, ratio: f64) -> [f64; 2] {
    simplifier.run(Target::Ratio(ratio), &mut ()).unwrap();
    let level = simplifier.level();
    let surfaces = [mesh, &level].map(|mesh| PreparedSurface::new(mesh).unwrap());
    let options = DistanceOptions { samples: 100_000, ..DistanceOptions::default() };
    let apart = surface_distance(&surfaces[0], &surfaces[1], &options).unwrap();
    [apart.percent(apart.mean()), 1.0 - volume(&level) / volume(mesh)]
}

/// Every vertex moved to a mean of its neighbours at random, more than half the way.
///
/// On the unmodified samples all edges of a row cost the same. Where a bucket takes them in
/// insertion order, a level is some 5 % farther off than by the order of the policy engine.
fn shaken(mesh: &Mesh) -> Mesh {
    let mut state = 1u64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut steps = vec![([0.0; 3], 1e-9); mesh.positions.len()];
    for face in &mesh.faces {
        for k in 0..3 {
            let [a, b] = [face[k], face[(k + 1) % 3]].map(|v| mesh.positions[v.index()]);
            let (weight, (step, weights)) = (random(), &mut steps[face[k].index()]);
            (0..3).for_each(|axis| step[axis] += weight * (b[axis] - a[axis]));
            *weights += weight;
        }
    }
    let moved = |(p, (step, weights)): (&[f64; 3], ([f64; 3], f64))| {
        std::array::from_fn(|axis| p[axis] + 0.6 * step[axis] / weights)
    };
    Mesh::new(mesh.positions.iter().zip(steps).map(moved).collect(), mesh.faces.clone())
}

#[test]
fn both_engines_are_as_near_and_keep_the_volume() {
    let samples = [samples::knot(40_000), samples::gyroid(40_000), samples::torus(40_000)];
    for mesh in samples.iter().map(shaken) {
        for (method, ratio) in [
            (Method::LindstromTurk, 0.2),
            (Method::LindstromTurk, 0.05),
            (Method::Qem, 0.2),
            (Method::Qem, 0.05),
        ] {
            // Handles close in the kernel alone.
            let topology = Topology::Keep;
            let options = Options { method, topology, ..Options::default() };
            let fast = Simplifier::new(&mesh, &options).unwrap();
            let general = Simplifier::on_policy_engine(&mesh, &options).unwrap();
            let [fast, general] = [fast, general].map(|engine| figures(&mesh, engine, ratio));
            if method.conserves_volume() {
                // The kernel leaves a debt where the place would be too far away.
                assert!(fast[1].abs() < 1e-2 && general[1].abs() < 1e-12);
            }
            let times = fast[0] / general[0];
            assert!((0.98..1.02).contains(&times), "{times} times as far off at {ratio}");
        }
    }
}
