//! Exact positions survive every way of reading and querying a model.

use std::collections::BTreeSet;

use glam::DVec3;
use meshlod_fixtures as fixtures;
use meshlod_mesh::{Connectivity, Lock, Locks, Mesh, VertexId};
use meshlod_samples as samples;
use meshlod_simplify::{Method, Options};

use super::{Dice, in_order, query, small};
use crate::{Archive, Cut, Explicit, Focus, Forest, Implicit, Level, Model, Query, Storage};

/// Meshes with positions that no `f32` represents: far away, huge, tiny and subnormal.
fn meshes() -> Vec<(&'static str, Mesh)> {
    let far = |x: f64, k: usize| [431_234.1, 5_412_345.7, 0.3][k] + 123.4567 * x;
    // Negative zeros and subnormal numbers.
    let fine = |x: f64, k: usize| match (k, x) {
        (2, _) if x.abs() < 0.1 => -0.0 * x,
        (0, _) if x.abs() < 0.1 => x * 1e-310,
        _ => x,
    };
    vec![
        ("torus, far away", placed(samples::torus(700), far)),
        ("terrain, far away", placed(samples::terrain(500), far)),
        ("knot, with zeros", placed(samples::knot(800), fine)),
        ("gyroid, large", placed(samples::gyroid(700), |x, _| x * 1.7e20)),
        ("sphere, small", placed(samples::sphere(600), |x, _| x * 1.7e-20)),
        ("grid", fixtures::grid(9)),
        ("tetrahedron", placed(fixtures::tetrahedron(), |x, _| x / 3.0)),
        ("hourglass", placed(fixtures::hourglass(), |x, _| x / 3.0)),
        ("two objects", placed(fixtures::two_objects(), |x, _| x / 3.0)),
        ("moebius", placed(fixtures::moebius(9), |x, _| x / 3.0)),
    ]
}

fn placed(mut mesh: Mesh, place: impl Fn(f64, usize) -> f64) -> Mesh {
    for position in &mut mesh.positions {
        *position = std::array::from_fn(|k| place(position[k], k));
    }
    mesh
}

fn each(mut check: impl FnMut(&str, &Mesh, &Forest, &Archive<Vec<u8>>)) {
    for (name, mesh) in meshes() {
        for method in [Method::Qem, Method::LeeJang] {
            let options = Options { method, ..Options::default() };
            let forest = Forest::lossless(&mesh, &options).unwrap();
            let archive = Archive::write(&forest, &small()).unwrap().0;
            check(&format!("{name} by {}", method.name()), &mesh, &forest, &archive);
        }
    }
}

type Bits = [u64; 3];

fn bits(position: [f64; 3]) -> Bits {
    position.map(f64::to_bits)
}

/// Faces by the bits of their corners' positions.
fn by_bits(mesh: &Mesh) -> Vec<[Bits; 3]> {
    let corners = |face: &[VertexId; 3]| face.map(|v| mesh.positions[v.index()]);
    in_order(mesh.faces.iter().map(|face| corners(face).map(bits)))
}

