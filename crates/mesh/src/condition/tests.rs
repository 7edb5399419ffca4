use proptest::prelude::*;

use super::*;
use crate::{Attributes, Labels, Layer, LayerKind, Lock, VertexId, WedgeId};

fn mesh(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Mesh {
    Mesh::new(positions.to_vec(), faces.iter().map(|face| face.map(VertexId)).collect())
}

fn conditioned(mesh: &Mesh) -> Option<Conditioned> {
    let conditioned = condition(mesh, &Locks::default(), &ConditionOptions::default())?;
    assert_eq!(conditioned.mesh.validate(), Ok(()));
    Some(conditioned)
}

/// A square grid of `n` by `n` cells at height z.
fn grid(n: u32, z: f64) -> Mesh {
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let positions = (0..=n).flat_map(|i| (0..=n).map(move |j| [f64::from(i), f64::from(j), z]));
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let faces = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    mesh(&positions.collect::<Vec<_>>(), &faces.collect::<Vec<_>>())
}

/// Takes a mesh apart into faces with three vertices each.
fn torn(of: &Mesh) -> Mesh {
    let positions = of.faces.as_flattened().iter().map(|v| of.positions[v.index()]).collect();
    let faces = (0..of.faces.len() as u32).map(|f| [0, 1, 2].map(|k| VertexId(3 * f + k)));
    Mesh::new(positions, faces.collect())
}

fn reversed(faces: &[[VertexId; 3]]) -> Vec<[VertexId; 3]> {
    faces.iter().map(|&[a, b, c]| [c, b, a]).collect()
}

fn connect(mesh: &Mesh) -> Connectivity {
    Connectivity::new(&mesh.faces, mesh.positions.len())
}

fn is_manifold(mesh: &Mesh) -> bool {
    let connectivity = connect(mesh);
    connectivity.non_manifold_edges() == 0
        && connectivity.inconsistent_edges() == 0
        && connectivity.pinched_vertices() == 0
}

#[test]
fn a_clean_mesh_needs_nothing() {
    assert!(conditioned(&grid(4, 0.0)).is_none());
    assert!(conditioned(&Mesh::default()).is_none());
}

#[test]
fn a_torn_grid_is_sewn_up() {
    let whole = grid(5, 0.0);
    let found = conditioned(&torn(&whole)).unwrap();
    let inner = connect(&whole).edge_count() - connect(&whole).boundary_edges();
    assert_eq!(found.counts.stitched_edges, inner);
    assert_eq!(found.counts.stitched_vertices, 3 * 50 - 36);
    assert_eq!(found.counts.split_vertices, 0);
    assert_eq!(connect(&found.mesh).boundary_edges(), 20);
    assert!(is_manifold(&found.mesh));
}

#[test]
fn borders_are_kept_on_request() {
    let options = ConditionOptions { borders: Borders::Keep, ..Default::default() };
    assert!(condition(&torn(&grid(3, 0.0)), &Locks::default(), &options).is_none());
}

#[test]
fn minus_zero_is_zero() {
    let mut torn = torn(&grid(1, 0.0));
    torn.positions[3][0] = -0.0;
    assert_eq!(conditioned(&torn).unwrap().counts.stitched_edges, 1);
}

#[test]
fn the_two_sides_of_a_leaf_are_not_sewn() {
    let mut leaf = grid(3, 0.0);
    let count = leaf.positions.len() as u32;
    let back = reversed(&leaf.faces).into_iter().map(|face| face.map(|v| VertexId(v.0 + count)));
    leaf.faces.extend(back.collect::<Vec<_>>());
    leaf.positions.extend(leaf.positions.clone());
    assert!(conditioned(&leaf).is_none());
}

#[test]
fn a_front_and_its_back_become_two_surfaces() {
    let mut leaf = grid(3, 0.0);
    leaf.faces.extend(reversed(&leaf.faces));
    let found = conditioned(&leaf).unwrap();
    assert_eq!((found.mesh.faces.len(), found.mesh.positions.len()), (36, 32));
    assert_eq!((found.counts.split_vertices, found.counts.duplicate_faces), (16, 0));
    assert!(is_manifold(&found.mesh));
    assert_eq!(connect(&found.mesh).boundary_edges(), 24);
    let mut level = found.mesh.clone();
    found.rejoin(&mut level);
    assert_eq!(level, leaf);
}

#[test]
fn what_repeats_is_left_out_only_with_the_same_material() {
    let mut twice = grid(2, 0.0);
    twice.faces.extend(twice.faces.clone());
    let found = conditioned(&twice).unwrap();
    assert_eq!((found.mesh.faces.len(), found.counts.duplicate_faces), (8, 8));
    let names = ["wall", "poster"].map(String::from).to_vec();
    let of_face = [[0; 8], [1; 8]].concat();
    twice.materials = Some(Labels { names, of_face });
    let found = conditioned(&twice).unwrap();
    assert_eq!((found.mesh.faces.len(), found.counts.duplicate_faces), (16, 0));
    assert!(is_manifold(&found.mesh));
    // Each vertex has faces of one material.
    let labels = found.mesh.materials.as_ref().unwrap();
    let mut material = vec![None; found.mesh.positions.len()];
    for (f, face) in found.mesh.faces.iter().enumerate() {
        for v in face {
            assert_eq!(*material[v.index()].get_or_insert(labels.of(f)), labels.of(f));
        }
    }
}

#[test]
fn sheets_that_cross_stay_whole() {
    // A floor and a wall of two faces each, through one edge.
    let cross = mesh(
        &[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]],
        &[[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5]],
    );
    let found = conditioned(&cross).unwrap();
    assert!(is_manifold(&found.mesh));
    let shared = |f: usize, g: usize| {
        let [f, g] = [f, g].map(|f| found.mesh.faces[f]);
        f.iter().filter(|v| g.contains(v)).count()
    };
    assert_eq!([shared(0, 1), shared(2, 3), shared(0, 2), shared(1, 3)], [2, 2, 0, 0]);
}

