//! The kernel against the policy engine, its oracle, and on meshes made to break it.

use std::collections::HashSet;

use meshlod_fixtures as fixtures;
use meshlod_mesh::{Connectivity, FaceId, Lock, Locks, Mesh, VertexId, face_components};
use meshlod_samples as samples;
use meshlod_simplify::{
    History, Method, Observe, Options, Report, Simplifier, SimplifyError, Target, Topology,
    contract_to,
};
use meshlod_spatial::Bvh;

/// Methods that the kernel runs.
const KERNEL_METHODS: [Method; 2] = [Method::LindstromTurk, Method::Qem];

fn options(method: Method) -> Options {
    Options { method, ..Options::default() }
}

fn run(method: Method, mesh: &Mesh, target: Target) -> (Mesh, Report) {
    let mut mesh = mesh.clone();
    mesh.attributes = None;
    contract_to(&mesh, target, &options(method)).unwrap()
}

fn meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("tetrahedron", fixtures::tetrahedron()),
        ("cube", fixtures::cube()),
        ("grid", fixtures::grid(12)),
        ("fan", fixtures::fan()),
        ("hourglass", fixtures::hourglass()),
        ("moebius", fixtures::moebius(40)),
        ("seam strip", fixtures::seam_strip()),
        ("two objects", fixtures::two_objects()),
        ("sphere", samples::sphere(2000)),
        ("torus", samples::torus(2000)),
        ("knot", samples::knot(3000)),
        ("gyroid", samples::gyroid(3000)),
        ("terrain", samples::terrain(2000)),
        ("fish", samples::fish(2000)),
        ("three pages", pages(3)),
        ("five pages", pages(5)),
    ]
}

/// Terrains that all share one edge line, with `n` faces on each of its edges.
fn pages(n: usize) -> Mesh {
    let page = fixtures::grid(8);
    let spine = |v: usize| page.positions[v][0] == 0.0;
    let mut mesh = Mesh::default();
    let mut of_spine = vec![None; page.positions.len()];
    for p in 0..n {
        let (sin, cos) = (p as f64 / n as f64 * 6.0).sin_cos();
        let ids: Vec<VertexId> = (0..page.positions.len())
            .map(|v| match of_spine[v] {
                Some(id) => id,
                None => {
                    let [x, y, _] = page.positions[v];
                    mesh.positions.push([x * cos, y, x * sin]);
                    let id = VertexId::new(mesh.positions.len() - 1);
                    of_spine[v] = spine(v).then_some(id);
                    id
                }
            })
            .collect();
        mesh.faces.extend(page.faces.iter().map(|face| face.map(|v| ids[v.index()])));
    }
    mesh
}

/// Components, Euler number, closedness, non-manifold and inconsistent edges.
fn topology(mesh: &Mesh) -> (usize, i64, bool, usize, usize) {
    let c = Connectivity::new(&mesh.faces, mesh.positions.len());
    let used = mesh.used_vertices().iter().filter(|&&used| used).count();
    let euler = used as i64 - c.edge_count() as i64 + mesh.faces.len() as i64;
    let components = face_components(&mesh.faces, mesh.positions.len()).1;
    (components, euler, c.is_closed(), c.non_manifold_edges(), c.inconsistent_edges())
}

