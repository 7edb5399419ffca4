//! Invariants that every method must keep on every mesh.

mod common;

use std::collections::{HashMap, HashSet};
use std::sync::LazyLock;

use glam::DVec3;
use meshlod_fixtures as fixtures;
use meshlod_fixtures::shape::{TopologyCounts, bare, defects, topology, volume};
use meshlod_mesh::{
    Attributes, Connectivity, FaceId, Layer, LayerKind, Lock, Locks, Mesh, VertexId, WedgeId,
};
use meshlod_samples as samples;
use meshlod_simplify::{
    Method, Neighbourhood, Observe, Options, Placed, Report, Simplifier, SimplifyError, Surface,
    Target, Topology, Unconserved, contract_to,
};
use proptest::prelude::*;

/// Fixtures, samples, and versions of some without attributes.
fn meshes() -> Vec<(&'static str, Mesh)> {
    let mut all = common::meshes();
    all.push(("faceted torus", samples::faceted_torus(2000)));
    all.push(("bare seam strip", bare(fixtures::seam_strip())));
    all.push(("bare fish", bare(samples::fish(600))));
    all
}

/// Locks every nth vertex.
fn every_nth(mesh: &Mesh, n: usize, lock: Lock) -> Locks {
    let of = |v: usize| if v.is_multiple_of(n) { lock } else { Lock::Free };
    Locks { of_vertex: (0..mesh.positions.len()).map(of).collect(), ties: Vec::new() }
}

/// Method on one of the two engines.
#[derive(Clone, Copy, Debug)]
struct Runner {
    method: Method,
    /// True to run a kernel method on the policy engine.
    on_policy_engine: bool,
}

impl Runner {
    /// Every method on its own engine, and the kernel's two on the policy engine too.
    fn all() -> impl Iterator<Item = Self> {
        let as_done =
            Method::ALL.into_iter().map(|method| Self { method, on_policy_engine: false });
        let of_kernel = Method::ALL.into_iter().filter(|method| method.runs_in_kernel());
        as_done.chain(of_kernel.map(|method| Self { method, on_policy_engine: true }))
    }

    fn start<'m>(self, mesh: &'m Mesh, options: &Options) -> Result<Simplifier<'m>, SimplifyError> {
        let options = Options { method: self.method, ..options.clone() };
        match self.on_policy_engine {
            true => Simplifier::on_policy_engine(mesh, &options),
            false => Simplifier::new(mesh, &options),
        }
    }

    fn go(self, mesh: &Mesh, target: Target, options: &Options) -> (Mesh, Report) {
        let mut simplifier = self.start(mesh, options).unwrap();
        let mut report = simplifier.run(target, &mut ()).unwrap();
        (simplifier.settled_level(&mut report.volume), report)
    }

    fn run(self, mesh: &Mesh, ratio: f64) -> (Mesh, Report) {
        self.go(mesh, Target::Ratio(ratio), &Options::default())
    }

    /// Returns true if the kernel runs it, in single precision.
    fn is_kernel(self) -> bool {
        self.method.runs_in_kernel() && !self.on_policy_engine
    }
}

fn run(mesh: &Mesh, method: Method, ratio: f64) -> (Mesh, Report) {
    Runner { method, on_policy_engine: false }.run(mesh, ratio)
}

/// A level of a mesh, and the words for both.
struct Made {
    what: String,
    mesh: Mesh,
    level: Mesh,
    report: Report,
}

/// Levels of all meshes by every method, made once for all tests.
static LEVELS: LazyLock<Vec<Made>> = LazyLock::new(|| {
    let options = Options { topology: Topology::Keep, ..Options::default() };
    let mut levels = Vec::new();
    for (name, mesh) in meshes() {
        for runner in Runner::all() {
            for ratio in [0.5, 0.1, 0.0] {
                let (level, report) = runner.go(&mesh, Target::Ratio(ratio), &options);
                let what = format!("{name} by {runner:?} to {ratio}");
                levels.push(Made { what, mesh: mesh.clone(), level, report });
            }
        }
    }
    levels
});

