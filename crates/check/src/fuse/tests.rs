use std::collections::BTreeSet;

use glam::{DQuat, DVec3};
use meshlod_fixtures::shape::volume;
use meshlod_mesh::{Connectivity, FaceLayer, FaceLayerKind, VertexId};

use super::*;

/// Builds a closed box from one corner to another with 12 faces that point outwards.
fn block(from: [f64; 3], to: [f64; 3]) -> Mesh {
    let corner = |i: usize| {
        std::array::from_fn(|axis| if i >> axis & 1 == 0 { from[axis] } else { to[axis] })
    };
    let sides =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Mesh::new((0..8).map(corner).collect(), faces.map(|face| face.map(VertexId)).collect())
}

fn together(meshes: impl IntoIterator<Item = Mesh>) -> Mesh {
    let mut all = Mesh::default();
    for mesh in meshes {
        let base = all.positions.len();
        all.positions.extend(mesh.positions);
        all.faces
            .extend(mesh.faces.iter().map(|face| face.map(|v| VertexId::new(base + v.index()))));
    }
    all
}

fn area(mesh: &Mesh) -> f64 {
    let twice = |&face: &[VertexId; 3]| {
        let [a, b, c] = mesh.triangle(face);
        (b - a).cross(c - a).length()
    };
    mesh.faces.iter().map(twice).sum::<f64>() / 2.0
}

fn is_closed(mesh: &Mesh) -> bool {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    connectivity.boundary_edges() == 0 && connectivity.non_manifold_edges() == 0
}

#[test]
fn two_blocks_become_one() {
    let mut blocks = together([block([0.0; 3], [2.0; 3]), block([1.0; 3], [3.0, 4.0, 2.5])]);
    let second = block([0.0; 3], [1.0; 3]).faces.len();
    let values = [vec![0.5; second], vec![1.5; second]].concat();
    let (kind, name) = (FaceLayerKind::Other, "quality".to_owned());
    blocks.face_layers = vec![FaceLayer { kind, name, values }];
    let (fused, report) = fuse(&blocks, |_| true);
    assert_eq!(fused.validate(), Ok(()));
    assert!(is_closed(&fused));
    assert!((volume(&fused) - (8.0 + 9.0 - 1.0)).abs() < 1e-12);
    let objects = &fused.objects.as_ref().unwrap().of_face;
    let of_object = |(&value, &object): (&f64, &u32)| value == 0.5 + f64::from(object);
    assert!(fused.face_layers[0].values.iter().zip(objects).all(of_object));
    let labels = fused.objects.as_ref().unwrap();
    assert_eq!(labels.names.len(), 2);
    assert!(labels.of_face.contains(&0) && labels.of_face.contains(&1));
    assert!(report.buried > 0 && report.joined > 0);
}

#[test]
fn components_that_intersect_nothing_stay() {
    let apart = together([block([0.0; 3], [4.0; 3]), block([1.0; 3], [2.0; 3])]);
    assert_eq!(fuse(&apart, |_| true), (apart.clone(), Fused::default()));
}

#[test]
fn glass_hides_nothing() {
    let blocks = together([block([0.0; 3], [2.0; 3]), block([1.0; 3], [3.0; 3])]);
    let (fused, report) = fuse(&blocks, |face| face.index() >= 12);
    // What is left is the glass without its part inside the other, and all of the other.
    assert!(report.buried > 0);
    assert!((area(&fused) - (24.0 - 3.0 + 24.0)).abs() < 1e-12);
    let (fused, report) = fuse(&blocks, |_| false);
    assert_eq!((report.buried, report.joined), (0, 0));
    assert!((area(&fused) - 48.0).abs() < 1e-12);
}

/// Pseudorandom numbers of a seed.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) % n
    }
}

/// Builds blocks with integer corners and returns the cells that they cover.
fn blocks_on_a_grid(seed: u64) -> (Mesh, BTreeSet<[u64; 3]>) {
    let mut random = Random(seed);
    let count = 2 + random.below(4);
    let mut cells = BTreeSet::new();
    let blocks = (0..count).map(|_| {
        let from: [u64; 3] = std::array::from_fn(|_| random.below(4));
        let to = from.map(|x| x + 1 + random.below(3));
        for x in from[0]..to[0] {
            for y in from[1]..to[1] {
                cells.extend((from[2]..to[2]).map(|z| [x, y, z]));
            }
        }
        block(from.map(|x| x as f64), to.map(|x| x as f64))
    });
    (together(blocks.collect::<Vec<_>>()), cells)
}

/// Returns the number of cell sides without a neighbour cell.
fn open_sides(cells: &BTreeSet<[u64; 3]>) -> usize {
    let beside = |cell: &[u64; 3], axis: usize, step: i64| {
        let mut beside = *cell;
        beside[axis] = cell[axis].wrapping_add_signed(step);
        beside
    };
    let sides = cells
        .iter()
        .flat_map(|cell| (0..3).flat_map(move |axis| [-1, 1].map(|step| beside(cell, axis, step))));
    sides.filter(|beside| !cells.contains(beside)).count()
}

