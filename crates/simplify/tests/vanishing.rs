//! Small components may vanish, and only they.

mod common;

use std::collections::HashSet;

use glam::DVec3;
use meshlod_fixtures as fixtures;
use meshlod_fixtures::shape::volume;
use meshlod_mesh::{Lock, Locks, Mesh, VertexId, face_components};
use meshlod_samples as samples;
use meshlod_simplify::{
    History, Method, Options, Progressive, Refusal, Report, Simplifier, SimplifyError, Target,
    Topology, contract_to,
};

use crate::common::kernel_methods;

/// The diagonal of a ball of diameter 2.
const DIAGONAL: f64 = 3.47;

/// A ball, and smaller ones beside it.
fn balls(sizes: &[f64]) -> Mesh {
    let mut all = Mesh::default();
    for (i, &size) in [1.0].iter().chain(sizes).enumerate() {
        let aside = 3.0 * i as f64;
        append(&mut all, &samples::sphere(400), |p| {
            [p[0] * size + aside, p[1] * size, p[2] * size]
        });
    }
    all
}

/// Appends a mesh with its vertices moved.
fn append(all: &mut Mesh, other: &Mesh, moved: impl Fn([f64; 3]) -> [f64; 3]) {
    let start = all.positions.len() as u32;
    all.positions.extend(other.positions.iter().map(|&p| moved(p)));
    all.faces.extend(other.faces.iter().map(|face| face.map(|v| VertexId(v.0 + start))));
}

fn run(mesh: &Mesh, options: &Options, target: Target) -> (Mesh, Report) {
    contract_to(mesh, target, options).unwrap()
}

/// Returns the number of faces left of each component of the input.
fn left(mesh: &Mesh, options: &Options, faces: usize) -> Vec<usize> {
    let (level, report) = run(mesh, options, Target::Faces(faces));
    let mut left = vec![0; 1 + mesh.positions.len() / samples::sphere(400).positions.len()];
    for face in &level.faces {
        let x = face.iter().map(|v| level.positions[v.index()][0]).sum::<f64>() / 3.0;
        left[(x / 3.0).round() as usize] += 1;
    }
    left.pop();
    assert_eq!(report.vanished, left.iter().filter(|&&faces| faces == 0).count());
    left
}

#[test]
fn what_is_small_vanishes_and_what_is_large_stays() {
    let mesh = balls(&[0.1, 0.5, 0.2]);
    for method in Method::ALL {
        let below = |vanish_below| Options { method, vanish_below, ..Options::default() };
        let [large, tiny, half, fifth] = left(&mesh, &below(Some(0.3 * DIAGONAL)), 0)[..] else {
            panic!("four balls")
        };
        assert!(large >= 4 && half >= 4 && tiny + fifth == 0, "{}", method.name());
        let keep = Options { topology: Topology::Keep, ..below(Some(1e9)) };
        for options in [below(Some(0.0)), keep] {
            let all = left(&mesh, &options, 0);
            assert!(all.iter().all(|&faces| faces >= 4), "{}: {all:?}", method.name());
        }
        let none = left(&mesh, &below(None), 0);
        let vanished = none[1..].iter().filter(|&&faces| faces == 0).count();
        assert_eq!(vanished, if method.runs_in_kernel() { 3 } else { 0 }, "{}", method.name());
    }
}

#[test]
fn what_is_near_the_rest_vanishes_before_what_is_alone() {
    // Small balls of one size: one almost touches the large ball, the others are far off.
    let mut mesh = balls(&[0.1, 0.1, 0.1]);
    let of_ball = mesh.positions.len() / 4;
    for p in &mut mesh.positions[2 * of_ball..3 * of_ball] {
        p[0] -= 4.9;
    }
    for method in kernel_methods() {
        let mut simplifier =
            Simplifier::new(&mesh, &Options { method, ..Options::default() }).unwrap();
        let mut faces = mesh.faces.len();
        while simplifier.run(Target::Faces(faces), &mut ()).unwrap().vanished == 0 {
            faces -= 2;
        }
        let level = simplifier.level();
        assert_eq!(face_components(&level.faces, level.positions.len()).1, 3);
        let alone = level.positions.iter().filter(|p| p[0] > 2.0).count();
        assert!(alone >= 8);
    }
}