fn check_level(what: &str, level: &Mesh, report: &Report) {
    level.validate().unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(level.faces.len(), report.output_faces, "{what}");
    assert!(level.used_vertices().iter().all(|&used| used), "{what}");
    let mut seen = HashSet::new();
    for face in &level.faces {
        let [a, b, c] = *face;
        assert!(a != b && b != c && c != a, "{what}: {face:?}");
        // The two sides of a thin sheet are two faces.
        let turned = [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
        assert!(seen.insert(turned), "{what}: {face:?} stands twice");
    }
}

#[test]
fn a_level_is_valid_and_as_closed_manifold_and_oriented_as_its_mesh() {
    for method in KERNEL_METHODS {
        for (name, mesh) in meshes() {
            for ratio in [0.5, 0.1, 0.0] {
                let what = format!("{name} to {ratio}");
                let keep = Options { topology: Topology::Keep, ..options(method) };
                let (level, report) = contract_to(&mesh, Target::Ratio(ratio), &keep).unwrap();
                check_level(&what, &level, &report);
                assert_eq!(topology(&level), topology(&mesh), "{what}");
            }
        }
    }
}

#[test]
fn targets_of_a_few_faces_are_met_or_refused_in_words() {
    for method in KERNEL_METHODS {
        for (name, mesh) in meshes() {
            for faces in [0, 1, 4] {
                let (level, report) = run(method, &mesh, Target::Faces(faces));
                let refused = report.refusals.iter().map(|(_, count)| count).sum::<u64>();
                assert!(
                    report.reached || refused > 0 || mesh.faces.len() <= 4,
                    "{name}: {report:?}"
                );
                assert!(!level.faces.is_empty(), "{name}");
            }
        }
    }
}

#[test]
fn smooth_samples_reach_their_target() {
    for method in KERNEL_METHODS {
        for mesh in [samples::sphere(2000), samples::torus(2000), samples::knot(3000)] {
            let (level, report) = run(method, &mesh, Target::Ratio(0.05));
            let target = mesh.faces.len() / 20;
            assert!(report.reached && (target - 1..=target).contains(&level.faces.len()));
        }
    }
}

#[test]
fn a_flat_stays_one_and_grows_no_hubs() {
    for method in KERNEL_METHODS {
        let mesh = fixtures::grid(200);
        let (level, report) = run(method, &mesh, Target::Ratio(0.02));
        assert!(report.reached, "{report:?}");
        let connectivity = Connectivity::new(&level.faces, level.positions.len());
        let valence = |v| connectivity.star(VertexId::new(v)).len();
        assert!((0..level.positions.len()).map(valence).max().unwrap() < 40);
        let z = mesh.positions[0][2];
        assert!(level.positions.iter().all(|p| (p[2] - z).abs() < 1e-4));
    }
}

#[test]
fn a_hub_shrinks_with_its_rim() {
    for method in KERNEL_METHODS {
        let (level, report) = run(method, &fixtures::cone(100_000), Target::Faces(100));
        assert!(report.reached, "{report:?}");
        check_level("cone", &level, &report);
        assert!((level.bounds().max[2] - 0.5).abs() < 0.05, "the tip is gone");
    }
}

#[test]
fn faces_given_twice_are_left_out() {
    for method in KERNEL_METHODS {
        let mut mesh = fixtures::cone(2_000);
        mesh.faces.extend_from_within(..);
        let (level, report) = run(method, &mesh, Target::Faces(100));
        check_level("two cones", &level, &report);
        assert_eq!(report.duplicate_faces, 2_000);
    }
}

#[test]
fn scale_and_place_change_nothing_to_speak_of() {
    for method in KERNEL_METHODS {
        let mesh = samples::torus(2_000);
        let (at_home, _) = run(method, &mesh, Target::Ratio(0.1));
        for (scale, shift) in [(2f64.powi(-90), 0.0), (2f64.powi(90), 0.0), (1.0, 1e6)] {
            let mut other = mesh.clone();
            other.positions.iter_mut().flatten().for_each(|x| *x = *x * scale + shift);
            let (level, report) = run(method, &other, Target::Ratio(0.1));
            assert!(report.reached);
            if shift == 0.0 {
                // Scaling by a power of two does not change rounding.
                assert_eq!(level.faces, at_home.faces, "{scale:e}");
            }
            let diagonal =
                (level.bounds().diagonal() / scale / at_home.bounds().diagonal() - 1.0).abs();
            assert!(diagonal < 0.02, "{scale:e} {shift:e}: {diagonal}");
        }
        let mut huge = mesh;
        huge.positions.iter_mut().flatten().for_each(|x| *x *= 1e40);
        let refused = contract_to(&huge, Target::Ratio(0.1), &options(method));
        assert!(matches!(refused, Err(SimplifyError::Extent { .. })));
    }
}

#[test]
fn faces_without_area_and_points_in_one_place_end() {
    for method in KERNEL_METHODS {
        let positions = (0..200).map(|i| [f64::from(i) * f64::from(i), 0.0, 0.0]).collect();
        let strip = |i: u32| [VertexId(i), VertexId(i + 1), VertexId(i + 2)];
        let mut line = Mesh::new(positions, (0..198).map(strip).collect());
        let (level, report) = run(method, &line, Target::Ratio(0.1));
        check_level("line", &level, &report);
        line.positions.fill([3.0; 3]);
        let (level, report) = run(method, &line, Target::Ratio(0.1));
        check_level("point", &level, &report);
        let mut sphere = samples::sphere(2000);
        sphere.positions.fill([0.0; 3]);
        let (level, report) = run(method, &sphere, Target::Ratio(0.1));
        check_level("collapsed sphere", &level, &report);
    }
}

#[test]
fn tiny_and_huge_faces_go_together() {
    for method in KERNEL_METHODS {
        // Spheres a millionth and a hundred-millionth of the size of the first.
        let mut mesh = samples::sphere(2000);
        let (vertices, faces) = (mesh.positions.clone(), mesh.faces.clone());
        for (i, scale) in [1e-6, 1e-8].into_iter().enumerate() {
            let first = ((i + 1) * vertices.len()) as u32;
            mesh.positions.extend(vertices.iter().map(|p| p.map(|x| x * scale)));
            mesh.faces.extend(faces.iter().map(|face| face.map(|v| VertexId(v.0 + first))));
        }
        let keep = Options { topology: Topology::Keep, ..options(method) };
        let (level, report) = contract_to(&mesh, Target::Ratio(0.0), &keep).unwrap();
        check_level("spheres", &level, &report);
        assert_eq!(topology(&level).0, 3);
    }
}

#[test]
fn a_thousand_components_keep_apart() {
    for method in KERNEL_METHODS {
        let one = fixtures::tetrahedron();
        let mut mesh = Mesh::default();
        for i in 0..1000u32 {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(one.positions.iter().map(|&[x, y, z]| [x + f64::from(i), y, z]));
            mesh.faces.extend(one.faces.iter().map(|face| face.map(|v| VertexId(v.0 + first))));
        }
        let keep = Options { topology: Topology::Keep, ..options(method) };
        let (level, report) = contract_to(&mesh, Target::Faces(4), &keep).unwrap();
        assert_eq!((level.faces.len(), report.reached), (4000, false));
    }
}

#[test]
fn locked_vertices_stay() {
    for method in KERNEL_METHODS {
        let mesh = samples::terrain(2000);
        let every_fifth = |v: usize| if v.is_multiple_of(5) { Lock::Locked } else { Lock::Free };
        let locks = Locks {
            of_vertex: (0..mesh.positions.len()).map(every_fifth).collect(),
            ties: Vec::new(),
        };
        let bare = Mesh { attributes: None, ..mesh.clone() };
        let locked = Options { locks, ..options(method) };
        let (level, report) = contract_to(&bare, Target::Ratio(0.0), &locked).unwrap();
        check_level("locked", &level, &report);
        let left: HashSet<[u64; 3]> = level.positions.iter().map(|p| p.map(f64::to_bits)).collect();
        let kept = |v: &usize| left.contains(&mesh.positions[*v].map(f64::to_bits));
        assert!((0..mesh.positions.len()).step_by(5).all(|v| kept(&v)));
        let edge = Options { lock_boundary: true, ..options(method) };
        let (level, report) = contract_to(&bare, Target::Ratio(0.0), &edge).unwrap();
        let connectivity = Connectivity::new(&level.faces, level.positions.len());
        assert_eq!(connectivity.boundary_edges(), report.held.locked);
    }
}

/// Greatest distance of vertices, edge midpoints and face centres from another surface.
fn farthest_point(from: &Mesh, to: &Mesh) -> f64 {
    let to = Bvh::new(to).unwrap();
    let points = from.faces.iter().flat_map(|&face| {
        let [a, b, c] = from.triangle(face);
        [a, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0]
    });
    points.map(|p| to.closest(p.into(), None).distance_squared).fold(0.0, f64::max).sqrt()
}

#[test]
fn a_bound_of_the_error_is_kept_both_ways() {
    for method in KERNEL_METHODS {
        for (mesh, parts) in [
            (samples::torus(3000), [3, 10]),
            (samples::fish(4000), [3, 20]),
            (samples::terrain(20_000), [5, 15]),
            (samples::gyroid(20_000), [4, 7]),
        ] {
            let diagonal = mesh.bounds().diagonal();
            for (part, fewer) in [0.003, 0.01].into_iter().zip(parts) {
                let bound = part * diagonal;
                let (level, report) = run(method, &mesh, Target::Error(bound));
                let far = farthest_point(&mesh, &level).max(farthest_point(&level, &mesh));
                assert!(far <= 1.2 * bound, "{} instead of {part}", far / diagonal);
                assert!(report.error_estimate <= bound && report.error_estimate > 0.8 * bound);
                assert!(level.faces.len() * fewer <= mesh.faces.len(), "{}", level.faces.len());
            }
        }
    }
}

#[test]
fn a_bound_holds_after_another_target_and_after_another_bound() {
    for method in KERNEL_METHODS {
        let mesh = samples::fish(4000);
        let bare = Mesh { attributes: None, ..mesh.clone() };
        let diagonal = mesh.bounds().diagonal();
        let mut simplifier = Simplifier::new(&bare, &options(method)).unwrap();
        simplifier.run(Target::Ratio(0.7), &mut ()).unwrap();
        let mut faces = simplifier.live_faces();
        for part in [0.003, 0.01] {
            simplifier.run(Target::Error(part * diagonal), &mut ()).unwrap();
            let level = simplifier.level();
            let far = farthest_point(&mesh, &level).max(farthest_point(&level, &mesh));
            assert!(far <= 1.3 * part * diagonal, "{} instead of {part}", far / diagonal);
            assert!(level.faces.len() < faces);
            faces = level.faces.len();
        }
    }
}

#[test]
fn volume_stays_and_runs_are_alike() {
    for mesh in [samples::torus(20_000), samples::knot(20_000)] {
        let (level, _) = run(Method::LindstromTurk, &mesh, Target::Ratio(0.2));
        let volume = |mesh: &Mesh| -> f64 {
            let sixfold = |&face| {
                let [a, b, c] = mesh.triangle(face);
                a.cross(b).dot(c)
            };
            mesh.faces.iter().map(sixfold).sum::<f64>() / 6.0
        };
        assert!((volume(&level) / volume(&mesh) - 1.0).abs() < 1e-6);
        assert_eq!(run(Method::LindstromTurk, &mesh, Target::Ratio(0.2)).0, level);
    }
}

#[test]
fn both_engines_report_the_same_input() {
    for method in KERNEL_METHODS {
        let mut dirty = samples::terrain(500);
        dirty.attributes = None;
        let first = dirty.faces[0];
        dirty.faces.extend([first, [first[0], first[0], first[2]], [first[1], first[2], first[0]]]);
        let bare = |mesh: Mesh| Mesh { attributes: None, ..mesh };
        for mesh in
            [dirty, fixtures::cone(300), pages(3), fixtures::hourglass(), bare(samples::fish(500))]
        {
            let in_turn = |v: usize| [Lock::Locked, Lock::Free, Lock::Protected, Lock::Free][v % 4];
            let of_vertex = (0..mesh.positions.len()).map(in_turn).collect();
            let locks = Locks { of_vertex, ties: Vec::new() };
            for options in [
                Options { locks, ..options(method) },
                Options { lock_boundary: true, ..options(method) },
            ] {
                let found = |mut simplifier: Simplifier<'_>| {
                    let report = simplifier.run(Target::Ratio(1.0), &mut ()).unwrap();
                    let Report { degenerate_faces, duplicate_faces, .. } = report;
                    let faces = [degenerate_faces, duplicate_faces, report.output_faces];
                    (faces, report.non_manifold_vertices, report.held, simplifier.level())
                };
                let kernel = found(Simplifier::new(&mesh, &options).unwrap());
                assert_eq!(kernel, found(Simplifier::on_policy_engine(&mesh, &options).unwrap()));
            }
        }
    }
}

