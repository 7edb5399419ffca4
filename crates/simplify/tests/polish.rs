//! Levels that are fitted to the input once more.

mod common;

use std::collections::HashMap;

use glam::DVec3;
use meshlod_fixtures::shape::{bare, volume};
use meshlod_mesh::{Connectivity, FaceId, Lock, Locks, Mesh, VertexId};
use meshlod_samples as samples;
use meshlod_simplify::{Options, Simplifier, Target, Topology, VolumeLoss};
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
            assert!(gain < 0.99, "{name} {ratio}: {gain}");
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
    let turn = glam::DMat3::from_rotation_x(0.3) * glam::DMat3::from_rotation_z(0.7);
    for (mesh, ratio) in [(samples::voxels(20_000, 1), 0.5), (samples::stairs(5_000), 0.03)] {
        let [plain, fitted] = levels(&mesh, ratio, &Options::default());
        assert_eq!(plain.positions, fitted.positions);
        let turned = |at: &[f64; 3]| (turn * DVec3::from(*at)).as_vec3().as_dvec3().into();
        let positions = mesh.positions.iter().map(turned).collect();
        let [plain, fitted] = levels(&Mesh { positions, ..mesh }, ratio, &Options::default());
        let moved = plain.positions.iter().zip(&fitted.positions).filter(|(a, b)| a != b).count();
        assert_eq!(moved, 0, "{ratio}");
    }
}

#[test]
fn a_run_within_an_error_is_left_as_it_is() {
    let mesh = samples::knot(4_000);
    let [plain, asked] = [false, true].map(|polish| {
        let mut simplifier =
            Simplifier::new(&mesh, &Options { polish, ..Options::default() }).unwrap();
        simplifier.run(Target::Error(0.01), &mut ()).unwrap();
        simplifier.settled_level(&mut VolumeLoss::default())
    });
    assert!(plain == asked && plain.faces.len() < mesh.faces.len());
}

#[test]
fn vertices_at_one_place_stay() {
    let mut mesh = bare(samples::torus(4_000));
    let count = mesh.positions.len() as u32;
    // Two shells that touch everywhere.
    let other: Vec<_> = mesh.faces.iter().map(|face| face.map(|v| VertexId(v.0 + count))).collect();
    mesh.positions.extend_from_within(..);
    mesh.faces.extend(other);
    let options = Options { topology: Topology::Keep, ..Options::default() };
    let [plain, fitted] = levels(&mesh, 0.7, &options);
    let mut at: HashMap<[u64; 3], Vec<usize>> = HashMap::new();
    for (v, place) in plain.positions.iter().enumerate() {
        at.entry(place.map(f64::to_bits)).or_default().push(v);
    }
    let shared: Vec<usize> = at.into_values().filter(|all| all.len() > 1).flatten().collect();
    assert!(shared.len() > 100 && shared.len() < plain.positions.len());
    assert!(shared.into_iter().all(|v| plain.positions[v] == fitted.positions[v]));
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