#[test]
fn it_vanishes_when_it_is_coarse() {
    let mesh = balls(&[0.1, 0.1]);
    for method in Method::ALL {
        let options = Options { method, vanish_below: Some(1.0), ..Options::default() };
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        let mut before = mesh.faces.len();
        while simplifier.step(f64::INFINITY, &mut ()) {
            let now = simplifier.live_faces();
            assert!(before - now <= 64, "{}: {} at once", method.name(), before - now);
            before = now;
        }
    }
}

#[test]
fn the_last_one_stays() {
    let mesh = balls(&[0.4, 0.3]);
    for method in Method::ALL {
        let options = Options { method, vanish_below: Some(1e9), ..Options::default() };
        let left = left(&mesh, &options, 0);
        assert!(left[0] >= 4 && left[1] + left[2] == 0, "{}: {left:?}", method.name());
    }
}

#[test]
fn what_a_lock_holds_stays() {
    let mesh = balls(&[0.1, 0.1]);
    let of_ball = mesh.positions.len() / 3;
    let mut of_vertex = vec![Lock::Free; mesh.positions.len()];
    of_vertex[of_ball + 7] = Lock::Locked;
    let locks = Locks { of_vertex, ties: Vec::new() };
    let options = Options { locks, vanish_below: Some(1.0), ..Options::default() };
    let (level, report) = run(&mesh, &options, Target::Faces(0));
    assert_eq!(report.vanished, 1);
    assert_eq!(face_components(&level.faces, level.positions.len()).1, 2);
}

#[test]
fn the_distance_from_the_rest_is_the_error() {
    // The small ball reaches from 1.9 to 2.1 beyond the surface of the large one.
    let mesh = balls(&[0.1]);
    for method in kernel_methods() {
        let options = Options { method, ..Options::default() };
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        let narrow = simplifier.run(Target::Error(2.0), &mut ()).unwrap();
        assert_eq!(narrow.vanished, 0);
        let wide = simplifier.run(Target::Error(2.4), &mut ()).unwrap();
        assert!(wide.vanished == 1 && (2.0..2.2).contains(&wide.error_estimate));
    }
}

#[test]
fn a_size_is_the_error_of_the_other_methods() {
    let mesh = balls(&[0.1]);
    let size = 0.1 * DIAGONAL;
    for method in Method::ALL.into_iter().filter(|method| !method.runs_in_kernel()) {
        let options = Options { method, vanish_below: Some(1.0), ..Options::default() };
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        let narrow = simplifier.run(Target::Error(0.9 * size), &mut ()).unwrap();
        assert_eq!(narrow.vanished, 0);
        let wide = simplifier.run(Target::Error(1.1 * size), &mut ()).unwrap();
        assert!(wide.vanished == 1 && wide.error_estimate > 0.9 * size);
    }
}

#[test]
fn a_million_pieces_of_one_face_take_linear_time() {
    // Far fewer here, but enough for anything quadratic to be felt.
    let side = 300;
    let mut mesh = Mesh::default();
    for i in 0..side * side {
        let (x, y) = ((i % side) as f64, (i / side) as f64);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([[x, y, 0.0], [x + 0.5, y, 0.0], [x, y + 0.5, 0.0]]);
        mesh.faces.push([0, 1, 2].map(|k| VertexId(first + k)));
    }
    let (_, report) = run(&mesh, &Options::default(), Target::Ratio(0.5));
    assert!(report.reached && report.vanished == side * side / 2);
}

#[test]
fn what_vanished_comes_back_to_the_bit() {
    // One of the small ones is open, and one so stubborn that many faces go at once.
    let mut mesh = balls(&[0.1, 0.2]);
    mesh.faces.pop();
    for method in Method::ALL {
        let options = Options { method, vanish_below: Some(1.0), ..Options::default() };
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        let mut history = History::default();
        let mut levels = vec![simplifier.level()];
        for ratio in [0.6, 0.3, 0.1, 0.0] {
            simplifier.run(Target::Ratio(ratio), &mut history).unwrap();
            levels.push(simplifier.level());
        }
        let bytes = Progressive::new(simplifier, history).unwrap().to_bytes();
        let mut progressive = Progressive::from_bytes(&bytes).unwrap();
        for level in levels.iter().rev() {
            progressive.go_to(level.faces.len());
            assert_eq!(&progressive.level(), level, "{}", method.name());
        }
    }
}