#[test]
fn the_finest_level_is_the_input() {
    let mut narrow_ones = 0;
    each(|what, mesh, forest, archive| {
        assert!(archive.is_lossless(), "{what}");
        let input = by_bits(mesh);
        let is_input = |level: &Level| by_bits(&level.mesh()) == input;
        let (all, most) = (Query::uniform(0.0), usize::MAX);
        assert!(is_input(&archive.extract(&all).unwrap().level), "{what}: extracted");
        assert!(is_input(&archive.extract_at_most(most, &all).unwrap().level), "{what}: so many");
        let read = archive.read().unwrap().0;
        let cut = Cut::at(&read, &all).unwrap();
        assert!(is_input(&cut.level()), "{what}: cut");
        let within = cut.level().within(&Focus::Everything).unwrap();
        assert!(is_input(&within), "{what}: within");
        assert!(is_input(&cut.level_within(&Focus::Everything).unwrap()), "{what}: cut within");
        // Some models have a vertex too far out for that.
        if let Some(narrow) = read.compacted() {
            assert!(is_input(&Cut::at(&narrow, &all).unwrap().level()), "{what}: narrow");
            narrow_ones += 1;
        }
        let model = Model::from_implicit(&read).unwrap();
        let mut extractor = model.extractor();
        assert!(is_input(extractor.uniform(0.0).unwrap()), "{what}: uniform");
        assert!(is_input(extractor.exact(&all).unwrap()), "{what}: exact");
        assert!(is_input(extractor.at_most(most, &all).unwrap()), "{what}: at most");
        let lattice = super::lattice(forest, &small(), super::diagonal(forest));
        let kept = forest.clone().quantized(lattice, super::StoredErrors::AsRecorded);
        let explicit = Explicit::new(&kept.forest);
        assert!(is_input(&explicit.extract(&all).unwrap()), "{what}: explicit");
        let mut bounded = forest.clone();
        bounded.measure_bounds();
        for forest in [forest, &bounded] {
            let model = Model::new(forest).unwrap();
            assert!(is_input(model.extractor().uniform(0.0).unwrap()), "{what}: in memory");
            let cut = Cut::at(model.implicit(), &all).unwrap();
            assert!(is_input(&cut.level()), "{what}: cut in memory");
            assert!(is_input(&Explicit::new(forest).extract(&all).unwrap()), "{what}: triangles");
        }
    });
    assert!(narrow_ones > meshes().len(), "{narrow_ones}");
}

#[test]
fn what_is_left_of_the_input_in_a_level_is_as_it_was() {
    let (mut of_input, mut others) = (0, 0);
    each(|what, mesh, _, archive| {
        let input: BTreeSet<Bits> = mesh.positions.iter().map(|&p| bits(p)).collect();
        let model = archive.read().unwrap().0;
        let mut check = |model: &Implicit, level: &Level| {
            for (&node, position) in level.nodes.iter().zip(level.mesh().positions) {
                assert_eq!(bits(model.position(node)), bits(position), "{what}");
                let is_leaf = model.update_of(node).is_none();
                *(if is_leaf { &mut of_input } else { &mut others }) += 1;
                assert!(!is_leaf || input.contains(&bits(position)), "{what}");
            }
        };
        let mut dice = Dice(3);
        for _ in 0..6 {
            let query = query(&mut dice, mesh);
            let whole = Cut::at(&model, &query).unwrap().level();
            check(&model, &whole);
            check(&model, &whole.within(&query.focus).unwrap());
            let part = archive.extract(&query).unwrap().level;
            assert_eq!(by_bits(&part.mesh()), by_bits(&whole.mesh()), "{what}: {query:?}");
        }
    });
    assert!(of_input > 1000 && others > 1000, "{of_input}, {others}");
}

#[test]
fn every_start_of_a_lossless_file_is_a_cut() {
    each(|what, mesh, _, archive| {
        let input: BTreeSet<Bits> = mesh.positions.iter().map(|&p| bits(p)).collect();
        let mut most = 0;
        for chunks in 0..=archive.chunk_count() {
            let model = Model::from_implicit(&archive.read_chunks(chunks).unwrap().0).unwrap();
            assert!(model.implicit().exact().is_lossless(), "{what}, {chunks} chunks");
            let mut extractor = model.extractor();
            let level = extractor.uniform(0.0).unwrap();
            let places = level.nodes.iter().zip(level.mesh().positions);
            let exact = places.filter(|(node, _)| model.implicit().exact().get(**node).is_some());
            let exact: Vec<_> = exact.map(|(_, place)| bits(place)).collect();
            assert!(exact.iter().all(|place| input.contains(place)), "{what}");
            assert!(exact.len() >= most, "{what}");
            most = exact.len();
        }
        assert_eq!(most, mesh.positions.len(), "{what}");
    });
}

