//! The kernel on meshes of several parts: any number of threads, any order of the file.

mod common;

use std::collections::HashSet;
use std::sync::LazyLock;

use glam::DVec3;
use meshlod_fixtures as fixtures;
use meshlod_fixtures::shape::{bare, topology};
use meshlod_fixtures::{charted, in_materials};
use meshlod_mesh::{FaceId, Layer, LayerKind, Lock, Locks, Mesh, VertexId};
use meshlod_samples as samples;
use meshlod_simplify::{
    History, Method, Options, Report, Simplifier, Target, VolumeLoss, contract_to,
};

use crate::common::kernel_methods;

fn options(method: Method) -> Options {
    Options { method, ..Options::default() }
}

fn run_with(threads: usize, mesh: &Mesh, target: Target, options: &Options) -> (Mesh, Report) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| contract_to(mesh, target, options).unwrap())
}

fn run(method: Method, mesh: &Mesh, target: Target) -> (Mesh, Report) {
    run_with(2, mesh, target, &options(method))
}

/// Meshes of several partitions, with boundaries, with flats, in pieces, and non-manifold; with uvs in
/// charts, with normals, and with materials.
static LARGE: LazyLock<[(&str, Mesh); 8]> = LazyLock::new(|| {
    let terrain = bare(samples::terrain(120_000));
    [
        ("torus", samples::torus(120_000)),
        ("terrain", terrain),
        ("flat", fixtures::grid(240)),
        ("pieces", pieces(&samples::sphere(60), 2_000)),
        ("crossing", crossing(&fixtures::grid(200))),
        ("charts", with_normals(charted(&samples::torus(120_000)))),
        ("crossing charts", charted(&crossing(&fixtures::grid(200)))),
        ("materials", in_materials(&samples::terrain(120_000))),
    ]
});

/// Adds a normal to each wedge of a mesh with uvs: the mean of those of its faces.
fn with_normals(mut mesh: Mesh) -> Mesh {
    let faces: Vec<_> = mesh.faces.iter().map(|&face| mesh.triangle(face)).collect();
    if let Some(all) = &mut mesh.attributes {
        let mut sums = vec![DVec3::ZERO; all.wedge_count];
        for ([a, b, c], corners) in faces.into_iter().zip(&all.corners) {
            corners.iter().for_each(|w| sums[w.index()] += (b - a).cross(c - a));
        }
        let values = sums.iter().flat_map(|sum| sum.normalize().as_vec3().to_array()).collect();
        let kind = LayerKind::Normal;
        all.layers.push(Layer { kind, name: String::new(), width: 3, values });
    }
    mesh
}

/// Places copies of a mesh side by side.
fn pieces(of: &Mesh, count: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..count {
        let first = mesh.positions.len() as u32;
        let shift = [3.0 * f64::from(i % 50), 3.0 * f64::from(i / 50), 0.0];
        let moved = |p: &[f64; 3]| [p[0] + shift[0], p[1] + shift[1], p[2] + shift[2]];
        mesh.positions.extend(of.positions.iter().map(moved));
        mesh.faces.extend(of.faces.iter().map(|face| face.map(|v| VertexId(v.0 + first))));
    }
    mesh
}

/// Two squares that cross: the middle column of vertices is in both.
fn crossing(square: &Mesh) -> Mesh {
    let middle = square.bounds().center()[0];
    let mut mesh = square.clone();
    let ids: Vec<VertexId> = square
        .positions
        .iter()
        .enumerate()
        .map(|(v, &[x, y, _])| {
            if x == middle {
                return VertexId::new(v);
            }
            mesh.positions.push([middle, y, x - middle]);
            VertexId::new(mesh.positions.len() - 1)
        })
        .collect();
    mesh.faces.extend(square.faces.iter().map(|face| face.map(|v| ids[v.index()])));
    mesh
}

/// Shuffles the vertices and faces of a mesh.
fn scrambled(mesh: &Mesh) -> Mesh {
    let places = shuffled(mesh.positions.len());
    let mut positions = vec![[0.0; 3]; places.len()];
    for (&place, &position) in places.iter().zip(&mesh.positions) {
        positions[place as usize] = position;
    }
    let moved = |&f: &u32| mesh.faces[f as usize].map(|v| VertexId(places[v.index()]));
    Mesh::new(positions, shuffled(mesh.faces.len()).iter().map(moved).collect())
}

fn shuffled(count: usize) -> Vec<u32> {
    let mut all: Vec<u32> = (0..count as u32).collect();
    let mut state = 1u64;
    for i in (1..count).rev() {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        all.swap(i, (state >> 33) as usize % (i + 1));
    }
    all
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    for method in kernel_methods() {
        for (name, mesh) in &*LARGE {
            let bound = Target::Error(0.005 * mesh.bounds().diagonal());
            for target in [Target::Ratio(0.03), bound] {
                let [one, three] =
                    [1, 3].map(|threads| run_with(threads, mesh, target, &options(method)));
                assert!(one == three, "{name} {target:?}");
            }
        }
    }
}

