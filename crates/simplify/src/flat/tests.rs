use meshlod_fixtures::shape::{bare, topology, volume};
use meshlod_fixtures::{charted, cube, grid, mesh};
use meshlod_samples as samples;

use super::*;

fn flat_within(mesh: &Mesh, tolerance: f64) -> Option<Flattened> {
    let options = FlatOptions { locks: &Locks::default(), lock_boundary: false, tolerance };
    flatten(mesh, &options)
}

/// Flattens what is exactly flat, and checks that all else is as before.
fn flat(mesh: &Mesh) -> Mesh {
    let found = flat_within(mesh, 0.0).expect("there is something flat");
    assert_eq!(found.moved, 0.0);
    let mut level = found.mesh;
    level.validate().unwrap();
    level.compact();
    assert_eq!(topology(&level), topology(mesh));
    assert!((volume(&level) - volume(mesh)).abs() < 1e-12);
    let area = |mesh: &Mesh| -> f64 {
        let of = |&face: &[VertexId; 3]| {
            let [a, b, c] = mesh.triangle(face);
            (b - a).cross(c - a).length() / 2.0
        };
        mesh.faces.iter().map(of).sum()
    };
    assert!((area(&level) / area(mesh) - 1.0).abs() < 1e-12);
    level
}

#[test]
fn boxes_stairs_and_prisms_have_the_faces_of_their_corners() {
    assert_eq!(flat(&samples::cube(10_000)).faces.len(), 12);
    assert_eq!(flat(&bare(samples::cube(3_000))).faces.len(), 12);
    // A square with a hundred sides, and its sides: 2 (n - 2) + 2 n for n = 100.
    assert_eq!(flat(&samples::prism(10_000)).faces.len(), 396);
    // 2 (corners - 2).
    let steps = flat(&samples::stairs(5_000));
    assert_eq!(steps.faces.len(), 2 * (steps.positions.len() - 2));
    assert_eq!(flat_within(&cube(), 0.0).map(|found| found.mesh.faces.len()), None);
    assert!(flat_within(&samples::sphere(500), 0.0).is_none());
}

#[test]
fn a_flat_with_holes_keeps_them() {
    let square = grid(12);
    let is_hole = |&face: &[VertexId; 3]| {
        let middle = square.triangle(face).into_iter().sum::<glam::DVec3>() / 3.0;
        let middle = middle / square.bounds().diagonal() * 2f64.sqrt();
        [middle.x, middle.y].iter().all(|x| (x - 0.5).abs() < 0.25)
    };
    let faces = square.faces.iter().copied().filter(|face| !is_hole(face)).collect();
    // Eight corners, and two for the hole.
    assert_eq!(flat(&Mesh::new(square.positions.clone(), faces)).faces.len(), 8);
}

#[test]
fn a_border_keeps_only_its_corners_unless_it_is_locked() {
    let square = grid(20);
    assert_eq!(flat(&square).faces.len(), 2);
    let corner = VertexId(7);
    let mut of_vertex = vec![Lock::Free; square.positions.len()];
    of_vertex[corner.index()] = Lock::Locked;
    let locks = Locks { of_vertex, ties: Vec::new() };
    let with = |locks: &Locks, lock_boundary| {
        let options = FlatOptions { locks, lock_boundary, tolerance: 0.0 };
        flatten(&square, &options).unwrap().mesh
    };
    let level = with(&locks, false);
    assert!(level.faces.iter().flatten().any(|&v| v == corner));
    assert_eq!(level.faces.len(), 3);
    // All 80 vertices of the border: 80 - 2 faces.
    assert_eq!(with(&Locks::default(), true).faces.len(), 78);
}

