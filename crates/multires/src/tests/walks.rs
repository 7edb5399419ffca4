//! Random walks through queries, and the properties of the answers.

use std::collections::BTreeSet;

use glam::DVec3;
use meshlod_fixtures as fixtures;
use meshlod_mesh::{Connectivity, Mesh};
use meshlod_samples as samples;
use meshlod_simplify::{Method, Options};

use crate::implicit::Order;
use crate::{
    Cut, Explicit, ExplicitCut, Focus, Forest, Implicit, Level, Model, Query, SlotMesh, SplitRule,
    Tolerance, UpdateLimits, ViewCamera,
};

pub(crate) const METHODS: [Method; 5] = [
    Method::Qem,
    Method::LindstromTurk,
    Method::QemEndpoint,
    Method::LeeJang,
    Method::LindstromTurkFaces,
];

fn meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("sphere", samples::sphere(600)),
        ("torus", samples::torus(500)),
        ("terrain", samples::terrain(600)),
        ("gyroid", samples::gyroid(900)),
        ("grid", fixtures::grid(10)),
        ("fan", fixtures::fan()),
        ("hourglass", fixtures::hourglass()),
        ("two objects", fixtures::two_objects()),
    ]
}

pub(crate) fn forest(mesh: &Mesh, method: Method) -> Forest {
    Forest::new(mesh, &Options { method, ..Options::default() }).unwrap()
}

pub(crate) fn each(check: impl FnMut(&str, &Mesh, &Forest)) {
    each_by(&METHODS, check);
}

pub(crate) fn each_by(methods: &[Method], mut check: impl FnMut(&str, &Mesh, &Forest)) {
    for (name, mesh) in meshes() {
        for &method in methods {
            check(&format!("{name} by {}", method.name()), &mesh, &forest(&mesh, method));
        }
    }
}

/// Pseudo-random numbers.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    /// Returns a number from 0 to 1.
    pub(crate) fn roll(&mut self) -> f64 {
        // A linear congruential generator; its high bits are good enough here.
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64
    }

    pub(crate) fn place(&mut self, mesh: &Mesh) -> [f64; 3] {
        let v = (self.roll() * mesh.positions.len() as f64) as usize;
        mesh.positions[v]
    }
}

/// Returns a random query.
pub(crate) fn query(dice: &mut Dice, mesh: &Mesh) -> Query<'static> {
    let diagonal = mesh.bounds().diagonal();
    let camera = ViewCamera {
        eye: dice.place(mesh).map(|x| x + diagonal * (0.1 + dice.roll())),
        look: mesh.bounds().center(),
        up: [0.0, 0.3, 1.0],
        fov_rad: 0.8,
        viewport: [640, 480],
    };
    let focus = match (dice.roll() * 8.0) as usize {
        0..3 => Focus::Everything,
        3 => Focus::Point(dice.place(mesh)),
        4 => Focus::Segment([dice.place(mesh), dice.place(mesh)]),
        5 => {
            let (a, b) = (dice.place(mesh), dice.place(mesh));
            Focus::Box([[0, 1, 2].map(|k| a[k].min(b[k])), [0, 1, 2].map(|k| a[k].max(b[k]))])
        }
        6 => Focus::Sphere { center: dice.place(mesh), radius: 0.2 * diagonal * dice.roll() },
        _ => Focus::Frustum(camera),
    };
    let tolerance = match (dice.roll() * 4.0) as usize {
        0 => Tolerance::Uniform(0.0),
        1 => Tolerance::Uniform(diagonal * (-4.0 - 10.0 * dice.roll()).exp2()),
        _ => Tolerance::Pixels { camera, pixels: (6.0 * dice.roll() - 2.0).exp2() },
    };
    Query { focus, tolerance }
}

/// Topological properties that no cut may change for the worse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Topology {
    euler: i64,
    non_manifold_edges: usize,
    inconsistent_edges: usize,
    pinched: usize,
    boundary_loops: bool,
}

impl Topology {
    /// Returns true if it has fewer non-manifold elements; contractions may remove some.
    pub(crate) fn is_simpler_than(&self, other: &Self) -> bool {
        self.non_manifold_edges < other.non_manifold_edges || self.pinched < other.pinched
    }
}

