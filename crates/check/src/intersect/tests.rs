//! Compares the search with testing all pairs.

use std::collections::BTreeSet;

use meshlod_mesh::{Connectivity, Labels, Mesh};
use meshlod_samples as samples;

use super::*;
use crate::{CheckOptions, Finding, Kind, Kinds, UniquePositions, findings};

/// Pseudorandom numbers, the same on every run [SLF14].
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ z >> 31) % n
    }
}

/// Returns the pairs that the check finds.
fn found(mesh: &Mesh, broad_phase: BroadPhase) -> BTreeSet<[FaceId; 2]> {
    let kinds = Kinds::NONE.with(Kind::SelfIntersection).with(Kind::Contact);
    let options = CheckOptions { kinds, broad_phase, ..CheckOptions::default() };
    let faces = |finding: Finding| match finding {
        Finding::SelfIntersection { mut faces, .. } | Finding::Contact { mut faces, .. } => {
            faces.sort_unstable();
            faces
        }
        other => panic!("not asked for: {other:?}"),
    };
    findings(mesh, &options).into_iter().map(faces).collect()
}

/// Returns the number of positions that two faces share, and the kind of their intersection.
fn intersected(mesh: &Mesh, [f, g]: [usize; 2]) -> (usize, Option<IntersectionKind>) {
    let [a, b] = [f, g].map(|f| mesh.triangle(mesh.faces[f]));
    let shared = a.iter().filter(|p| b.contains(p)).count();
    (shared, intersect(&a, &b).map(|found| found.kind))
}

/// Compares the findings with tests of all pairs of faces, which must not contain duplicates.
fn compare(mesh: &Mesh) {
    let found = found(mesh, BroadPhase::Tree);
    assert_eq!(found, self::found(mesh, BroadPhase::Octree));
    let objects = crate::Objects::of(mesh, crate::ObjectsBy::Auto).of_face;
    let mut expected_objects = BTreeSet::new();
    for f in 0..mesh.faces.len() {
        for g in f + 1..mesh.faces.len() {
            let pair = [f, g].map(FaceId::new);
            let (shared, kind) = intersected(mesh, [f, g]);
            let more = match shared {
                0 => kind.is_some(),
                1 => kind > Some(IntersectionKind::Point),
                _ => kind > Some(IntersectionKind::Segment),
            };
            let apart = objects[f] == objects[g];
            if more || (apart && found.contains(&pair)) {
                assert!(more && found.contains(&pair), "{pair:?}: {shared} shared, {kind:?}");
            }
            if kind.is_some() {
                expected_objects.insert([objects[f].min(objects[g]), objects[f].max(objects[g])]);
            } else {
                assert!(!found.contains(&pair), "{pair:?}");
            }
        }
    }
    let mut met = BTreeSet::new();
    for pair in found {
        let [a, b] = pair.map(|f| objects[f.index()]);
        met.insert([a.min(b), a.max(b)]);
    }
    expected_objects.retain(|[a, b]| a != b);
    met.retain(|[a, b]| a != b);
    assert_eq!(met, expected_objects);
}

/// Builds a triangle soup with `spread` vertices at random points of a grid.
fn soup(seed: u64, faces: usize, grid: u64, spread: usize) -> Mesh {
    let mut random = Random(seed);
    let positions: Vec<[f64; 3]> =
        (0..spread).map(|_| [(); 3].map(|()| random.below(grid) as f64 / 8.0)).collect();
    let mut seen = BTreeSet::new();
    let mut kept = Vec::new();
    while kept.len() < faces {
        let face = [(); 3].map(|()| VertexId(random.below(spread as u64) as u32));
        let mut at = face.map(|v| positions[v.index()].map(f64::to_bits));
        at.sort_unstable();
        if seen.insert(at) {
            kept.push(face);
        }
    }
    let mut mesh = Mesh::new(positions, kept);
    if random.below(2) == 0 {
        let of_face = (0..faces).map(|_| random.below(3) as u32).collect();
        mesh.objects = Some(Labels { names: ["a", "b", "c"].map(String::from).to_vec(), of_face });
    }
    mesh
}

#[test]
fn soups_are_searched_as_all_pairs_would_be() {
    for seed in 0..120 {
        let (faces, grid, spread) = [(40, 4, 30), (100, 12, 200), (60, 40, 40)][seed as usize % 3];
        compare(&soup(seed, faces, grid, spread));
    }
}

#[test]
fn rough_surfaces_are_searched_as_all_pairs_would_be() {
    for (seed, size) in [(0, 0.0), (1, 0.02), (2, 0.1), (3, 0.3)] {
        let mut random = Random(seed);
        let mut mesh = samples::torus(500);
        for x in mesh.positions.iter_mut().flatten() {
            *x += (random.below(1000) as f64 / 1000.0 - 0.5) * size;
        }
        compare(&mesh);
    }
}