#[test]
fn the_report_counts_the_volume_that_vanished() {
    let mesh = balls(&[0.3]);
    for method in Method::ALL {
        let options = Options { method, vanish_below: Some(2.0), ..Options::default() };
        let (level, report) = run(&mesh, &options, Target::Faces(4));
        assert_eq!(report.vanished, 1);
        let lost = volume(&mesh) - volume(&level);
        // The kernel counts from positions in floats.
        let off = if method.runs_in_kernel() { 1e-6 } else { 1e-12 };
        let counted = report.volume.lost() + report.volume.vanished;
        assert!((counted - lost).abs() < off, "{}", method.name());
        assert!(report.volume.vanished > 0.0, "{}", method.name());
    }
}

/// Six times the volume of each component, in the order of their first faces.
fn volumes(mesh: &Mesh) -> Vec<f64> {
    let (of_face, count) = face_components(&mesh.faces, mesh.positions.len());
    let mut volumes = vec![0.0; count];
    for (face, of) in mesh.faces.iter().zip(of_face) {
        let [a, b, c] = face.map(|v| DVec3::from(mesh.positions[v.index()]));
        volumes[of as usize] += a.cross(b).dot(c);
    }
    volumes
}

#[test]
fn what_a_part_owes_is_repaid_by_that_part() {
    for seed in 1..=5 {
        let mesh = samples::parts(1000, seed);
        let options = Options { topology: Topology::Keep, ..Options::default() };
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        let mut loss = simplifier.run(Target::Ratio(0.1), &mut ()).unwrap().volume;
        let level = simplifier.settled_level(&mut loss);
        let (before, after) = (volumes(&mesh), volumes(&level));
        let rounding = 3e-7 * before.iter().sum::<f64>();
        assert!(loss.owed > 10.0 * rounding, "{seed}: a case without debts shows nothing");
        assert_eq!(before.len(), after.len());
        for (part, (before, after)) in before.iter().zip(&after).enumerate() {
            assert!((before - after).abs() < rounding, "{seed}, {part}: {before} to {after}");
        }
    }
}

#[test]
fn where_parts_are_at_their_floor_the_rest_does_not_pay_for_them() {
    // A large cube, and a row of small ones beside it.
    let mut mesh = Mesh::default();
    append(&mut mesh, &fixtures::cube(), |p| p.map(|x| 10.0 * x));
    let large = mesh.positions.clone();
    for i in 0..30 {
        let aside = 12.0 + f64::from(i);
        append(&mut mesh, &fixtures::cube(), |p| p.map(|x| 0.5 * x + aside));
    }
    for method in kernel_methods() {
        let options = Options { method, topology: Topology::Keep, ..Options::default() };
        let (level, report) = run(&mesh, &options, Target::Faces(125));
        assert!(!report.reached && report.refusals.count(Refusal::Disproportion) > 0);
        assert_eq!(level.faces.len(), 12 + 30 * 4, "{}", method.name());
        assert!(large.iter().all(|corner| level.positions.contains(corner)));
    }
}

#[test]
fn most_parts_at_their_floor_and_the_rest_far_off_is_near_the_limit() {
    let mut mesh = samples::sphere(400);
    mesh.positions.iter_mut().for_each(|p| *p = p.map(|x| 10.0 * x));
    for i in 0..20 {
        let aside = 12.0 + f64::from(i);
        append(&mut mesh, &fixtures::cube(), |p| p.map(|x| 0.5 * x + aside));
    }
    let options = Options { topology: Topology::Keep, ..Options::default() };
    let is_near = |faces: usize| {
        let (_, report) = run(&mesh, &options, Target::Faces(faces));
        assert!(report.reached, "{faces}");
        report.near_limit
    };
    assert_eq!([480, 200, 96].map(is_near), [false, false, true]);
}

#[test]
fn a_back_stays_with_its_front_where_only_fronts_are_seen() {
    let card = fixtures::grid(1);
    let mut mesh = Mesh::default();
    for i in 0..20 {
        let aside = [0.0, f64::from(i % 5), f64::from(i)];
        append(&mut mesh, &card, |p| [p[0], p[1] + aside[1], p[2] + aside[2]]);
        let backs: Vec<[VertexId; 3]> =
            mesh.faces.iter().rev().take(2).map(|&[a, b, c]| [c, b, a]).collect();
        mesh.faces.extend(backs);
    }
    for method in kernel_methods() {
        let sides = |single_sided: bool| {
            let options = Options { method, single_sided, ..Options::default() };
            let (level, _) = run(&mesh, &options, Target::Ratio(0.5));
            let up = |face: &&[VertexId; 3]| {
                let [a, b, c] = face.map(|v| DVec3::from(level.positions[v.index()]));
                (b - a).cross(c - a).z > 0.0
            };
            [level.faces.len(), level.faces.iter().filter(up).count()]
        };
        assert_eq!(sides(true), [40, 20], "{}", method.name());
        // One coat of each is as near as both.
        let [all, _] = sides(false);
        assert_eq!(all, 40);
    }
}