#[test]
fn targets_are_met_to_the_face_and_topology_is_kept() {
    for method in kernel_methods() {
        for (name, mesh) in &*LARGE {
            let before = topology(mesh);
            for faces in [mesh.faces.len() - 1, mesh.faces.len() / 3 + 1] {
                let (level, report) = run(method, mesh, Target::Faces(faces));
                assert!(report.reached, "{name} {faces}");
                assert!((faces - 1..=faces).contains(&level.faces.len()), "{name} {faces}");
                assert_eq!(level.faces.len(), report.output_faces);
                let after = topology(&level);
                assert_eq!(after.euler, before.euler, "{name} {faces}");
                assert_eq!(after.inconsistent_edges, before.inconsistent_edges, "{name} {faces}");
                let non_manifold = [&before, &after].map(|counts| counts.non_manifold_edges);
                assert!(non_manifold[1] <= non_manifold[0], "{name} {faces}");
            }
        }
    }
}

#[test]
fn observers_see_the_same_level() {
    for method in kernel_methods() {
        for (name, mesh) in &*LARGE {
            let (level, _) = run(method, mesh, Target::Ratio(0.05));
            let mut simplifier = Simplifier::new(mesh, &options(method)).unwrap();
            let mut history = History::default();
            simplifier.run(Target::Ratio(0.05), &mut history).unwrap();
            assert!(simplifier.settled_level(&mut VolumeLoss::default()) == level, "{name}");
            let died = (0..history.contractions().len())
                .map(|i| history.removed_faces(i).len())
                .sum::<usize>();
            assert_eq!(mesh.faces.len() - level.faces.len(), died, "{name}");
            let surface = simplifier.surface();
            assert_eq!(surface.live_faces(), level.faces.len(), "{name}");
            let left =
                (0..mesh.faces.len()).map(FaceId::new).filter(|&face| surface.is_alive(face));
            let Some(all) = &level.attributes else { continue };
            for (face, corners) in left.zip(&all.corners) {
                let shown = surface.wedges(face).expect("the level has attributes");
                for (layer, of_level) in surface.layers().iter().zip(&all.layers) {
                    let values = shown.map(|w| layer.of(w)).concat();
                    assert_eq!(values, corners.map(|w| of_level.of(w)).concat(), "{name} {face}");
                }
            }
        }
    }
}

#[test]
fn targets_of_a_few_faces_end() {
    for method in kernel_methods() {
        for (name, mesh) in &*LARGE {
            for faces in [0, 4] {
                let (level, report) = run(method, mesh, Target::Faces(faces));
                assert_eq!(report.reached, level.faces.len() <= faces, "{name}");
                assert!(!level.faces.is_empty(), "{name}");
                assert!(level.faces.len() < mesh.faces.len() / 10, "{name}: {}", level.faces.len());
            }
        }
    }
}

#[test]
fn a_file_in_no_order_is_simplified_as_well() {
    for method in kernel_methods() {
        for mesh in [samples::knot(80_000), samples::torus(80_000)] {
            let other = scrambled(&mesh);
            let [(level, first), (_, second)] =
                [&mesh, &other].map(|mesh| run(method, mesh, Target::Ratio(0.05)));
            assert_eq!(first.output_faces, second.output_faces);
            assert!((first.error_estimate / second.error_estimate).ln().abs() < 0.2);
            // The level keeps the vertex order of its file, as locked or untouched vertices show.
            let (kept, _) = run(method, &other, Target::Faces(other.faces.len() - 2));
            let left: HashSet<_> = kept.positions.iter().map(|p| p.map(f64::to_bits)).collect();
            let untouched = |p: &&[f64; 3]| left.contains(&p.map(f64::to_bits));
            let expected = other.positions.iter().filter(untouched);
            let of_input: HashSet<_> =
                other.positions.iter().map(|p| p.map(f64::to_bits)).collect();
            let found = kept.positions.iter().filter(|p| of_input.contains(&p.map(f64::to_bits)));
            assert!(found.eq(expected));
            assert!(level.validate().is_ok());
        }
    }
}

#[test]
fn locks_hold_across_parts() {
    for method in kernel_methods() {
        let mesh = samples::torus(100_000);
        let every_fifth = |v: usize| if v.is_multiple_of(5) { Lock::Locked } else { Lock::Free };
        let of_vertex = (0..mesh.positions.len()).map(every_fifth).collect();
        let options = Options { locks: Locks { of_vertex, ties: Vec::new() }, ..options(method) };
        let (level, report) = run_with(2, &mesh, Target::Ratio(0.0), &options);
        let left: HashSet<_> = level.positions.iter().map(|p| p.map(f64::to_bits)).collect();
        let kept = |v: usize| left.contains(&mesh.positions[v].map(f64::to_bits));
        assert!((0..mesh.positions.len()).step_by(5).all(kept));
        assert_eq!(report.held.locked, mesh.positions.len().div_ceil(5));
    }
}

#[test]
fn a_bound_of_the_error_holds_across_parts() {
    for method in kernel_methods() {
        let mesh = samples::torus(100_000);
        let (level, report) = run(method, &mesh, Target::Error(1e-3));
        assert!(report.error_estimate <= 1e-3 && level.faces.len() < mesh.faces.len() / 4);
    }
}

#[test]
fn a_stray_vertex_far_off_and_one_place_for_all_end() {
    for method in kernel_methods() {
        let mut mesh = samples::torus(60_000);
        mesh.positions.push([1e300, -1e300, 1e300]);
        let (level, report) = run(method, &mesh, Target::Ratio(0.1));
        assert!(report.reached && level.bounds().diagonal() < 10.0);
        mesh.positions.fill([7.0; 3]);
        let (_, report) = run(method, &mesh, Target::Ratio(0.1));
        assert!(report.output_faces <= mesh.faces.len());
    }
}
