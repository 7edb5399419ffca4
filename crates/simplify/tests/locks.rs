//! Locks, protection and ties hold.

use std::collections::HashMap;

use meshlod_mesh::{Connectivity, Lock, Locks, Mesh, VertexId, face_components};
use meshlod_samples as samples;
use meshlod_simplify::{
    History, Method, Neighbourhood, Observe, Options, Placed, Progressive, Simplifier,
    SimplifyError, Surface, Target, Topology, contract_to,
};
use proptest::prelude::*;

/// Closed box of `n` unit squares a side, from `start`.
fn boxed(n: [i32; 3], start: [i32; 3]) -> Mesh {
    let mut ids = HashMap::new();
    let mut mesh = Mesh::default();
    for side in 0..6usize {
        let axis = side / 2;
        // Two axes across, ordered so that the side faces outwards.
        let [u, v] = [[1, 2], [2, 1]][side % 2].map(|step| (axis + step) % 3);
        let mut at = |i: i32, j: i32| {
            let mut p = start;
            p[axis] += if side.is_multiple_of(2) { n[axis] } else { 0 };
            (p[u], p[v]) = (p[u] + i, p[v] + j);
            *ids.entry(p).or_insert_with(|| {
                mesh.positions.push(p.map(f64::from));
                VertexId::new(mesh.positions.len() - 1)
            })
        };
        for (i, j) in (0..n[u]).flat_map(|i| (0..n[v]).map(move |j| (i, j))) {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// Joins several meshes into one, keeping their vertices separate.
fn beside(meshes: &[Mesh]) -> Mesh {
    let mut all = Mesh::default();
    for mesh in meshes {
        let start = all.positions.len() as u32;
        all.positions.extend(&mesh.positions);
        all.faces.extend(mesh.faces.iter().map(|face| face.map(|v| VertexId(v.0 + start))));
    }
    all
}

/// Ties all vertices at the same position.
fn ties(mesh: &Mesh) -> Locks {
    let mut places: HashMap<_, Vec<VertexId>> = HashMap::new();
    for (v, position) in mesh.positions.iter().enumerate() {
        places.entry(position.map(f64::to_bits)).or_default().push(VertexId::new(v));
    }
    let mut ties: Vec<_> = places.into_values().filter(|tie| tie.len() > 1).collect();
    ties.sort();
    Locks { ties, ..Locks::default() }
}

/// Two boxes that share a side, and a smaller one on top of both.
fn three_boxes(n: i32) -> Mesh {
    beside(&[
        boxed([n; 3], [0; 3]),
        boxed([n; 3], [n, 0, 0]),
        boxed([n, n / 2, n / 2], [n / 2, 0, n]),
    ])
}

/// Two tiles of hilly ground that share a border.
fn two_tiles(n: u32) -> Mesh {
    let tile = |start: u32| {
        let at = |x: u32, y: u32| VertexId(y * (n + 1) + x);
        let height = |x: f64, y: f64| (0.9 * x).sin() * (0.7 * y).cos() + 0.3 * (2.3 * x + y).sin();
        let positions = (0..(n + 1) * (n + 1)).map(|i| {
            let [x, y] = [start + i % (n + 1), i / (n + 1)].map(|x| f64::from(x) * 0.4);
            [x, y, height(x, y)]
        });
        let squares = (0..n * n).map(|i| (i % n, i / n));
        let faces = squares.flat_map(|(x, y)| {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            [[a, b, c], [a, c, d]]
        });
        Mesh::new(positions.collect(), faces.collect())
    };
    beside(&[tile(0), tile(n)])
}

/// Final vertex of every vertex, and its position.
struct Trace {
    into: HashMap<VertexId, VertexId>,
    at: Vec<[f64; 3]>,
}

impl Trace {
    fn new(mesh: &Mesh) -> Self {
        Self { into: HashMap::new(), at: mesh.positions.clone() }
    }

    fn end(&self, mut v: VertexId) -> [f64; 3] {
        while let Some(&next) = self.into.get(&v) {
            v = next;
        }
        self.at[v.index()]
    }

    /// Ties whose vertices are apart.
    fn torn<'l>(&self, locks: &'l Locks) -> Option<&'l Vec<VertexId>> {
        let at = |v: &VertexId| self.end(*v).map(f64::to_bits);
        locks.ties.iter().find(|tie| tie.iter().any(|v| at(v) != at(&tie[0])))
    }
}

impl Observe for Trace {
    fn before(&mut self, _: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let kept = neighbourhood.contracted()[placed.kept];
        let gone = neighbourhood.contracted().iter().filter(|&&v| v != kept);
        self.into.extend(gone.map(|&v| (v, kept)));
        self.at[kept.index()] = placed.position.into();
    }
}

fn defects(mesh: &Mesh) -> [usize; 3] {
    let c = Connectivity::new(&mesh.faces, mesh.positions.len());
    let components = face_components(&mesh.faces, mesh.positions.len()).1;
    [c.boundary_edges(), c.non_manifold_edges(), components]
}

/// Runs with all ties, checks that they hold, and returns the level.
fn tied_run(mesh: &Mesh, method: Method, ratio: f64) -> Mesh {
    let locks = ties(mesh);
    let options = Options { method, locks: locks.clone(), ..Options::default() };
    let mut simplifier = Simplifier::new(mesh, &options).unwrap();
    let mut trace = Trace::new(mesh);
    let report = simplifier.run(Target::Ratio(ratio), &mut trace).unwrap();
    assert_eq!(report.held.tied, locks.ties.iter().map(Vec::len).sum::<usize>());
    assert_eq!(trace.torn(&locks), None, "{} to {ratio}", method.name());
    simplifier.level()
}

#[test]
fn touching_boxes_stay_touching() {
    let mesh = three_boxes(8);
    for method in Method::ALL {
        for ratio in [0.5, 0.1, 0.0] {
            let level = tied_run(&mesh, method, ratio);
            assert_eq!(defects(&level), defects(&mesh), "{}", method.name());
            let most = (mesh.faces.len() as f64 * ratio).max(20.0);
            assert!(level.faces.len() as f64 <= most, "{} stays", method.name());
        }
    }
}

/// Boundary edges inside the ground, by their ends, with their counts.
fn seams_inside(level: &Mesh, border: f64) -> HashMap<[[u64; 3]; 2], usize> {
    let mut count = HashMap::new();
    let mut edges: HashMap<[VertexId; 2], usize> = HashMap::new();
    for face in &level.faces {
        for k in 0..3 {
            let mut edge = [face[k], face[(k + 1) % 3]];
            edge.sort();
            *edges.entry(edge).or_default() += 1;
        }
    }
    for (edge, _) in edges.into_iter().filter(|&(_, faces)| faces == 1) {
        let ends = edge.map(|v| level.positions[v.index()]);
        if ends.iter().all(|p| (p[0] - border).abs() < 0.2) {
            let mut ends = ends.map(|p| p.map(f64::to_bits));
            ends.sort();
            *count.entry(ends).or_default() += 1;
        }
    }
    count
}

#[test]
fn tiles_show_no_crack() {
    let n = 24;
    let mesh = two_tiles(n);
    let border = f64::from(n) * 0.4;
    for method in Method::ALL {
        for ratio in [0.5, 0.1, 0.03] {
            let level = tied_run(&mesh, method, ratio);
            let seams = seams_inside(&level, border);
            assert!(seams.values().all(|&count| count == 2), "{}: {seams:?}", method.name());
            // The border has been coarsened and still exists.
            assert!((1..n as usize).contains(&seams.len()), "{}: {}", method.name(), seams.len());
        }
    }
}

proptest! {
    /// Boxes at random positions, touching, nested or duplicated, with some tied vertices also
    /// locked.
    #[test]
    fn whatever_is_tied_stays_together(
        boxes in prop::collection::vec(
            (prop::array::uniform3(1i32..5), prop::array::uniform3(0i32..4)), 2..5),
        locks in prop::collection::vec(0u8..8, 400),
        method in prop::sample::select(&Method::ALL[..]),
        ratio in 0.0..0.8f64,
    ) {
        let boxes: Vec<_> = boxes.into_iter().map(|(n, start)| boxed(n, start)).collect();
        let mesh = beside(&boxes);
        let lock = |v: usize| match locks[v % locks.len()] {
            0 => Lock::Locked,
            1 => Lock::Protected,
            _ => Lock::Free,
        };
        let of_vertex = (0..mesh.positions.len()).map(lock).collect();
        let locks = Locks { of_vertex, ..ties(&mesh) };
        let topology = Topology::Keep;
        let options = Options { method, locks: locks.clone(), topology, ..Options::default() };
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        let mut trace = Trace::new(&mesh);
        simplifier.run(Target::Ratio(ratio), &mut trace).unwrap();
        prop_assert_eq!(trace.torn(&locks), None);
        for (v, _) in locks.of_vertex.iter().enumerate().filter(|&(_, &lock)| lock == Lock::Locked) {
            prop_assert!(!trace.into.contains_key(&VertexId::new(v)));
            prop_assert_eq!(trace.at[v], mesh.positions[v]);
        }
        let level = simplifier.level();
        level.validate().unwrap();
        prop_assert_eq!(defects(&level), defects(&mesh));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    /// Soups of few positions, where a surface touches itself at nearly every vertex.
    #[test]
    fn what_touches_itself_gets_no_worse(
        positions in prop::collection::vec(prop::array::uniform3(0i8..3), 6..24),
        raw in prop::collection::vec(prop::array::uniform3(0u32..24), 4..50),
        method in prop::sample::select(&Method::ALL[..]),
    ) {
        let count = positions.len() as u32;
        let mesh = Mesh::new(
            positions.iter().map(|p| p.map(f64::from)).collect(),
            raw.iter().map(|face| face.map(|v| VertexId(v % count))).collect(),
        );
        let locks = ties(&mesh);
        let topology = Topology::Keep;
        let options = Options { method, locks: locks.clone(), topology, ..Options::default() };
        // If every face is degenerate, there is nothing to keep.
        if let Ok(mut simplifier) = Simplifier::new(&mesh, &options) {
            let before = defects(&simplifier.level());
            let mut trace = Trace::new(&mesh);
            simplifier.run(Target::Faces(0), &mut trace).unwrap();
            prop_assert_eq!(trace.torn(&locks), None);
            let level = simplifier.level();
            level.validate().unwrap();
            let after = defects(&level);
            prop_assert!(after[0] <= before[0] && after[1] <= before[1], "{before:?} {after:?}");
            prop_assert_eq!(after[2], before[2]);
        }
    }
}

#[test]
fn what_was_contracted_together_comes_back_to_the_bit() {
    let mesh = three_boxes(6);
    for method in Method::ALL {
        let options = Options { method, locks: ties(&mesh), ..Options::default() };
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        let mut history = History::default();
        let mut levels = vec![simplifier.level()];
        for ratio in [0.6, 0.3, 0.05] {
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
fn a_third_object_that_cannot_follow_stays_where_it_touches() {
    // The corner of the third box lies in the middle of the side shared by the other two.
    let mesh = beside(&[boxed([4; 3], [0; 3]), boxed([4; 3], [4, 0, 0]), boxed([1; 3], [4, 4, 2])]);
    for method in Method::ALL {
        let level = tied_run(&mesh, method, 0.0);
        let components = face_components(&level.faces, level.positions.len()).0;
        let mut at_place: HashMap<_, Vec<u32>> = HashMap::new();
        for (face, &component) in level.faces.iter().zip(&components) {
            for v in face {
                at_place
                    .entry(level.positions[v.index()].map(f64::to_bits))
                    .or_default()
                    .push(component);
            }
        }
        let all_three = at_place.values().any(|of| (0..3).all(|component| of.contains(&component)));
        assert!(all_three, "{}", method.name());
    }
}

#[test]
fn surfaces_that_are_cut_otherwise_stay_together() {
    // The diagonals of the second sheet run the other way.
    let sheet = |turn: bool| {
        let at = |x: u32, y: u32| VertexId(y * 5 + x);
        let positions = (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5), 0.0]);
        let faces = (0..16).map(|i| (i % 4, i / 4)).flat_map(|(x, y)| {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            if turn { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
        });
        Mesh::new(positions.collect(), faces.collect())
    };
    let mesh = beside(&[sheet(false), sheet(true)]);
    for method in Method::ALL {
        let level = tied_run(&mesh, method, 0.0);
        assert!(level.faces.len() < mesh.faces.len(), "{} stays", method.name());
    }
}

/// Torus of which half is locked in some way.
fn halved(lock: Lock) -> (Mesh, Locks) {
    let mesh = samples::torus(2000);
    let of = |p: &[f64; 3]| if p[0] > 0.0 { lock } else { Lock::Free };
    let locks = Locks { of_vertex: mesh.positions.iter().map(of).collect(), ties: Vec::new() };
    (mesh, locks)
}

#[test]
fn what_is_protected_goes_last_and_is_not_safe() {
    let (mesh, locks) = halved(Lock::Protected);
    for method in Method::ALL {
        let share = |locks: &Locks, ratio| {
            let options = Options { method, locks: locks.clone(), ..Options::default() };
            let (level, report) = contract_to(&mesh, Target::Ratio(ratio), &options).unwrap();
            assert!(report.reached);
            let there = level.positions.iter().filter(|p| p[0] > 0.01).count();
            there as f64 / level.positions.len() as f64
        };
        let (with, without) = (share(&locks, 0.6), share(&Locks::default(), 0.6));
        assert!(with > without + 0.05, "{}: {with} {without}", method.name());
        // At the end only protected vertices are left to contract.
        assert!(share(&locks, 0.02) < 1.0);
    }
}

#[test]
fn both_engines_protect_as_much() {
    let (mesh, locks) = halved(Lock::Protected);
    let cases = [Method::LindstromTurk, Method::Qem]
        .into_iter()
        .flat_map(|method| [0.6, 0.3, 0.1].map(|ratio| (method, ratio)));
    for (method, ratio) in cases {
        let options = Options { method, locks: locks.clone(), ..Options::default() };
        let [kernel, policies] = [true, false].map(|on_kernel| {
            let start = if on_kernel { Simplifier::new } else { Simplifier::on_policy_engine };
            let mut simplifier = start(&mesh, &options).unwrap();
            simplifier.run(Target::Ratio(ratio), &mut ()).unwrap();
            let level = simplifier.level();
            let there = level.positions.iter().filter(|p| p[0] > 0.01).count();
            there as f64 / level.positions.len() as f64
        });
        assert!((kernel - policies).abs() < 0.05, "{ratio}: {kernel} {policies}");
    }
}

#[test]
fn an_error_bound_ignores_the_cost_of_protection() {
    let (mesh, locks) = halved(Lock::Protected);
    for method in Method::ALL {
        let faces = |locks: &Locks| {
            let options = Options { method, locks: locks.clone(), ..Options::default() };
            let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
            let report = simplifier.run(Target::Error(0.02), &mut ()).unwrap();
            assert!(report.error_estimate <= 0.02);
            simplifier.live_faces() as f64
        };
        let ratio = faces(&locks) / faces(&Locks::default());
        assert!((0.85..1.2).contains(&ratio), "{}: {ratio}", method.name());
    }
}

#[test]
fn locks_of_another_mesh_are_refused_by_name() {
    let mesh = boxed([1; 3], [0; 3]);
    let refused = |of_vertex: Vec<Lock>, ties: &[&[u32]]| {
        let ties = ties.iter().map(|tie| tie.iter().copied().map(VertexId).collect()).collect();
        let options = Options { locks: Locks { of_vertex, ties }, ..Options::default() };
        contract_to(&mesh, Target::Ratio(0.5), &options).err()
    };
    let [v0, v1, v8] = [0, 1, 8].map(VertexId);
    assert_eq!(
        refused(vec![Lock::Locked; 7], &[]),
        Some(SimplifyError::LockCount { found: 7, expected: 8 })
    );
    assert_eq!(
        refused(vec![], &[&[], &[0, 8]]),
        Some(SimplifyError::BadTie { tie: 1, vertex: v8, count: 8 })
    );
    assert_eq!(refused(vec![], &[&[0, 0]]), Some(SimplifyError::TiedTwice { tie: 0, vertex: v0 }));
    assert_eq!(
        refused(vec![], &[&[1], &[1]]),
        Some(SimplifyError::TiedTwice { tie: 1, vertex: v1 })
    );
    assert_eq!(
        refused(vec![], &[&[0, 1]]),
        Some(SimplifyError::TornTie { tie: 0, vertices: [v0, v1] })
    );
    assert_eq!(refused(vec![], &[&[], &[3]]), None);
}

#[test]
fn a_crowd_at_one_place_stays_there() {
    // Many needles with their tips at one position.
    let needle = |i: u32| {
        let (y, x) = (f64::from(i) * 0.1).sin_cos();
        let base = [[x, y, 1.0], [x, y, 1.2], [x * 1.1, y * 1.1, 1.1]];
        let positions = [[0.0; 3]].into_iter().chain(base).collect();
        let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        Mesh::new(positions, faces.map(|face| face.map(VertexId)).to_vec())
    };
    let mesh = beside(&(0..3000).map(needle).collect::<Vec<_>>());
    let tips = (0..3000).map(|i| VertexId(4 * i)).collect();
    let options =
        Options { locks: Locks { ties: vec![tips], ..Locks::default() }, ..Options::default() };
    let (level, report) = contract_to(&mesh, Target::Faces(0), &options).unwrap();
    assert_eq!((report.held.tied, report.held.locked), (0, 3000));
    assert_eq!(level.positions.iter().filter(|p| **p == [0.0; 3]).count(), 3000);
}

#[test]
fn the_more_protected_a_side_is_the_finer_it_stays() {
    let ball = meshlod_samples::sphere(4_000);
    let of_vertex = ball.positions.iter().map(|p| match p[0] > 0.0 {
        true => meshlod_mesh::Lock::Protected,
        false => meshlod_mesh::Lock::Free,
    });
    let locks = meshlod_mesh::Locks { of_vertex: of_vertex.collect(), ties: Vec::new() };
    for method in [Method::LindstromTurk, Method::Qem, Method::QemEndpoint] {
        let kept = |protection| {
            let options =
                Options { method, protection, locks: locks.clone(), ..Options::default() };
            let (level, _) = contract_to(&ball, Target::Ratio(0.25), &options).unwrap();
            level.positions.iter().filter(|p| p[0] > 0.0).count() as f64
                / level.positions.len() as f64
        };
        let shares = [Some(1.0), None, Some(8.0)].map(kept);
        assert!((shares[0] - 0.5).abs() < 0.05, "{method:?}: {shares:?}");
        assert!(shares[1] > shares[0] + 0.05 && shares[2] > shares[1], "{method:?}: {shares:?}");
    }
    let bad = Options { protection: Some(f64::NAN), ..Options::default() };
    assert!(contract_to(&ball, Target::Ratio(0.5), &bad).is_err());
}