#[test]
fn a_level_is_as_closed_manifold_and_oriented_as_its_mesh() {
    for Made { what, mesh, level, .. } in &*LEVELS {
        let (before, after) = (topology(mesh), topology(level));
        assert_eq!(before.components, after.components, "{what}");
        assert_eq!(before.euler, after.euler, "{what}");
        assert_eq!(before.is_closed, after.is_closed, "{what}");
        assert!(after.non_manifold_edges <= before.non_manifold_edges, "{what}");
        // A non-orientable strip may shift where its two orientations meet, and must keep one such
        // place.
        if before.inconsistent_edges == 0 {
            assert_eq!(after.inconsistent_edges, 0, "{what}");
        }
    }
}

#[test]
fn a_level_is_valid_and_has_no_face_twice() {
    for Made { what, level, report, .. } in &*LEVELS {
        level.validate().unwrap_or_else(|error| panic!("{what}: {error}"));
        assert_eq!(level.faces.len(), report.output_faces, "{what}");
        assert!(level.used_vertices().iter().all(|&used| used), "{what}");
        let mut seen = HashSet::new();
        for face in &level.faces {
            let mut sorted = face.map(|v| v.0);
            sorted.sort_unstable();
            assert!(sorted[0] < sorted[1] && sorted[1] < sorted[2], "{what}: {face:?}");
            assert!(seen.insert(sorted), "{what}: {face:?} stands twice");
        }
    }
}

#[test]
fn smooth_samples_reach_their_target() {
    for mesh in [samples::sphere(2000), samples::torus(2000), samples::knot(3000)] {
        for runner in Runner::all() {
            let (level, report) = runner.run(&mesh, 0.05);
            let target = mesh.faces.len() / 20;
            // Contracting a face removes four faces, an edge two.
            assert!(report.reached && (target - 3..=target).contains(&level.faces.len()));
        }
    }
}

#[test]
fn the_reason_for_stopping_is_reported() {
    for runner in Runner::all() {
        let (level, report) = runner.run(&fixtures::tetrahedron(), 0.0);
        assert_eq!(level.faces.len(), 4);
        let refused: u64 = report.refusals.iter().map(|(_, count)| count).sum();
        // Where a vertex has one entry for all its edges, one refusal covers those of equal cost.
        let least = if runner.is_kernel() { 1 } else { 6 };
        assert!(refused >= least, "all six edges are refused, not {refused}, by {runner:?}");
    }
}

#[test]
fn every_single_step_keeps_a_closed_surface_closed() {
    for runner in Runner::all() {
        for kept in Topology::ALL {
            let mesh = samples::torus(300);
            let options = Options { topology: kept, ..Options::default() };
            let mut simplifier = runner.start(&mesh, &options).unwrap();
            while simplifier.step(f64::INFINITY, &mut ()) {
                let report = simplifier.run(Target::Ratio(1.0), &mut ()).unwrap();
                let closed = report.handles.map_or(0, |handles| handles.closed as i64);
                assert!(closed == 0 || kept == Topology::Free);
                let of_mesh = topology(&mesh);
                let expected = TopologyCounts { euler: of_mesh.euler + 2 * closed, ..of_mesh };
                assert_eq!(topology(&simplifier.level()), expected);
            }
            assert!(simplifier.live_faces() < 40);
        }
    }
}

/// Normals of the faces that a step changes, before and after.
#[derive(Default)]
struct Turned(HashMap<FaceId, [DVec3; 2]>);

impl Observe for Turned {
    fn before(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, _: &Placed) {
        for spoke in neighbourhood.spokes() {
            let normal = surface.area_normal(spoke.face);
            self.0.entry(spoke.face).or_insert([normal; 2]);
        }
    }

    fn after(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, _: &Placed) {
        for spoke in neighbourhood.spokes() {
            self.0.entry(spoke.face).or_default()[1] = surface.area_normal(spoke.face);
        }
        for removed in neighbourhood.removed_faces() {
            self.0.remove(&removed.face);
        }
    }
}