#[test]
fn blocks_on_a_grid_fuse_to_the_cells_that_they_cover() {
    // Most corners lie on faces and edges of others, and many sides are coplanar.
    for seed in 0..200 {
        let (blocks, cells) = blocks_on_a_grid(seed);
        let (fused, _) = fuse(&blocks, |_| true);
        assert_eq!(fused.validate(), Ok(()), "seed {seed}");
        assert!((volume(&fused) - cells.len() as f64).abs() < 1e-9, "seed {seed}");
        assert!((area(&fused) - open_sides(&cells) as f64).abs() < 1e-9, "seed {seed}");
    }
}

/// Rotates blocks, each by its own angle or all by one.
fn turned(blocks: &Mesh, angle: impl Fn(usize) -> f64) -> Mesh {
    let mut turned = blocks.clone();
    for (v, p) in turned.positions.iter_mut().enumerate() {
        let turn = DQuat::from_rotation_z(angle(v / 8)) * DQuat::from_rotation_x(0.7);
        *p = (turn * DVec3::from(*p)).into();
    }
    turned
}

#[test]
fn blocks_turned_apart_stay_closed() {
    for seed in 0..100 {
        let (blocks, _) = blocks_on_a_grid(seed);
        let blocks = turned(&blocks, |block| 0.3 + 0.1 * block as f64);
        let (imprinted, _) = crate::imprint(&blocks);
        assert!((area(&imprinted) - area(&blocks)).abs() < 1e-9, "seed {seed}");
        let (fused, report) = fuse(&blocks, |_| true);
        assert!(is_closed(&fused), "seed {seed}");
        assert!(report.imprint.pairs == 0 || volume(&fused) < volume(&blocks), "seed {seed}");
    }
}

#[test]
fn nothing_visible_is_lost_if_planes_coincide_up_to_rounding() {
    for seed in 0..100 {
        let (blocks, cells) = blocks_on_a_grid(seed);
        let blocks = turned(&blocks, |_| 0.3);
        let (imprinted, _) = crate::imprint(&blocks);
        assert!((area(&imprinted) - area(&blocks)).abs() < 1e-9, "seed {seed}");
        let (fused, _) = fuse(&blocks, |_| true);
        assert!(volume(&fused) > cells.len() as f64 - 1e-9, "seed {seed}: {}", volume(&fused));
    }
}

#[test]
fn of_a_block_and_its_inside_out_copy_one_stays() {
    for inner in [0, 1] {
        let mut blocks = [block([0.0; 3], [1.0; 3]), block([0.0; 3], [1.0; 3])];
        blocks[inner].faces.iter_mut().for_each(|face| face.reverse());
        let (fused, _) = fuse(&together(blocks), |_| true);
        assert!(is_closed(&fused) && (volume(&fused) - 1.0).abs() < 1e-12, "{inner}");
    }
}

#[test]
fn size_does_not_matter() {
    let blocks = together([block([0.0; 3], [2.0; 3]), block([1.0; 3], [3.0, 4.0, 2.5])]);
    let blocks = turned(&blocks, |block| 0.2 * block as f64);
    let (fused, report) = fuse(&blocks, |_| true);
    assert!(report.buried > 0);
    for exponent in [-1000, -500, -260, 260, 500, 1000] {
        let sized = |mesh: &Mesh| {
            let mut sized = mesh.clone();
            let size = 2f64.powi(exponent);
            sized.positions.as_flattened_mut().iter_mut().for_each(|x| *x *= size);
            sized
        };
        let (imprinted, found) = crate::imprint(&sized(&blocks));
        assert_eq!(found, report.imprint);
        assert_eq!(imprinted.positions[..16], sized(&blocks).positions);
        let (large, found) = fuse(&sized(&blocks), |_| true);
        assert_eq!((large.faces.len(), found), (fused.faces.len(), report), "2^{exponent}");
    }
}

#[test]
fn what_is_far_away_moves_nothing() {
    let mut blocks = together([block([0.0; 3], [2.0; 3]), block([1.0; 3], [3.0, 4.0, 2.5])]);
    blocks = turned(&blocks, |block| 0.2 * block as f64);
    let (alone, _) = crate::imprint(&blocks);
    blocks.positions.extend([[1e16, 0.0, 0.0], [1e16, 1.0, 0.0], [1e16, 1.0, 1.0]]);
    blocks.faces.push([16, 17, 18].map(VertexId));
    let (imprinted, _) = crate::imprint(&blocks);
    assert_eq!(imprinted.positions[19..], alone.positions[16..]);
}

#[test]
fn open_components_are_neither_cut_nor_cut_others() {
    // A block without its last two faces through one that is whole, and a whole one through that.
    let mut open = block([1.0; 3], [3.0, 4.0, 2.5]);
    open.faces.truncate(10);
    let blocks = together([block([0.0; 3], [2.0; 3]), open.clone()]);
    let (fused, report) = fuse(&blocks, |_| true);
    assert_eq!(fused.faces, blocks.faces);
    assert_eq!(report, Fused { left: 1, ..Fused::default() });
    let three = together([block([0.0; 3], [2.0; 3]), open, block([-1.0; 3], [1.5, 0.5, 0.5])]);
    let boundary =
        |mesh: &Mesh| Connectivity::new(&mesh.faces, mesh.positions.len()).boundary_edges();
    let (fused, report) = fuse(&three, |_| true);
    assert_eq!((boundary(&fused), report.left), (boundary(&three), 1));
    assert!(report.buried > 0 && report.joined > 0);
}
