//! Two hundred scenes whose contacts are known by construction: all are found and none invented.
//!
//! Coordinates are small multiples of 2^-30, transformed by integer matrices and powers of two, so
//! that solids that touch do so to the last bit.

use std::collections::BTreeMap;

use meshlod_check::{
    BroadPhase, CheckOptions, Finding, IntersectionKind, Kind, Kinds, ObjectId, findings,
};
use meshlod_mesh::{Labels, Mesh, VertexId};

const BROAD_PHASES: [BroadPhase; 2] = [BroadPhase::Tree, BroadPhase::Octree];
const SCENES: u64 = 200;
/// Gap of near misses: 1e-9 for solids about 1 wide.
const GAP: f64 = 1.0 / (1 << 30) as f64;

/// A closed solid.
#[derive(Clone)]
struct Solid {
    points: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
}

/// Two solids and the expected number of findings of each kind.
struct Recipe {
    name: &'static str,
    solids: [Solid; 2],
    expected: &'static [(IntersectionKind, usize)],
}

impl Solid {
    fn new<const N: usize>(points: [[f64; 3]; N], faces: &[[u32; 3]]) -> Self {
        Self { points: points.to_vec(), faces: faces.to_vec() }
    }

    /// Builds a tetrahedron; it points outwards if the first three corners are counter-clockwise
    /// seen from the side opposite the fourth.
    fn tetrahedron(points: [[f64; 3]; 4]) -> Self {
        Self::new(points, &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
    }

    fn cuboid([x, y, z]: [f64; 3], [u, v, w]: [f64; 3]) -> Self {
        let below = [[x, y, z], [u, y, z], [u, v, z], [x, v, z]];
        let above = below.map(|[x, y, _]| [x, y, w]);
        let [a, b, c, d] = below;
        let [e, f, g, h] = above;
        let sides = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let quads = [[0, 3, 2, 1], [4, 5, 6, 7]].into_iter().chain(sides);
        let faces: Vec<[u32; 3]> = quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Self::new([a, b, c, d, e, f, g, h], &faces)
    }

    /// Builds an octahedron with its corners at `radius` along the axes.
    fn octahedron([x, y, z]: [f64; 3], radius: f64) -> Self {
        let [l, r] = [[x - radius, y, z], [x + radius, y, z]];
        let [n, s] = [[x, y - radius, z], [x, y + radius, z]];
        let [b, t] = [[x, y, z - radius], [x, y, z + radius]];
        let upper = [[1, 3, 5], [3, 0, 5], [0, 2, 5], [2, 1, 5]];
        let lower = upper.map(|[a, b, _]| [b, a, 4]);
        Self::new([l, r, n, s, b, t], &[upper, lower].concat())
    }

    fn moved(mut self, by: [f64; 3]) -> Self {
        for point in &mut self.points {
            for (x, d) in point.iter_mut().zip(by) {
                *x += d;
            }
        }
        self
    }
}

/// Builds a table whose upper side is two large triangles at z = 0, separated by x = y.
fn table() -> Solid {
    Solid::cuboid([-1.0, -1.0, -0.5], [1.0, 1.0, 0.0])
}

/// A tetrahedron with its tip at the origin and three corners above, over the triangle below x = y.
fn tip() -> Solid {
    let above = [[0.25, -0.5, 0.5], [0.75, -0.5, 0.5], [0.5, -0.25, 0.5]];
    let [a, b, c] = above;
    Solid::tetrahedron([a, c, b, [0.5, -0.4375, 0.0]])
}

/// A roof upside down: its ridge lies along x at z = 0, over the triangle below x = y.
fn ridge() -> Solid {
    let [y, z] = [-0.5, 0.25];
    Solid::new(
        [
            [0.25, y, 0.0],
            [0.625, y, 0.0],
            [0.25, y - 0.125, z],
            [0.625, y - 0.125, z],
            [0.25, y + 0.125, z],
            [0.625, y + 0.125, z],
        ],
        &[[0, 2, 3], [0, 3, 1], [0, 5, 4], [0, 1, 5], [2, 4, 5], [2, 5, 3], [0, 4, 2], [1, 3, 5]],
    )
}

/// A roof whose ridge lies along y at z = 0, below.
fn ridge_across() -> Solid {
    let x = 0.5;
    Solid::new(
        [
            [x, -0.75, 0.0],
            [x, -0.25, 0.0],
            [x - 0.125, -0.75, -0.25],
            [x - 0.125, -0.25, -0.25],
            [x + 0.125, -0.75, -0.25],
            [x + 0.125, -0.25, -0.25],
        ],
        &[[0, 1, 3], [0, 3, 2], [0, 4, 5], [0, 5, 1], [2, 3, 5], [2, 5, 4], [0, 2, 4], [1, 5, 3]],
    )
}

fn recipes() -> Vec<Recipe> {
    use IntersectionKind::{Crossing, Overlap, Point, Segment};
    let up = [0.0, 0.0, GAP];
    let cube = Solid::cuboid([0.0; 3], [1.0; 3]);
    let beside = Solid::cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]);
    let tips = || Solid::octahedron([0.0, 0.0, 1.0], 1.0);
    // Its lower side is in one triangle of the table.
    let brick = Solid::cuboid([0.25, -0.75, 0.0], [0.5, -0.5, 0.5]);
    let recipe = |name, a: &Solid, b: &Solid, expected| Recipe {
        name,
        solids: [a.clone(), b.clone()],
        expected,
    };
    vec![
        recipe(
            "tips at one place",
            &Solid::octahedron([0.0, 0.0, -1.0], 1.0),
            &tips(),
            &[(Point, 1)],
        ),
        recipe("an edge at one place", &cube, &beside, &[(Segment, 1)]),
        recipe("a tip on a face", &table(), &tip(), &[(Point, 3)]),
        recipe("a ridge on a face", &table(), &ridge(), &[(Point, 4), (Segment, 2)]),
        recipe("ridges that cross", &ridge_across(), &ridge(), &[(Point, 4)]),
        recipe(
            "a tip through a face",
            &table(),
            &tip().moved([0.0, 0.0, -0.125]),
            &[(Crossing, 3)],
        ),
        recipe("a tip just through", &table(), &tip().moved([0.0, 0.0, -GAP]), &[(Crossing, 3)]),
        recipe("a side on a side", &table(), &brick, &[(Point, 4), (Segment, 4), (Overlap, 2)]),
        recipe("a tip just off a face", &table(), &tip().moved(up), &[]),
        recipe("a ridge just off a face", &table(), &ridge().moved(up), &[]),
        recipe("ridges just apart", &ridge_across(), &ridge().moved(up), &[]),
        recipe("a side just off a side", &table(), &brick.clone().moved(up), &[]),
        recipe(
            "tips just apart",
            &Solid::octahedron([0.0, 0.0, -1.0], 1.0),
            &tips().moved(up),
            &[],
        ),
        recipe("edges just apart", &cube, &beside.moved([GAP, 0.0, 0.0]), &[]),
        recipe("one in the other", &cube, &Solid::octahedron([0.5; 3], 0.25), &[]),
    ]
}