#[test]
fn no_step_flips_a_face() {
    let fish = samples::fish(800);
    let bare_fish = bare(fish.clone());
    for mesh in [samples::knot(1500), samples::gyroid(1500), samples::terrain(800), fish, bare_fish]
    {
        for runner in Runner::all() {
            let mut simplifier = runner.start(&mesh, &Options::default()).unwrap();
            loop {
                let mut turned = Turned::default();
                if !simplifier.step(f64::INFINITY, &mut turned) {
                    break;
                }
                for (face, [before, after]) in turned.0 {
                    assert!(before.dot(after) > 0.0, "{runner:?} turns {face}");
                }
            }
        }
    }
}

#[test]
fn methods_that_claim_to_conserve_volume_do() {
    for mesh in [samples::torus(1500), samples::knot(1500), samples::gyroid(1500)] {
        for runner in Runner::all() {
            let (level, report) = runner.run(&mesh, 0.1);
            let lost = (volume(&mesh) - volume(&level)) / volume(&mesh);
            let loss = report.volume;
            let off = loss.lost() / volume(&mesh) - lost;
            let rounding = if runner.is_kernel() { 1e-7 } else { 1e-13 };
            assert!(off.abs() < rounding, "{runner:?}: the sum is {off:e} off {lost:e}");
            let conserved = lost.abs() < rounding;
            assert_eq!(conserved, runner.method.conserves_volume(), "{runner:?}: {lost:e}");
        }
    }
}

#[test]
fn volume_is_lost_until_a_level_has_been_repaid() {
    let mesh = samples::torus(1500);
    for nth_locked in [usize::MAX, 9] {
        let locks = every_nth(&mesh, nth_locked, Lock::Locked);
        let options = Options { locks, ..Options::default() };
        for target in [Target::Ratio(0.1), Target::Error(0.1)] {
            let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
            let mut loss = simplifier.run(target, &mut ()).unwrap().volume;
            assert!(loss.owed != 0.0 && loss.repaid == 0.0, "{target:?}: {loss:?}");
            let off = |lost: f64, level: &Mesh| (volume(&mesh) - volume(level) - lost).abs();
            let rounding = 1e-7 * volume(&mesh);
            assert!(off(loss.lost(), &simplifier.level()) < rounding, "{target:?}: {loss:?}");
            let settled = simplifier.settled_level(&mut loss);
            assert!(off(loss.lost(), &settled) < rounding, "{target:?}: {loss:?}");
            // Locked vertices leave none to repay it, and an error bound comes before the volume.
            let repays = nth_locked == usize::MAX && target == Target::Ratio(0.1);
            let expected = if repays { loss.owed } else { 0.0 };
            assert!((loss.repaid - expected).abs() < rounding, "{target:?}: {loss:?}");
        }
    }
}

#[test]
fn contractions_that_cannot_conserve_volume_are_reported() {
    for runner in Runner::all().filter(|runner| runner.method.conserves_volume()) {
        let (_, report) = runner.run(&samples::terrain(800), 0.1);
        let Unconserved { contractions, bounds } = report.volume.at_boundaries;
        assert!(contractions > 0 && bounds.diagonal() > 0.0);
        if !runner.is_kernel() {
            let lost = report.volume.behind_boundary_cones.unwrap().abs();
            assert!(lost < 1e-12, "{runner:?} loses {lost:e} behind the cones at boundaries");
        }
        let mesh = samples::sphere(800);
        let locks = every_nth(&mesh, 9, Lock::Locked);
        let options = Options { locks, ..Options::default() };
        let (_, report) = runner.go(&mesh, Target::Ratio(0.3), &options);
        assert!(report.volume.held.contractions > 0, "{runner:?}");
        assert!(report.volume.running_sum.abs() > 1e-9, "{runner:?}");
    }
}

#[test]
fn steps_stop_where_they_would_cost_too_much() {
    let mesh = samples::knot(1000);
    for runner in Runner::all() {
        let mut simplifier = runner.start(&mesh, &Options::default()).unwrap();
        for _ in 0..20 {
            assert!(simplifier.step(f64::INFINITY, &mut ()));
        }
        let (before, most_cost) = (simplifier.live_faces(), 2.0 * simplifier.next_cost().unwrap());
        while simplifier.step(most_cost, &mut ()) {}
        let stopped = simplifier.live_faces();
        assert!((before / 4..before).contains(&stopped), "{runner:?}: {before} {stopped}");
        assert!(simplifier.step(f64::INFINITY, &mut ()) && simplifier.live_faces() < stopped);
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    for (name, mesh) in meshes() {
        for runner in Runner::all() {
            let with = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| runner.run(&mesh, 0.2))
            };
            assert_eq!(with(1), with(2), "{name}");
        }
    }
}