/// Remaining faces of a surface by the input's ids, and the positions of their corners.
fn of_surface(simplifier: &Simplifier<'_>) -> Vec<[[u64; 3]; 3]> {
    let surface = simplifier.surface();
    let alive = (0..surface.face_count()).map(FaceId::new).filter(|&f| surface.is_alive(f));
    let place = |v| surface.position(v).to_array().map(f64::to_bits);
    alive.map(|f| surface.face(f).map(place)).collect()
}

/// Faces of a level, and the positions of their corners.
fn of_level(level: &Mesh) -> Vec<[[u64; 3]; 3]> {
    let place = |v: VertexId| level.positions[v.index()].map(f64::to_bits);
    level.faces.iter().map(|face| face.map(place)).collect()
}

#[test]
fn observers_see_exactly_the_level() {
    for method in KERNEL_METHODS {
        for (name, mesh) in meshes() {
            let mesh = Mesh { attributes: None, ..mesh };
            let mut simplifier = Simplifier::new(&mesh, &options(method)).unwrap();
            // Observed, unobserved, observed again; with the surface requested before the start and
            // after.
            assert_eq!(of_surface(&simplifier), of_level(&simplifier.level()), "{name}");
            for (ratio, is_seen) in
                [(0.7, true), (0.5, false), (0.3, true), (0.1, true), (0.0, false)]
            {
                let mut history = History::default();
                let before = simplifier.live_faces();
                let target = Target::Ratio(ratio);
                match is_seen {
                    true => simplifier.run(target, &mut history).unwrap(),
                    false => simplifier.run(target, &mut ()).unwrap(),
                };
                let died =
                    (0..history.contractions().len()).map(|i| history.removed_faces(i).len()).sum();
                let gone = if is_seen { before - simplifier.live_faces() } else { 0 };
                assert_eq!(gone, died, "{name} to {ratio}");
                assert_eq!(
                    of_surface(&simplifier),
                    of_level(&simplifier.level()),
                    "{name} to {ratio}"
                );
            }
        }
    }
}