/// Pseudorandom numbers by SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ z >> 31) % bound as u64) as usize
    }
}

/// Returns a rotation, scaled by three or one, with its axes and signs permuted at random.
fn turn(random: &mut Random) -> [[f64; 3]; 3] {
    let rows = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [2.0, 1.0, -2.0]],
        [[-1.0, 2.0, 2.0], [2.0, -1.0, 2.0], [2.0, 2.0, -1.0]],
    ][random.below(3)];
    let first = random.below(3);
    let rows = [0, 1, 2].map(|i| rows[(first + i) % 3]);
    let signs = [0; 3].map(|_| if random.below(2) == 0 { 1.0 } else { -1.0 });
    rows.map(|row| [0, 1, 2].map(|i| signs[i] * row[i]))
}

/// Number of findings by pair of objects and kind of intersection.
type Counts = BTreeMap<([u32; 2], IntersectionKind), usize>;

/// Builds five recipes side by side, faces in random order, with the expected findings.
fn scene(seed: u64) -> (Mesh, Counts) {
    let (mut random, recipes) = (Random(seed), recipes());
    let scale = 2.0_f64.powi(random.below(40) as i32 - 20);
    let (mut points, mut faces, mut expected) = (Vec::new(), Vec::new(), Counts::new());
    for stand in 0..5 {
        // Every recipe occurs, whatever the seeds.
        let recipe = &recipes[(5 * seed as usize + stand) % recipes.len()];
        let turn = turn(&mut random);
        let at = [64 * stand, random.below(64), random.below(64)].map(|x| x as f64);
        for (i, solid) in recipe.solids.iter().enumerate() {
            let base = points.len() as u32;
            let along =
                |row: [f64; 3], p: &[f64; 3]| row.iter().zip(p).map(|(r, x)| r * x).sum::<f64>();
            let place = |p: &[f64; 3]| [0, 1, 2].map(|k| scale * (along(turn[k], p) + at[k]));
            points.extend(solid.points.iter().map(place));
            let object = (2 * stand + i) as u32;
            faces.extend(solid.faces.iter().map(|face| (face.map(|v| VertexId(base + v)), object)));
        }
        let objects = [2 * stand as u32, 2 * stand as u32 + 1];
        expected.extend(recipe.expected.iter().map(|&(kind, count)| ((objects, kind), count)));
    }
    for i in (1..faces.len()).rev() {
        faces.swap(i, random.below(i + 1));
        faces[i].0.rotate_left(random.below(3));
    }
    let (faces, of_face) = faces.into_iter().unzip();
    let names = (0..10).map(|object| format!("solid {object}")).collect();
    let objects = Some(Labels { names, of_face });
    (Mesh { objects, ..Mesh::new(points, faces) }, expected)
}