/// A square, and over it a smaller sheet with `n` × `n` holes, which hold its faces.
fn sheet_over_square(n: u32, height: f64) -> Mesh {
    let mut mesh = fixtures::grid(1);
    mesh.positions.iter_mut().for_each(|p| *p = [3.0 * p[0] - 1.0, 3.0 * p[1] - 1.0, 0.0]);
    let side = 4 * n + 1;
    let mut sheet = fixtures::grid(side);
    let is_hole = |quad: u32| quad % side % 4 == 2 && quad / side % 4 == 2;
    let mut quads = (0..).map(|face| face / 2);
    sheet.faces.retain(|_| !is_hole(quads.next().unwrap()));
    append(&mut mesh, &sheet, |p| [p[0] / f64::from(side), p[1] / f64::from(side), height]);
    mesh
}

#[test]
fn most_of_what_is_left_vanishes_only_where_it_is_not_missed() {
    for (method, n) in kernel_methods().zip([8, 40]) {
        let options = Options { method, ..Options::default() };
        let far = sheet_over_square(n, 0.5);
        let holes = (n * n) as usize;
        let mut simplifier = Simplifier::new(&far, &options).unwrap();
        let mut last = 0;
        for faces in [8 * holes, 100, 3] {
            let report = simplifier.run(Target::Faces(faces), &mut ()).unwrap();
            let (level, fresh) = run(&far, &options, Target::Faces(faces));
            assert_eq!(simplifier.level(), level, "{}", method.name());
            assert_eq!((report.reached, fresh.reached), (faces > 100, faces > 100));
            last = level.faces.len();
        }
        assert!(last > 2 * holes, "{last} faces of {holes} holes");
        let near = sheet_over_square(n, 1e-4);
        assert_eq!(run(&near, &options, Target::Faces(3)).0.faces.len(), 2);
        assert_eq!(run(&near, &options, Target::Error(0.01)).0.faces.len(), 2);
    }
}

#[test]
fn faces_that_are_left_out_join_nothing() {
    // A face that repeats a vertex names both cubes, and belongs to neither.
    let mut mesh = fixtures::cube();
    let count = mesh.positions.len() as u32;
    let second = fixtures::cube();
    mesh.positions.extend(second.positions.iter().map(|p| p.map(|x| 0.1 * x + 9.0)));
    mesh.faces.extend(second.faces.iter().map(|face| face.map(|v| VertexId(v.0 + count))));
    mesh.faces.push([VertexId(0), VertexId(0), VertexId(count)]);
    let options = Options { vanish_below: Some(1.0), ..Options::default() };
    let (level, report) = run(&mesh, &options, Target::Faces(0));
    assert_eq!((report.vanished, report.degenerate_faces), (1, 1));
    let far: HashSet<_> = level.positions.iter().map(|p| p[0] > 5.0).collect();
    assert_eq!(far, HashSet::from([false]));
}

#[test]
fn a_hub_that_vanishes_takes_its_own_faces() {
    // Its apex has a long ring, in a list that contractions do not keep up.
    for faces in [60, 200, 1000] {
        let mut mesh = fixtures::cone(faces);
        let below = 1.01 * mesh.bounds().diagonal();
        let count = mesh.positions.len() as u32;
        let ball = samples::sphere(500);
        let far = 10.0 * below;
        mesh.positions.extend(ball.positions.iter().map(|p| p.map(|x| 3.0 * below * x + far)));
        mesh.faces.extend(ball.faces.iter().map(|face| face.map(|v| VertexId(v.0 + count))));
        mesh.attributes = None;
        for method in [Method::LindstromTurk, Method::Qem] {
            let options = Options { method, vanish_below: Some(below), ..Options::default() };
            let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
            for left in [450, 300, 100, 8] {
                let report = simplifier.run(Target::Faces(left), &mut ()).unwrap();
                assert_eq!(simplifier.level().faces.len(), report.output_faces);
            }
        }
    }
}

#[test]
fn what_is_no_size_is_refused() {
    for size in [-1.0, f64::NAN] {
        let options = Options { vanish_below: Some(size), ..Options::default() };
        let refused = contract_to(&balls(&[]), Target::Ratio(0.5), &options);
        assert!(matches!(refused, Err(SimplifyError::BadSize(_))));
    }
}