#[test]
fn locked_vertices_stay_where_they_are() {
    let mesh = samples::sphere(1000);
    let locks = every_nth(&mesh, 7, Lock::Locked);
    for runner in Runner::all() {
        let options = Options { locks: locks.clone(), ..Options::default() };
        let (level, _) = runner.go(&mesh, Target::Faces(0), &options);
        let places: HashSet<_> = level.positions.iter().map(|p| p.map(f64::to_bits)).collect();
        for (v, position) in mesh.positions.iter().enumerate().step_by(7) {
            assert!(places.contains(&position.map(f64::to_bits)), "{}", VertexId::new(v));
        }
    }
}

#[test]
fn a_wider_bound_goes_on_where_a_narrower_one_stopped() {
    let mesh = samples::knot(2000);
    for runner in Runner::all() {
        let mut simplifier = runner.start(&mesh, &Options::default()).unwrap();
        let mut faces = mesh.faces.len();
        for error in [0.005, 0.01, 0.02, 0.04] {
            let report = simplifier.run(Target::Error(error), &mut ()).unwrap();
            assert!(report.error_estimate <= error);
            assert!(report.output_faces < faces * 9 / 10, "{faces} to {}", report.output_faces);
            faces = report.output_faces;
        }
        let report = simplifier.run(Target::Faces(faces / 4), &mut ()).unwrap();
        assert!(report.reached);
    }
}

#[test]
fn a_locked_boundary_keeps_every_vertex() {
    let mesh = samples::terrain(800);
    let options = Options { lock_boundary: true, ..Options::default() };
    let edges = |mesh: &Mesh| Connectivity::new(&mesh.faces, mesh.positions.len()).boundary_edges();
    for runner in Runner::all() {
        let (level, report) = runner.go(&mesh, Target::Faces(0), &options);
        assert_eq!(edges(&level), edges(&mesh), "{runner:?}");
        assert!(!report.reached && level.faces.len() < mesh.faces.len() / 2, "{runner:?}");
    }
}

#[test]
fn endpoint_keeps_to_the_vertices_of_the_input() {
    let mesh = samples::knot(2000);
    let places: HashSet<_> = mesh.positions.iter().map(|p| p.map(f64::to_bits)).collect();
    let (level, _) = run(&mesh, Method::QemEndpoint, 0.1);
    assert!(level.positions.iter().all(|p| places.contains(&p.map(f64::to_bits))));
}

#[test]
fn a_flat_costs_nothing_and_keeps_its_outline() {
    let mesh = fixtures::grid(16);
    for runner in Runner::all() {
        let (level, report) = runner.go(&mesh, Target::Error(1e-9), &Options::default());
        let left = level.faces.len();
        assert!(left <= 8, "{left} faces are left of a square by {runner:?}");
        assert!(report.error_estimate < 1e-9);
        assert!((level.bounds().diagonal() - 16.0 * 2f64.sqrt()).abs() < 1e-6);
    }
}

#[test]
fn an_error_bound_stops_what_would_exceed_it() {
    let mesh = samples::sphere(5000);
    let methods = [Method::Qem, Method::LindstromTurk];
    for runner in Runner::all().filter(|runner| methods.contains(&runner.method)) {
        let mut last = mesh.faces.len();
        for error in [1.2e-3, 3e-3, 1e-2, 3e-2] {
            let (level, report) = runner.go(&mesh, Target::Error(error), &Options::default());
            assert!(report.error_estimate <= error && level.faces.len() < last, "{runner:?}");
            last = level.faces.len();
        }
    }
}

