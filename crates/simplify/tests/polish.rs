//! Levels that are fitted to the input once more.

mod common;

use glam::DVec3;
use meshlod_fixtures::shape::{bare, volume};
use meshlod_mesh::{Connectivity, FaceId, Lock, Locks, Mesh, VertexId};
use meshlod_samples as samples;
use meshlod_simplify::{Options, Simplifier, Target, VolumeLoss};
use meshlod_spatial::Bvh;

/// Returns the settled level with a fraction of the faces, without and with polish.
fn levels(mesh: &Mesh, ratio: f64, options: &Options) -> [Mesh; 2] {
    [false, true].map(|polish| {
        let options = Options { polish, ..options.clone() };
        let mut simplifier = Simplifier::new(mesh, &options).unwrap();
        simplifier.run(Target::Ratio(ratio), &mut ()).unwrap();
        simplifier.settled_level(&mut VolumeLoss::default())
    })
}

/// Returns the root of the mean squared distance from a level of points in the faces of a mesh, a third
/// of the way from the middle to each corner.
fn apart(mesh: &Mesh, level: &Mesh) -> f64 {
    let bvh = Bvh::new(level).unwrap();
    let square = |face: &[VertexId; 3]| {
        let corners = face.map(|v| DVec3::from(mesh.positions[v.index()]));
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let points = corners.map(|corner| middle.lerp(corner, 1.0 / 3.0));
        points.map(|at| bvh.closest(at.into(), None).distance_squared).iter().sum::<f64>()
    };
    (mesh.faces.iter().map(square).sum::<f64>() / (3 * mesh.faces.len()) as f64).sqrt()
}

#[test]
fn levels_are_nearer_and_keep_their_volume() {
    for (name, mesh) in [
        ("knot", samples::knot(20_000)),
        ("gyroid", samples::gyroid(20_000)),
        ("torus", bare(samples::torus(20_000))),
    ] {
        for ratio in [0.1, 0.02] {
            let [plain, fitted] = levels(&mesh, ratio, &Options::default());
            assert_eq!(plain.faces, fitted.faces, "{name}");
            let gain = apart(&mesh, &fitted) / apart(&mesh, &plain);
            assert!(gain < 0.98, "{name} {ratio}: {gain}");
            let lost = (volume(&fitted) / volume(&plain) - 1.0).abs();
            assert!(lost < 1e-12, "{name} {ratio}: {lost:e}");
        }
    }
}

#[test]
fn boundaries_and_locked_vertices_stay() {
    let mesh = samples::terrain(8_000);
    let of_vertex = (0..mesh.positions.len())
        .map(|v| if v % 5 == 0 { Lock::Locked } else { Lock::Free })
        .collect();
    let options = Options { locks: Locks { of_vertex, ties: vec![] }, ..Options::default() };
    let [plain, fitted] = levels(&mesh, 0.3, &options);
    let connectivity = Connectivity::new(&plain.faces, plain.positions.len());
    let input: Vec<[f64; 3]> = mesh.positions.iter().step_by(5).copied().collect();
    let (mut stayed, mut moved) = (0, 0);
    for (v, (from, to)) in plain.positions.iter().zip(&fitted.positions).enumerate() {
        let stays = connectivity.marks(VertexId::new(v)).boundary() || input.contains(from);
        assert!(from == to || !stays, "{v}");
        stayed += usize::from(stays);
        moved += usize::from(from != to);
    }
    assert!(stayed > 100 && moved > 100, "{stayed} {moved}");
}

#[test]
fn what_is_exact_stays_so() {
    let mesh = samples::voxels(20_000, 1);
    let options = Options::default();
    let [plain, fitted] = levels(&mesh, 0.5, &options);
    assert_eq!(plain.positions, fitted.positions);
}

#[test]
fn every_mesh_stays_sound() {
    for (name, mesh) in common::meshes() {
        for ratio in [0.5, 0.1, 0.0] {
            let [plain, fitted] = levels(&mesh, ratio, &Options::default());
            assert!(fitted.validate().is_ok(), "{name} {ratio}");
            let normal = |mesh: &Mesh, face: usize| {
                let [a, b, c] = mesh.faces[face].map(|v| DVec3::from(mesh.positions[v.index()]));
                (b - a).cross(c - a)
            };
            for face in 0..plain.faces.len() {
                let turned = normal(&plain, face).dot(normal(&fitted, face));
                assert!(turned >= 0.0, "{name} {ratio}: {:?}", FaceId::new(face));
            }
        }
    }
}