#[test]
fn a_pinched_vertex_becomes_two() {
    let hourglass = mesh(
        &[[0., 0., 0.], [1., 0., 1.], [0., 1., 1.], [1., 0., -1.], [0., 1., -1.]],
        &[[0, 1, 2], [0, 4, 3]],
    );
    let found = conditioned(&hourglass).unwrap();
    assert_eq!((found.counts.split_vertices, found.mesh.positions.len()), (1, 6));
    let mut level = found.mesh.clone();
    level.positions[5][0] = 0.5;
    found.rejoin(&mut level);
    assert_eq!(level.positions.len(), 6, "a copy that has moved stays apart");
    let mut level = found.mesh.clone();
    found.rejoin(&mut level);
    assert_eq!(level, hourglass);
}

#[test]
fn copies_have_wedges_and_locks_of_their_own() {
    let mut hourglass = mesh(
        &[[0., 0., 0.], [1., 0., 1.], [0., 1., 1.], [1., 0., -1.], [0., 1., -1.]],
        &[[0, 1, 2], [0, 4, 3]],
    );
    let values = (0..10).map(|i| i as f32).collect();
    hourglass.attributes = Some(Attributes {
        corners: vec![[0, 1, 2].map(WedgeId), [0, 4, 3].map(WedgeId)],
        wedge_count: 5,
        layers: vec![Layer { kind: LayerKind::Uv(0), name: "uv".into(), width: 2, values }],
    });
    let mut of_vertex = vec![Lock::Free; 5];
    of_vertex[0] = Lock::Protected;
    let locks = Locks { of_vertex, ties: vec![vec![VertexId(0)]] };
    let found = condition(&hourglass, &locks, &ConditionOptions::default()).unwrap();
    assert_eq!(found.mesh.validate(), Ok(()));
    let attributes = found.mesh.attributes.as_ref().unwrap();
    assert_eq!((attributes.wedge_count, attributes.layers[0].of(WedgeId(5))), (6, &[0.0, 1.0][..]));
    assert_eq!(found.locks.of_vertex[5], Lock::Protected);
    assert_eq!(found.locks.ties, [[0, 5].map(VertexId)]);
    let mut level = found.mesh.clone();
    found.rejoin(&mut level);
    assert_eq!(level, hourglass);
}

#[test]
fn what_is_locked_otherwise_or_tied_is_not_sewn() {
    let torn = torn(&grid(1, 0.0));
    let sewn = |locks: Locks| {
        condition(&torn, &locks, &ConditionOptions::default()).map(|found| found.locks.of_vertex)
    };
    let [free, locked] = [Lock::Free, Lock::Locked];
    assert_eq!(
        sewn(Locks { of_vertex: vec![locked; 6], ..Default::default() }),
        Some(vec![locked; 6])
    );
    let mut of_vertex = vec![free; 6];
    of_vertex[0] = locked;
    assert_eq!(sewn(Locks { of_vertex, ..Default::default() }), None);
    let ties = vec![[0, 3].map(VertexId).to_vec()];
    assert_eq!(sewn(Locks { ties, ..Default::default() }), None);
}

#[test]
fn boundaries_that_remain_are_locked() {
    let options = ConditionOptions { lock_boundary: true, ..Default::default() };
    let found = condition(&torn(&grid(2, 0.0)), &Locks::default(), &options).unwrap();
    let locked = |v: &VertexId| found.locks.of_vertex[v.index()] == Lock::Locked;
    let mut used: Vec<VertexId> = found.mesh.faces.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    assert_eq!((used.len(), used.iter().filter(|v| locked(v)).count()), (9, 8));
}