pub(crate) fn topology(mesh: &Mesh) -> Topology {
    let c = Connectivity::new(&mesh.faces, mesh.positions.len());
    let used = mesh.used_vertices().iter().filter(|&&used| used).count();
    Topology {
        euler: used as i64 - c.edge_count() as i64 + mesh.faces.len() as i64,
        non_manifold_edges: c.non_manifold_edges(),
        inconsistent_edges: c.inconsistent_edges(),
        pinched: c.pinched_vertices(),
        boundary_loops: c.is_closed(),
    }
}

/// Returns the faces of a level by the forest's nodes.
pub(crate) fn in_forest(level: &Level, order: &Order) -> Vec<[u32; 3]> {
    let mut level = level.clone();
    level.nodes.iter_mut().for_each(|node| *node = order.nodes[*node as usize]);
    level.canonical()
}

/// Returns the forest's nodes above those of a level.
pub(crate) fn split_nodes(level: &Level, mt: &Implicit, order: &Order) -> BTreeSet<u32> {
    let mut above = BTreeSet::new();
    for &node in &level.nodes {
        let mut node = node;
        while let Some(up) = mt.creator(node) {
            node = mt.parent(up);
            if !above.insert(order.nodes[node as usize]) {
                break;
            }
        }
    }
    above
}

#[test]
fn the_finest_cut_is_the_input() {
    each(|what, mesh, forest| {
        let mt = Explicit::new(forest);
        let mut all = ExplicitCut::new(&mt);
        (0..mt.update_count()).for_each(|u| all.force(u as u32));
        let mut input = ExplicitCut::new(&mt).level();
        input.nodes = (0..mesh.positions.len() as u32).collect();
        input.faces = mesh.faces.iter().map(|face| face.map(|v| v.0)).collect();
        assert_eq!(all.level().canonical(), input.canonical(), "{what}");
    });
}

#[test]
fn all_encodings_give_the_same_cuts() {
    each(|what, mesh, forest| {
        let order = Order::new(forest);
        let explicit = Explicit::new(forest);
        let [strict, loose] = [SplitRule::Strict, SplitRule::Wings]
            .map(|rule| Model::with_rule(forest, rule).unwrap());
        let implicit = strict.implicit();
        let [mut extractor, mut weaker] = [&strict, &loose].map(Model::extractor);
        let (mut oracle, mut cut) = (ExplicitCut::new(&explicit), strict.cut());
        let mut dice = Dice(7);
        for _ in 0..30 {
            let query = query(&mut dice, mesh);
            let level = explicit.extract(&query).unwrap();
            assert_eq!(topology(&level.mesh()), topology(mesh), "{what} {query:?}");
            oracle.update(&query).unwrap();
            assert_eq!(oracle.level().canonical(), level.canonical(), "{what} {query:?}");
            let change = cut.update(&query, &UpdateLimits::default()).unwrap();
            assert!(change.done);
            let found = in_forest(&cut.level(), &order);
            assert_eq!(found, level.canonical(), "{what} {query:?}");
            let exact = in_forest(extractor.exact(&query).unwrap(), &order);
            assert_eq!(exact, level.canonical(), "{what} {query:?}");
            let smaller = weaker.exact(&query).unwrap();
            assert!(smaller.faces.len() <= level.faces.len(), "{what} {query:?}");
            assert_eq!(topology(&smaller.mesh()), topology(mesh), "{what} {query:?}");
            // With the answer's own number of faces as the budget, the answer comes back.
            let best = extractor.at_most(level.faces.len(), &query).unwrap();
            assert_eq!(in_forest(best, &order), level.canonical(), "{what} {query:?}");
            let all = extractor.at_most(usize::MAX, &query).unwrap().faces.len();
            let most = (dice.roll() * mesh.faces.len() as f64) as usize;
            let best = extractor.at_most(most, &query).unwrap();
            assert!(best.faces.len() <= most.max(implicit.base_faces()), "{what} {query:?}");
            // The next update would exceed the budget; a face split creates up to four faces.
            assert!(best.faces.len() == all || best.faces.len() + 4 > most, "{what} {query:?}");
            assert!(explicit.cut_of(&split_nodes(best, implicit, &order)).is_some(), "{what}");
            if let (Focus::Everything, Tolerance::Pixels { camera, pixels }) =
                (&query.focus, &query.tolerance)
            {
                let slope = pixels * camera.pixel();
                let range = [slope / (1.0 + dice.roll()), slope * (1.0 + dice.roll())];
                let mut saturated = strict.clone();
                saturated.saturate(range).unwrap();
                let mut saturated = saturated.extractor();
                let larger = saturated.saturated(&query).unwrap();
                assert!(larger.faces.len() >= level.faces.len(), "{what} {query:?}");
                let cut = explicit.cut_of(&split_nodes(larger, implicit, &order));
                let cut = cut.unwrap_or_else(|| panic!("{what} {query:?} gives no cut"));
                assert_eq!(in_forest(larger, &order), cut.canonical(), "{what} {query:?}");
            }
            if let (Focus::Everything, Tolerance::Uniform(most)) = (&query.focus, &query.tolerance)
            {
                let fast = extractor.uniform(*most).unwrap();
                assert_eq!(in_forest(fast, &order), level.canonical(), "{what} {query:?}");
            }
        }
    });
}

