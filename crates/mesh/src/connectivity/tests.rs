use proptest::prelude::*;

use super::*;

fn faces(raw: &[[u32; 3]]) -> Vec<[VertexId; 3]> {
    raw.iter().map(|face| face.map(VertexId)).collect()
}

fn connect(raw: &[[u32; 3]]) -> Connectivity {
    let count = raw.iter().flatten().max().map_or(0, |&v| v as usize + 1);
    Connectivity::new(&faces(raw), count)
}

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

#[test]
fn a_tetrahedron_is_closed() {
    let c = connect(&TETRAHEDRON);
    assert!(c.is_closed());
    assert_eq!((c.edge_count(), c.edges().count(), c.inconsistent_edges()), (6, 6, 0));
    assert_eq!(c.star(VertexId(0)), [FaceId(0), FaceId(1), FaceId(3)]);
}

#[test]
fn twins_are_mutual_and_share_their_ends() {
    let f = faces(&TETRAHEDRON);
    let c = connect(&TETRAHEDRON);
    for side in c.edges() {
        let Twin::Side(twin) = c.twin(side) else { panic!("{side:?} has no twin") };
        assert_eq!(c.twin(twin), Twin::Side(side));
        let [a, b] = side.ends(&f);
        assert_eq!(twin.ends(&f), [b, a]);
    }
}

#[test]
fn a_lone_triangle_is_all_boundary() {
    let c = connect(&[[0, 1, 2]]);
    assert_eq!((c.boundary_edges(), c.is_closed()), (3, false));
    assert!(c.marks(VertexId(1)).boundary() && !c.marks(VertexId(1)).non_manifold());
}

#[test]
fn three_faces_on_an_edge_are_marked() {
    let c = connect(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    assert_eq!((c.non_manifold_edges(), c.boundary_edges()), (1, 6));
    assert!(c.marks(VertexId(0)).non_manifold() && !c.marks(VertexId(2)).non_manifold());
    assert_eq!(c.twin(Side::new(FaceId(0), 0)), Twin::NonManifold);
}

#[test]
fn two_tetrahedra_in_one_vertex_pinch_it() {
    let mut raw = TETRAHEDRON.to_vec();
    raw.extend(TETRAHEDRON.map(|face| face.map(|v| if v == 0 { 0 } else { v + 3 })));
    let c = connect(&raw);
    assert!(c.is_closed() && c.marks(VertexId(0)).pinched());
    assert_eq!(c.pinched_vertices(), 1);
}

#[test]
fn a_turned_face_makes_its_edges_inconsistent() {
    let mut raw = TETRAHEDRON;
    raw[0].swap(0, 1);
    let c = connect(&raw);
    assert!(c.is_closed());
    assert_eq!(c.inconsistent_edges(), 3);
}

#[test]
fn a_face_that_repeats_a_vertex_is_left_out() {
    let c = connect(&[[0, 1, 2], [2, 2, 1]]);
    assert_eq!((c.degenerate_faces(), c.boundary_edges()), (1, 3));
    assert_eq!(c.twin(Side::new(FaceId(1), 0)), Twin::Degenerate);
}

/// Counts by brute force what one edge of the mesh is.
fn oracle(raw: &[[u32; 3]]) -> (usize, usize, usize) {
    let mut edges = std::collections::BTreeMap::<(u32, u32), usize>::new();
    for &[a, b, c] in raw {
        if a != b && b != c && c != a {
            for (s, t) in [(a, b), (b, c), (c, a)] {
                *edges.entry((s.min(t), s.max(t))).or_default() += 1;
            }
        }
    }
    let count = |keep: fn(usize) -> bool| edges.values().filter(|&&n| keep(n)).count();
    (edges.len(), count(|n| n == 1), count(|n| n > 2))
}

/// Every vertex by the way that takes any star.
fn plainly(faces: &[[VertexId; 3]], vertex_count: usize) -> Connectivity {
    let mut connectivity = Connectivity::stars_only(faces, vertex_count);
    let mut scratch = Scratch::default();
    for v in 0..vertex_count {
        connectivity.connect(faces, VertexId(v as u32), &mut scratch);
    }
    connectivity
}

/// Faces of a closed grid, wrapped in both directions: 60 vertices, 120 faces.
fn torus() -> Vec<[VertexId; 3]> {
    let id = |i: u32, j: u32| i % 10 + j % 6 * 10;
    let cells = (0..6).flat_map(|j| (0..10).map(move |i| [i, j]));
    let split = |[i, j]: [u32; 2]| {
        let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    faces(&cells.flat_map(split).collect::<Vec<_>>())
}

/// A closed mesh with some faces turned, dropped, doubled or led astray.
fn spoilt(harm: &[(usize, u8, u32)]) -> Vec<[VertexId; 3]> {
    let mut faces = torus();
    for &(at, what, v) in harm {
        let at = at % faces.len();
        match what {
            0 => faces[at].swap(0, 1),
            1 => faces.push(faces[at]),
            2 => faces[at][0] = VertexId(v),
            _ => drop(faces.remove(at)),
        }
    }
    faces
}

proptest! {
    #[test]
    fn closed_fans_are_connected_as_any_others(
        harm in prop::collection::vec((0..usize::MAX, 0u8..4, 0u32..60), 0..6),
    ) {
        let faces = spoilt(&harm);
        let (quick, plain) = (Connectivity::new(&faces, 64), plainly(&faces, 64));
        prop_assert_eq!(&quick.twins, &plain.twins);
        prop_assert_eq!((&quick.marks, quick.edges), (&plain.marks, plain.edges));
    }

    #[test]
    fn any_faces_give_the_oracle_s_counts(
        raw in prop::collection::vec(prop::array::uniform3(0u32..9), 0..40),
    ) {
        let c = Connectivity::new(&faces(&raw), 9);
        let found = (c.edge_count(), c.boundary_edges(), c.non_manifold_edges());
        prop_assert_eq!(found, oracle(&raw));
    }
}