#[test]
fn both_broad_phases_agree_on_real_meshes() {
    for name in ["fish-clown.obj", "skyscraper.obj", "squirrel-20k.obj", "cow-2903.obj", "city.glb"]
    {
        let Some(path) = meshlod_fixtures::shared_mesh(name) else { continue };
        let mesh = meshlod_io::read(&path, &Default::default()).unwrap().flatten();
        assert_eq!(found(&mesh, BroadPhase::Tree), found(&mesh, BroadPhase::Octree), "{name}");
    }
}

#[test]
fn samples_do_not_intersect_themselves() {
    for (name, faces) in [("sphere", 3000), ("torus", 3000), ("knot", 6000), ("gyroid", 9000)] {
        let mesh = samples::by_name(name, Some(faces)).unwrap();
        assert!(found(&mesh, BroadPhase::Tree).is_empty(), "{name}");
    }
}

/// Builds `count` faces with one corner at the origin and two vertices of their own, at most
/// `width` apart.
fn star(seed: u64, count: u32, width: f64) -> Mesh {
    let mut random = Random(seed);
    let mut number = || random.below(1 << 20) as f64 / f64::from(1 << 19) - 1.0;
    let mut positions = vec![[0.0; 3]];
    for _ in 0..count {
        let at = [(); 3].map(|()| number());
        positions.push(at);
        positions.push(at.map(|x| x + width * number()));
    }
    let face = |i| [0, 2 * i + 1, 2 * i + 2].map(VertexId);
    Mesh::new(positions, (0..count).map(face).collect())
}

#[test]
fn many_faces_around_a_vertex_are_searched_as_all_pairs_would_be() {
    for (seed, width, least) in [(1, 1e-3, 0), (2, 0.3, 100), (3, 2.0, 1000)] {
        let mesh = star(seed, 300, width);
        compare(&mesh);
        assert!(found(&mesh, BroadPhase::Tree).len() >= least);
    }
}

/// Returns the pairs found within some limits and whether the search was complete.
fn searched(mesh: &Mesh, limits: Limits) -> (Vec<[FaceId; 2]>, bool) {
    let objects = crate::Objects::of(mesh, crate::ObjectsBy::Auto);
    let ground = SearchInput {
        positions: &mesh.positions,
        faces: &mesh.faces,
        connectivity: &Connectivity::new(&mesh.faces, mesh.positions.len()),
        unique: &UniquePositions::of(&mesh.positions),
        objects: &objects,
    };
    let meetings = IntersectingPairs::within(&ground, BroadPhase::Tree, limits);
    (meetings.pairs().to_vec(), meetings.complete())
}

#[test]
fn a_high_valence_vertex_costs_little() {
    let few = Limits { tests: 3_000_000, kept: 100_000 };
    // Around a cone and in all directions: the first ring is certified, the second is not.
    let count = 60_000;
    let turn = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(count);
    let rim = (0..count).map(|i| [turn(i).cos(), turn(i).sin(), -0.5]);
    let positions: Vec<[f64; 3]> = [[0.0; 3]].into_iter().chain(rim).collect();
    let face = |i: u32| [0, 1 + i, 1 + (i + 1) % count].map(VertexId);
    let cone = Mesh::new(positions, (0..count).map(face).collect());
    assert_eq!(searched(&cone, few), (vec![], true));
    let (pairs, complete) = searched(&star(4, count, 1e-3), few);
    assert!(complete && pairs.len() < 5000);
}

#[test]
fn if_all_faces_cross_the_search_gives_up_and_reports_it() {
    // Long faces through one ball.
    let mut mesh = soup(7, 2000, 1000, 6000);
    mesh.objects = None;
    let (all, complete) = searched(&mesh, Limits::of(2000));
    assert!(complete && all.len() > 50_000);
    for limits in [Limits { tests: 1000, kept: 1 << 20 }, Limits { tests: 1 << 40, kept: 2000 }] {
        let (some, complete) = searched(&mesh, limits);
        assert!(!complete && !some.is_empty() && some.len() <= 2000);
        assert!(some.iter().all(|pair| all.binary_search(pair).is_ok()));
    }
}

#[test]
fn size_does_not_matter() {
    let mesh = soup(11, 100, 12, 200);
    let pairs = found(&mesh, BroadPhase::Tree);
    assert!(pairs.len() > 10);
    for exponent in [-1000, -500, -200, 200, 500, 1000] {
        let mut scaled = mesh.clone();
        for x in scaled.positions.iter_mut().flatten() {
            *x *= 2f64.powi(exponent);
        }
        assert_eq!(found(&scaled, BroadPhase::Tree), pairs, "2^{exponent}");
        assert_eq!(found(&scaled, BroadPhase::Octree), pairs, "2^{exponent}");
    }
}