/// A point query at a vertex of the input finds its faces, although stored positions are rounded.
#[test]
fn a_vertex_is_found_where_it_is() {
    each(|what, mesh, forest, archive| {
        let read = archive.read().unwrap().0;
        let models = [("read", &read), ("in memory", &Implicit::new(forest).unwrap())];
        let all = by_bits(mesh);
        let mut dice = Dice(31);
        for _ in 0..12 {
            let vertex = dice.place(mesh);
            let focus = Focus::Point(vertex);
            let query = Query { focus: focus.clone(), ..Query::uniform(0.0) };
            let here = all.iter().filter(|face| face.contains(&bits(vertex)));
            let has_all = |level: &Level| {
                let found = by_bits(&level.mesh());
                here.clone().all(|face| found.contains(face))
            };
            let part = archive.extract(&query).unwrap().level;
            assert!(has_all(&part.within(&focus).unwrap()), "{what}: {vertex:?} read in part");
            for (way, model) in models {
                let cut = Cut::at(model, &query).unwrap();
                assert!(has_all(&cut.level_within(&focus).unwrap()), "{what}: {vertex:?} {way}");
                let found = cut.locate(vertex).unwrap();
                // Conversion from stored units may lose the last bits.
                assert!(found.distance <= 1e-15 * mesh.bounds().diagonal(), "{what}: {found:?}");
            }
        }
    });
}

/// Otherwise a point query at a vertex would not reach it. At this size, rounding to single
/// precision moves vertices by as much as the balls have slack.
#[test]
fn balls_are_around_vertices_where_they_are() {
    let mut mesh = placed(samples::sphere(2000), |x, k| 0.3 + 1e-4 * x * [1.0, 0.9, 1.1][k]);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([[-0.5; 3], [0.5, -0.5, -0.5], [-0.5, 0.5, -0.5]]);
    mesh.faces.push([0, 1, 2].map(|k| VertexId(first + k)));
    let forest = Forest::lossless(&mesh, &Options::default()).unwrap();
    let lattice = super::lattice(&forest, &small(), super::diagonal(&forest));
    let kept = forest.clone().quantized(lattice, super::StoredErrors::AsRecorded);
    for (way, forest) in [("in memory", &forest), ("in a file", &kept.forest)] {
        for u in 0..forest.update_count() {
            let ball = forest.ball(u);
            for &node in forest.ring(u).iter().chain(&forest.updates[u].children) {
                let apart = ball.center.distance(forest.exact_stored(node));
                assert!(apart <= ball.radius, "{way}: update {u}, node {node}");
            }
        }
    }
}

/// A level identifies each vertex by its node, in whatever order.
#[test]
fn vertices_of_a_level_can_change_places() {
    each(|what, mesh, _, archive| {
        let level = archive.extract(&Query::uniform(0.0)).unwrap().level;
        let mut turned = level.clone();
        let last = level.nodes.len() as u32 - 1;
        turned.nodes.reverse();
        turned.positions.reverse();
        turned.faces.iter_mut().flatten().for_each(|v| *v = last - *v);
        assert_eq!(by_bits(&turned.mesh()), by_bits(mesh), "{what}");
    });
}

#[test]
fn what_is_not_of_the_input_moves_as_little_as_asked() {
    let mesh = samples::torus(800);
    let forest = Forest::lossless(&mesh, &Options::default()).unwrap();
    for rounding in [1e-2, 1e-5] {
        let storage = Storage { rounding: Some(rounding), ..small() };
        let archive = Archive::write(&forest, &storage).unwrap().0;
        assert!(archive.is_lossless());
        assert!(archive.rounding() <= rounding && archive.rounding() > 0.3 * rounding);
    }
}

/// On a lattice so coarse that the vertices replacing the input's would coincide.
#[test]
fn no_triangle_beside_the_input_loses_its_area() {
    let mesh = samples::knot(4000);
    let forest = Forest::lossless(&mesh, &Options::default()).unwrap();
    for part in [1e-2, 2e-2] {
        let storage = Storage { rounding: Some(part * mesh.bounds().diagonal()), ..small() };
        let archive = Archive::write(&forest, &storage).unwrap().0;
        let model = archive.read().unwrap().0;
        model.each_triangle(|nodes| {
            let [a, b, c] = nodes.map(|n| glam::DVec3::from(model.position(n)));
            assert!((b - a).cross(c - a).length_squared() > 0.0, "{part}: {nodes:?}");
        });
    }
}