#[test]
fn sewing_never_makes_an_edge_of_three_faces() {
    // Three torn faces around one edge, two of which run the same way.
    let at = [[0., 0., 0.], [1., 0., 0.]];
    let positions =
        [at[0], at[1], [0., 1., 0.], at[0], at[1], [0., -1., 0.], at[0], at[1], [0., 0., 1.]];
    let found = conditioned(&mesh(&positions, &[[0, 1, 2], [4, 3, 5], [7, 6, 8]])).unwrap();
    assert_eq!((found.counts.stitched_edges, found.counts.stitched_vertices), (1, 2));
    assert_eq!(found.mesh.faces[1], [1, 0, 5].map(VertexId), "the one that goes straight on");
    assert!(is_manifold(&found.mesh));
}

#[test]
fn a_look_at_unbalanced_vertices_finds_borders_but_not_closed_fans() {
    let quick = ConditionOptions { search: Search::Unbalanced, ..Default::default() };
    let look = |mesh: &Mesh| condition(mesh, &Locks::default(), &quick);
    let torn = torn(&grid(5, 0.0));
    let (all, found) = (conditioned(&torn).unwrap(), look(&torn).unwrap());
    assert_eq!((found.counts, &found.mesh), (all.counts, &all.mesh));
    let mut leaf = grid(3, 0.0);
    leaf.faces.extend(reversed(&leaf.faces));
    assert!(look(&leaf).is_none());
}

#[test]
fn near_borders_are_counted() {
    let mut near = torn(&grid(3, 0.0));
    for (i, p) in near.positions.iter_mut().enumerate() {
        p[2] = 1e-4 * (i % 3) as f64;
    }
    let found = near_borders(&near, &[1e-6, 1e-3]);
    assert_eq!(found.iter().map(|found| found.near_edges).collect::<Vec<_>>(), [0, 42]);
    assert_eq!(found[1].boundary_edges, 54);
}

#[test]
fn faces_without_area_do_no_harm() {
    let mut flat = torn(&grid(3, 0.0));
    flat.positions.iter_mut().for_each(|p| *p = [1.0, 2.0, 3.0]);
    assert!(conditioned(&flat).is_none());
    let mut line = torn(&grid(3, 0.0));
    line.positions.iter_mut().for_each(|p| p[1] = 0.0);
    assert!(conditioned(&line).is_none_or(|found| is_manifold(&found.mesh)));
}

#[test]
fn many_pieces_take_linear_time() {
    let count: u32 = 300_000;
    let side = |i: u32| [f64::from(i % 1000), f64::from(i / 1000 % 1000), 0.0];
    // All with an edge in common, all alone, or all at one vertex.
    let faces = |common: u32| {
        (0..count).map(move |i| [0, 1, 2].map(|k| if k < common { k } else { 3 * i + k }))
    };
    for common in 0..3 {
        let positions: Vec<_> = (0..3 * count).map(side).collect();
        let soup = mesh(&positions, &faces(common).collect::<Vec<_>>());
        let found = conditioned(&soup);
        assert!(found.is_none_or(|found| found.mesh.faces.len() <= soup.faces.len()));
    }
}

proptest! {
    #[test]
    fn any_soup_becomes_manifold_and_back(
        faces in prop::collection::vec(prop::array::uniform3(0_u32..12), 0..40),
        points in prop::collection::vec(prop::array::uniform3(0_i32..3), 12),
    ) {
        let positions: Vec<_> = points.iter().map(|p| p.map(f64::from)).collect();
        let soup = mesh(&positions, &faces);
        let Some(found) = conditioned(&soup) else { return Ok(()) };
        prop_assert_eq!(found.mesh.faces.len() + found.counts.duplicate_faces, soup.faces.len());
        let place = |mesh: &Mesh, face: &[VertexId; 3]| mesh.triangle(*face);
        let options = ConditionOptions { borders: Borders::Keep, ..Default::default() };
        let unsewn = condition(&soup, &Locks::default(), &options);
        let options = ConditionOptions { search: Search::Unbalanced, ..Default::default() };
        let quick = condition(&soup, &Locks::default(), &options);
        prop_assert!(quick.iter().all(|found| found.mesh.validate().is_ok()));
        for found in [Some(found), unsewn, quick].into_iter().flatten() {
            let odd = connect(&found.mesh).non_manifold_edges();
            prop_assert!(odd <= connect(&soup).non_manifold_edges(), "{odd} edges");
            // A level has no faces that repeat a vertex.
            let mut all = found.mesh.clone();
            all.faces.retain(|face| suspects::is_whole(*face));
            let mut level = all.clone();
            level.compact();
            found.rejoin(&mut level);
            prop_assert_eq!(level.validate(), Ok(()));
            prop_assert_eq!(level.faces.len(), all.faces.len());
            for (now, before) in level.faces.iter().zip(&all.faces) {
                prop_assert_eq!(place(&level, now), place(&all, before));
            }
            if found.counts.stitched_edges == 0 && found.counts.duplicate_faces == 0 {
                let mut input = soup.clone();
                input.faces.retain(|face| suspects::is_whole(*face));
                input.compact();
                prop_assert_eq!(level, input);
            }
        }
    }
}