/// Observer that counts removed faces and needs no surface.
#[derive(Default)]
struct Count(usize);

impl Observe for Count {
    fn needs_surface(&self) -> bool {
        false
    }

    fn gone(&mut self, faces: usize) {
        self.0 += faces;
    }
}

#[test]
fn every_face_that_goes_is_counted() {
    for method in KERNEL_METHODS {
        let mesh = samples::torus(30_000);
        let mut simplifier = Simplifier::new(&mesh, &options(method)).unwrap();
        let (mut alone, mut beside) = (Count::default(), Count::default());
        simplifier.run(Target::Ratio(0.3), &mut alone).unwrap();
        assert_eq!(alone.0, mesh.faces.len() - simplifier.live_faces());
        simplifier.run(Target::Ratio(0.1), &mut (&mut beside, History::default())).unwrap();
        assert_eq!(alone.0 + beside.0, mesh.faces.len() - simplifier.live_faces());
    }
}

#[test]
fn runs_and_steps_go_the_same_way() {
    for method in KERNEL_METHODS {
        let mesh = samples::knot(3000);
        let mut by_steps = Simplifier::new(&mesh, &options(method)).unwrap();
        let mut by_runs = Simplifier::new(&mesh, &options(method)).unwrap();
        for ratio in [0.5, 0.2, 0.05] {
            by_runs.run(Target::Ratio(ratio), &mut ()).unwrap();
            while by_steps.live_faces() > by_runs.live_faces() {
                // At its announced cost it is either made or found to be refused.
                let cost = by_steps.next_cost().unwrap();
                let before = by_steps.live_faces();
                let made = by_steps.step(cost, &mut ());
                assert!(made || by_steps.next_cost() > Some(cost), "{cost:e}");
                assert_eq!(made, by_steps.live_faces() < before);
            }
            assert_eq!(by_steps.level(), by_runs.level());
        }
    }
}