#[test]
fn what_differs_stays_apart() {
    let square = grid(8);
    let halves = |label: u32| {
        let of_face = (0..square.faces.len() as u32).map(|f| (f >= 64) as u32 * label).collect();
        let names = vec!["a".into(), "b".into()];
        let labels = meshlod_mesh::Labels { names, of_face };
        flat(&Mesh { materials: Some(labels), ..square.clone() })
    };
    assert_eq!(halves(0).faces.len(), 2);
    let level = halves(1);
    assert_eq!(level.faces.len(), 4);
    assert_eq!(level.materials.unwrap().of_face, [0, 0, 1, 1]);
}

#[test]
fn linear_attributes_go_along_and_others_keep_a_flat_as_it_is() {
    let with = |uv: fn(f64, f64) -> [f64; 2]| {
        let mesh = grid(12);
        let layer = meshlod_mesh::Layer {
            kind: meshlod_mesh::LayerKind::Uv(0),
            name: String::new(),
            width: 2,
            values: mesh.positions.iter().flat_map(|p| uv(p[0], p[1])).map(|x| x as f32).collect(),
        };
        let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
        let wedge_count = mesh.positions.len();
        let attributes = Attributes { corners, wedge_count, layers: vec![layer] };
        Mesh { attributes: Some(attributes), ..mesh }
    };
    let linear = flat(&with(|x, y| [0.3 * x + 0.1 * y, 0.7 * y - 0.2 * x]));
    assert_eq!((linear.faces.len(), linear.attributes.unwrap().wedge_count), (2, 4));
    assert!(flat_within(&with(|x, y| [x * y, y]), 0.0).is_none());
    // A chart for each side.
    let chart = charted(&samples::cube(3_000));
    assert!(flat(&chart).faces.len() >= 12);
}

#[test]
fn coats_of_a_card_are_not_cut_along_one_diagonal() {
    // Two fans over one border of eight vertices.
    let border = [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]];
    let places = border.iter().chain([&[1, 1]; 2]).map(|&[x, y]| [f64::from(x), f64::from(y), 0.0]);
    let places: Vec<[f64; 3]> = places.collect();
    let fans = (0..8).flat_map(|i| [[i, (i + 1) % 8, 8], [(i + 1) % 8, i, 9]]);
    let card = mesh(&places, &fans.collect::<Vec<_>>());
    assert_eq!(flat(&card).faces.len(), 4);
}

#[test]
fn turned_and_rounded_flats_go_within_a_tolerance() {
    for seed in 0..4 {
        let mut mesh = samples::turned(&samples::stairs(4_000), seed);
        for x in mesh.positions.as_flattened_mut() {
            *x = f64::from(*x as f32);
        }
        let exact = samples::stairs(4_000);
        let floor = flat(&exact).faces.len();
        let tolerance = 1e-7 * mesh.bounds().diagonal();
        let found = flat_within(&mesh, tolerance).unwrap();
        assert!(found.moved <= tolerance && found.moved > 0.0);
        let faces = found.mesh.faces.len();
        assert!(faces <= floor + floor / 10, "{faces} faces of {floor}");
    }
}

#[test]
fn faces_without_area_and_flats_over_themselves_are_no_trap() {
    // A sliver on the edge of two walls: 1 is between 0 and 2.
    let places = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [2.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [2.0, 0.0, 1.0],
    ];
    let faces = [[0, 2, 4], [0, 4, 3], [0, 1, 2], [1, 0, 5], [1, 5, 6], [2, 1, 6]];
    let wall = mesh(&places, &faces);
    let level = flat_within(&wall, 0.0).unwrap().mesh;
    assert_eq!(level.faces.len(), 4);
    // A ribbon that lies on itself twice.
    let ring: Vec<[f64; 3]> = (0..24)
        .flat_map(|i| {
            let a = f64::from(i % 12) * std::f64::consts::TAU / 12.0;
            [[a.cos(), a.sin(), 0.0], [2.0 * a.cos(), 2.0 * a.sin(), 0.0]]
        })
        .collect();
    let faces: Vec<[u32; 3]> = (0..23)
        .flat_map(|i| {
            let [a, b, c, d] = [2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    assert!(flat_within(&mesh(&ring, &faces), 0.0).is_none());
}