#[test]
fn far_from_the_origin_is_as_good_as_near() {
    let near = samples::torus(2000);
    let mut far = near.clone();
    far.positions.iter_mut().flatten().for_each(|x| *x += 65536.0);
    for method in [Method::Qem, Method::LindstromTurk] {
        let (a, b) = (run(&near, method, 0.1), run(&far, method, 0.1));
        let relative = a.1.error_estimate / b.1.error_estimate;
        assert!((0.9..1.1).contains(&relative), "{}: {relative}", method.name());
    }
}

#[test]
fn the_seam_of_a_strip_keeps_its_two_wedges() {
    let mesh = samples::fish(2000);
    for method in Method::ALL {
        let (level, _) = run(&mesh, method, 0.1);
        let attributes = level.attributes.as_ref().unwrap();
        let mut wedges = vec![HashSet::new(); level.positions.len()];
        for (face, corners) in level.faces.iter().zip(&attributes.corners) {
            for (v, w) in face.iter().zip(corners) {
                wedges[v.index()].insert(*w);
            }
        }
        assert!(wedges.iter().any(|at| at.len() > 1), "the seam is gone");
        // A wedge belongs to one vertex.
        assert_eq!(wedges.iter().map(HashSet::len).sum::<usize>(), attributes.wedge_count);
    }
}

#[test]
fn invalid_meshes_are_refused() {
    let empty = Mesh::default();
    assert!(contract_to(&empty, Target::Faces(1), &Options::default()).is_err());
    let mut nan = fixtures::tetrahedron();
    nan.positions[0][0] = f64::NAN;
    assert!(contract_to(&nan, Target::Faces(1), &Options::default()).is_err());
    for bad in [Target::Ratio(f64::NAN), Target::Ratio(1.5), Target::Error(-1.0)] {
        assert!(contract_to(&fixtures::cube(), bad, &Options::default()).is_err());
    }
}

proptest! {
    /// Soups of few vertices, where nearly every edge is a special case.
    #[test]
    fn a_soup_gets_no_worse(
        positions in prop::collection::vec(prop::array::uniform3(-4i8..4), 4..14),
        raw in prop::collection::vec(prop::array::uniform3(0u32..14), 1..40),
        runner in prop::sample::select(Runner::all().collect::<Vec<_>>()),
        ratio in 0.0..1.0f64,
    ) {
        let count = positions.len() as u32;
        let mesh = Mesh::new(
            positions.iter().map(|p| p.map(f64::from)).collect(),
            raw.iter().map(|face| face.map(|v| VertexId(v % count))).collect(),
        );
        // If every face is degenerate, there is nothing to keep.
        let options = Options { topology: Topology::Keep, ..Options::default() };
        if let Ok(mut simplifier) = runner.start(&mesh, &options) {
            let cleaned = simplifier.level();
            simplifier.run(Target::Ratio(ratio), &mut ()).unwrap();
            let level = simplifier.level();
            level.validate().unwrap();
            let (before, after) = (defects(&cleaned), defects(&level));
            prop_assert!(after[0] <= before[0], "open edges: {before:?} {after:?}");
            prop_assert!(after[1] <= before[1], "non-manifold edges: {before:?} {after:?}");
            prop_assert_eq!(after[2], before[2], "components");
        }
    }
}

#[test]
fn flat_shading_does_not_block_contraction() {
    let mut mesh = samples::torus(2000);
    let corners = (0..mesh.faces.len() as u32 * 3).map(WedgeId).collect::<Vec<_>>();
    let normals = mesh.faces.iter().flat_map(|&face| {
        let [a, b, c] = mesh.triangle(face);
        [(b - a).cross(c - a).normalize().as_vec3().to_array(); 3].concat()
    });
    mesh.attributes = Some(Attributes {
        corners: corners.as_chunks::<3>().0.to_vec(),
        wedge_count: corners.len(),
        layers: vec![Layer {
            kind: LayerKind::Normal,
            name: String::new(),
            width: 3,
            values: normals.collect(),
        }],
    });
    for method in Method::ALL {
        let (level, report) = run(&mesh, method, 0.1);
        assert!(report.reached, "{}", report.refusals);
        // Faces of several normals still meet here: a crease, not one smooth vertex.
        assert!(level.attributes.as_ref().unwrap().wedge_count > level.positions.len());
    }
}