#[test]
fn damaged_files_end() {
    for method in KERNEL_METHODS {
        for path in fixtures::shared_broken() {
            let Ok(text) = std::fs::read(&path) else { continue };
            // Arbitrary bytes make a soup: four of them are an index.
            let index = |bytes: &[u8]| VertexId(u32::from(bytes[0]) % 40);
            let faces = text.chunks_exact(3).take(500);
            let faces = faces.map(|b| [index(b), index(&b[1..]), index(&b[2..])]).collect();
            let positions = (0..40).map(|i| [f64::from(i % 7), f64::from(i % 5), f64::from(i % 3)]);
            let soup = Mesh::new(positions.collect(), faces);
            if let Ok((level, report)) = contract_to(&soup, Target::Ratio(0.1), &options(method)) {
                check_level("soup", &level, &report);
            }
        }
    }
}

/// Sphere of which single vertices stand out by a third of its radius.
fn hedgehog() -> Mesh {
    let mut mesh = samples::sphere(20_000);
    mesh.attributes = None;
    for p in mesh.positions.iter_mut().step_by(199) {
        *p = p.map(|x| 1.33 * x);
    }
    mesh
}

/// Greatest distance of the vertices of a mesh from a level of it.
fn farthest(mesh: &Mesh, level: &Mesh) -> f64 {
    let level = Bvh::new(level).unwrap();
    let squared = |&p| level.closest(p, None).distance_squared;
    mesh.positions.iter().map(squared).fold(0.0, f64::max).sqrt()
}