#[test]
fn a_lossless_file_that_is_damaged_is_refused() {
    let mesh = placed(fixtures::grid(6), |x, _| x / 3.0);
    let forest = Forest::lossless(&mesh, &Options::default()).unwrap();
    let bytes = Archive::write(&forest, &small()).unwrap().0.into_source();
    let mut dice = Dice(29);
    let (mut refused, mut passed) = (0, 0);
    for at in 0..bytes.len() {
        let mut wrong = bytes.clone();
        wrong[at] ^= 1 << (at % 8);
        let open = |bytes| Archive::open(bytes).and_then(|archive| archive.read());
        assert!(open(wrong.clone()).is_err(), "a change of byte {at} is not detected");
        Archive::rewrite_checksums(&mut wrong);
        match Archive::open(wrong).and_then(|archive| {
            archive.extract(&query(&mut dice, &mesh))?;
            archive.read()
        }) {
            Ok((model, _)) => {
                passed += 1;
                let finest = Cut::at(&model, &Query::uniform(0.0)).unwrap().level().mesh();
                assert!(finest.positions.iter().flatten().all(|x| x.is_finite()));
            }
            Err(_) => refused += 1,
        }
    }
    assert!(refused > 100 && passed > 20, "{refused} refused, {passed} passed");
}

/// Tiles of a terrain that are coarsened apart fit together where their borders are locked.
#[test]
fn locked_vertices_are_in_every_cut() {
    let mesh = placed(samples::terrain(800), |x, k| [431_234.1, 5_412_345.7, 0.3][k] + x / 3.0);
    let border = Connectivity::new(&mesh.faces, mesh.positions.len());
    let is_border = |v: usize| border.marks(VertexId::new(v)).boundary();
    let locked: Vec<usize> = (0..mesh.positions.len()).filter(|&v| is_border(v)).collect();
    // One vertex inside is locked, two are tied and so locked here.
    let inside: Vec<usize> = (0..mesh.positions.len()).filter(|&v| !is_border(v)).collect();
    let mut of_vertex = vec![Lock::Free; mesh.positions.len()];
    of_vertex[inside[3]] = Lock::Locked;
    let locks = Locks { of_vertex, ties: vec![vec![VertexId::new(inside[40])]] };
    let held: Vec<[f64; 3]> =
        locked.iter().chain([&inside[3], &inside[40]]).map(|&v| mesh.positions[v]).collect();
    for method in [Method::LindstromTurk, Method::Qem, Method::LeeJang, Method::QemEndpoint] {
        let options =
            Options { method, lock_boundary: true, locks: locks.clone(), ..Options::default() };
        let lossless = Forest::lossless(&mesh, &options).unwrap();
        let rounded = Forest::new(&mesh, &options).unwrap();
        for (forest, storage) in [(lossless, small()), (rounded, Storage::default())] {
            let archive = Archive::write(&forest, &storage).unwrap().0;
            // Rounding is stated for the recorded positions, which are single precision.
            let most = if archive.is_lossless() { 0.0 } else { 1.001 * archive.rounding() };
            let model = archive.read().unwrap().0;
            for i in 0..12 {
                let error = if i == 0 { f64::MAX } else { 0.2 * f64::from(i) };
                let level = Cut::at(&model, &Query::uniform(error)).unwrap().level().mesh();
                let far = |p: &[f64; 3]| {
                    let to = |q: &[f64; 3]| DVec3::from(*p).distance(DVec3::from(*q));
                    level.positions.iter().map(to).fold(f64::INFINITY, f64::min)
                };
                let worst = held.iter().map(far).fold(0.0, f64::max);
                assert!(worst <= most, "{}, {error}: {worst} of {most}", method.name());
                assert!(i > 0 || level.faces.len() < mesh.faces.len() / 2);
            }
        }
    }
}