/// Counts the findings and asserts that their faces belong to their objects.
fn counted(mesh: &Mesh, broad_phase: BroadPhase) -> Counts {
    let kinds = Kinds::NONE.with(Kind::Contact).with(Kind::SelfIntersection);
    let labels = &mesh.objects.as_ref().unwrap().of_face;
    let mut counts = Counts::new();
    for finding in findings(mesh, &CheckOptions { kinds, broad_phase, ..CheckOptions::default() }) {
        let (objects, faces, intersection) = match finding {
            Finding::Contact { objects, faces, intersection } => (objects, faces, intersection),
            Finding::SelfIntersection { object, faces, intersection } => {
                ([object; 2], faces, intersection)
            }
            other => panic!("{other:?} was not requested"),
        };
        assert_eq!(faces.map(|face| ObjectId(labels[face.index()])), objects);
        assert!(
            intersection.point.iter().all(|x| x.is_finite()) && intersection.depth >= 0.0,
            "{intersection:?}"
        );
        *counts.entry((objects.map(|object| object.0), intersection.kind)).or_default() += 1;
    }
    counts
}

#[test]
fn every_contact_is_found_and_none_invented() {
    for (seed, broad_phase) in
        (0..SCENES).flat_map(|seed| BROAD_PHASES.map(|broad_phase| (seed, broad_phase)))
    {
        let (mesh, expected) = scene(seed);
        let first = 5 * seed as usize;
        let names: Vec<_> = (0..5).map(|i| recipes()[(first + i) % recipes().len()].name).collect();
        assert_eq!(
            counted(&mesh, broad_phase),
            expected,
            "{broad_phase:?}, scene {seed}: {names:?}"
        );
    }
}

/// As a single object, faces that cross or overlap are self-intersections, and faces that share
/// positions are not.
#[test]
fn within_one_object_shared_positions_are_no_finding() {
    for seed in 0..20 {
        let (mut mesh, mut expected) = scene(seed);
        let recipes = recipes();
        for stand in 0..5u32 {
            let recipe = &recipes[(5 * seed as usize + stand as usize) % recipes.len()];
            if recipe.name.ends_with("at one place") {
                expected.retain(|(objects, _), _| objects[0] != 2 * stand);
            }
        }
        let labels = mesh.objects.as_mut().unwrap();
        labels.of_face.iter_mut().for_each(|object| *object /= 2);
        let expected =
            expected.into_iter().map(|((o, kind), n)| (([o[0] / 2; 2], kind), n)).collect();
        for broad_phase in BROAD_PHASES {
            assert_eq!(counted(&mesh, broad_phase), expected, "{broad_phase:?}, scene {seed}");
        }
    }
}