#[test]
fn tips_stay_while_others_go() {
    for method in KERNEL_METHODS {
        let mesh = hedgehog();
        let (level, report) = run(method, &mesh, Target::Ratio(0.15));
        assert!(report.reached);
        let radius = mesh.bounds().diagonal() / 4.6;
        let lost = farthest(&mesh, &level) / radius;
        assert!(lost < 0.1, "tips of 0.33 of the radius have lost {lost}");
    }
}

#[test]
fn tips_that_are_cut_off_are_in_the_estimate() {
    for method in KERNEL_METHODS {
        for mesh in [hedgehog(), Mesh { attributes: None, ..samples::fish(5000) }] {
            for faces in [1000, 100] {
                let (level, report) = run(method, &mesh, Target::Faces(faces));
                let lost = farthest(&mesh, &level);
                assert!(report.error_estimate > 0.7 * lost, "{faces}: {report:?}, {lost}");
            }
        }
    }
}

#[test]
fn a_bound_of_the_error_keeps_tips() {
    for method in KERNEL_METHODS {
        let mesh = hedgehog();
        let most = 0.02 * mesh.bounds().diagonal();
        let (level, report) = run(method, &mesh, Target::Error(most));
        assert!(level.faces.len() < mesh.faces.len() / 4, "{report:?}");
        let lost = farthest(&mesh, &level);
        assert!(lost <= most, "{lost}, for {most}");
    }
}