/// A closed mesh of the right Euler number may still be folded, which shows in its area and volume.
#[test]
fn cuts_cover_the_surface_once() {
    let mesh = samples::torus(4000);
    let measure = |mesh: &Mesh| {
        let parts = mesh.faces.iter().map(|&face| {
            let [a, b, c] = mesh.triangle(face);
            [(b - a).cross(c - a).length() / 2.0, a.dot(b.cross(c)) / 6.0]
        });
        parts.fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]])
    };
    let [area, volume] = measure(&mesh);
    for method in METHODS {
        let mt = Implicit::new(&forest(&mesh, method)).unwrap();
        let (mut cut, mut dice) = (Cut::new(&mt), Dice(23));
        for _ in 0..40 {
            let near = DVec3::from(dice.place(&mesh));
            let field = |at: [f64; 3], radius: f64| {
                (0.05 * (near.distance(at.into()) - radius)).clamp(1e-4, 0.03)
            };
            let query = Query { focus: Focus::Everything, tolerance: Tolerance::Field(&field) };
            cut.update(&query, &UpdateLimits::default()).unwrap();
            assert!(cut.face_count() < mt.full_faces() * 9 / 10, "{}", cut.face_count());
            let level = cut.level();
            let [found, enclosed] = measure(&level.mesh());
            assert!((found / area - 1.0).abs() < 0.05, "{}: area {found} of {area}", method.name());
            assert!((enclosed / volume - 1.0).abs() < 0.05, "{}: {enclosed}", method.name());
            assert_eq!(level.folds(), 0, "{}", method.name());
        }
    }
}

/// Non-fan splits: edges of three faces, inconsistent orientations, and hubs.
#[test]
fn non_fan_splits_list_their_faces() {
    let soups = (0..30).map(soup);
    for mesh in [cone(400), fixtures::moebius(60)].into_iter().chain(soups) {
        for method in METHODS {
            let forest = forest(&mesh, method);
            let order = Order::new(&forest);
            let explicit = Explicit::new(&forest);
            let implicit = Implicit::in_order(&forest, &order).unwrap();
            implicit.certify().unwrap();
            let mut cut = Cut::new(&implicit);
            let mut dice = Dice(5);
            for _ in 0..10 {
                let query = query(&mut dice, &mesh);
                cut.update(&query, &UpdateLimits::default()).unwrap();
                let level = explicit.extract(&query).unwrap();
                assert_eq!(in_forest(&cut.level(), &order), level.canonical(), "{query:?}");
            }
        }
    }
}

/// Returns a cone whose apex has many neighbours.
pub(crate) fn cone(around: u32) -> Mesh {
    let rim = (0..around).map(|i| {
        let (sin, cos) = (f64::from(i) / f64::from(around) * std::f64::consts::TAU).sin_cos();
        [cos, sin, 0.0]
    });
    let positions: Vec<_> = rim.chain([[0.0, 0.0, 0.5]]).collect();
    let sides: Vec<_> = (0..around).map(|i| [i, (i + 1) % around, around]).collect();
    fixtures::mesh(&positions, &sides)
}

/// Returns faces between random triples of a few points.
pub(crate) fn soup(seed: u64) -> Mesh {
    let mut dice = Dice(seed);
    let points = 8 + seed % 20;
    let positions: Vec<_> = (0..points).map(|_| [0; 3].map(|_| dice.roll())).collect();
    let mut corner = || (dice.roll() * points as f64) as u32;
    let faces: Vec<_> = (0..3 * points).map(|_| [corner(), corner(), corner()]).collect();
    fixtures::mesh(&positions, &faces)
}
