use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use meshlod_mesh::{Connectivity, VertexId, face_components};

use super::*;

const CLOSED: [&str; 11] = [
    "sphere",
    "torus",
    "faceted-torus",
    "knot",
    "gyroid",
    "plate",
    "fish",
    "cube",
    "prism",
    "stairs",
    "tunnels",
];

fn named(name: &str, faces: usize) -> Mesh {
    by_name(name, Some(faces)).expect("a known name")
}

/// Every edge by its directed ends, and how many faces run along it that way.
fn directed_edges(mesh: &Mesh) -> BTreeMap<[VertexId; 2], usize> {
    let mut edges = BTreeMap::new();
    for &[a, b, c] in &mesh.faces {
        for edge in [[a, b], [b, c], [c, a]] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    edges
}

fn volume(mesh: &Mesh) -> f64 {
    let parts = mesh.faces.iter().map(|&face| {
        let [a, b, c] = mesh.triangle(face);
        a.dot(b.cross(c)) / 6.0
    });
    parts.sum()
}

fn doubled_area(mesh: &Mesh, face: [VertexId; 3]) -> f64 {
    let [a, b, c] = mesh.triangle(face);
    (b - a).cross(c - a).length()
}

/// V − E + F over the vertices that are there.
fn euler(mesh: &Mesh) -> i64 {
    let edges = directed_edges(mesh).len() / 2;
    mesh.positions.len() as i64 - edges as i64 + mesh.faces.len() as i64
}

/// Closed, oriented outward, one fan at each vertex, nothing unused, nothing degenerate.
fn assert_watertight(name: &str, mesh: &Mesh) {
    mesh.validate().unwrap_or_else(|error| panic!("{name}: {error}"));
    let edges = directed_edges(mesh);
    for (&[a, b], &count) in &edges {
        assert_eq!(count, 1, "{name}: faces run twice along {a} {b}");
        assert!(edges.contains_key(&[b, a]), "{name}: {a} {b} has one face");
    }
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    assert!(connectivity.is_closed(), "{name}: not closed");
    assert_eq!(connectivity.inconsistent_edges(), 0, "{name}");
    assert_eq!(connectivity.pinched_vertices(), 0, "{name}");
    assert!(mesh.used_vertices().into_iter().all(|used| used), "{name}: unused vertices");
    assert!(volume(mesh) > 0.0, "{name}: inside out");
    for &face in &mesh.faces {
        let least = 1e-3 / mesh.faces.len() as f64;
        assert!(doubled_area(mesh, face) > least * 0.1, "{name}: face {face:?} is degenerate");
    }
}

#[test]
fn every_name_is_known_and_no_other() {
    for name in NAMES {
        assert!(by_name(name, Some(100)).is_some_and(|mesh| !mesh.faces.is_empty()), "{name}");
    }
    assert_eq!(by_name("cubes", None), None);
}

#[test]
fn closed_samples_are_watertight_at_any_size() {
    for name in CLOSED {
        for faces in [0, 100, 1_000, 5_000, 20_011] {
            assert_watertight(&format!("{name} of {faces}"), &named(name, faces));
        }
    }
}

#[test]
fn face_counts_come_near_the_wish() {
    let within = [
        ("sphere", 0.04),
        ("torus", 0.01),
        ("faceted-torus", 0.05),
        ("knot", 0.01),
        ("gyroid", 0.05),
        ("plate", 0.04),
        ("terrain", 0.01),
        ("fish", 0.02),
        ("cube", 0.03),
        ("plates", 0.02),
        ("prism", 0.02),
        ("boxes", 0.25),
        ("stairs", 0.15),
        ("tunnels", 0.1),
        ("parts", 0.12),
    ];
    for (name, part) in within {
        for wish in [20_000, 33_333, 100_000] {
            let found = named(name, wish).faces.len();
            let off = found.abs_diff(wish) as f64 / wish as f64;
            assert!(off <= part, "{name}: {found} faces for {wish}");
        }
    }
}

#[test]
fn genus_is_what_the_shape_has() {
    assert_eq!(euler(&sphere(2_000)), 2);
    for mesh in [torus(2_000), faceted_torus(2_000), knot(2_000)] {
        assert_eq!(euler(&mesh), 0);
    }
    assert_eq!(euler(&plate(9 * 264)), 2 - 2 * 9);
    for seed in 0..3 {
        // 65 * 12 * 12 faces and the rim.
        assert_eq!(euler(&tunnels(144 * 113, seed)), 2 - 2 * 144);
    }
    assert_ne!(tunnels(5_000, 1), tunnels(5_000, 2));
}

#[test]
fn parts_are_closed_bodies_that_do_not_touch() {
    for seed in 0..3 {
        let mesh = parts(20_000, seed);
        let (of_face, count) = face_components(&mesh.faces, mesh.positions.len());
        let mut bodies = vec![Mesh::default(); count];
        for (&face, &body) in mesh.faces.iter().zip(&of_face) {
            bodies[body as usize].faces.push(face);
        }
        assert!((100..250).contains(&count), "{count} parts");
        let cells = (count as f64).cbrt().ceil() as usize;
        let half = 1.0 / cells as f64;
        let mut genus = BTreeSet::new();
        for (i, body) in bodies.iter_mut().enumerate() {
            body.positions.clone_from(&mesh.positions);
            body.compact();
            let cell = [i % cells, i / cells % cells, i / cells / cells];
            let middle = DVec3::from(cell.map(|at| half * (2 * at + 1) as f64 - 1.0));
            for at in &body.positions {
                let aside = (DVec3::from(*at) - middle).abs().max_element();
                assert!(aside < half, "part {i} is in a cell of its own");
            }
            // Of size 1, as what is a degenerate face depends on the size.
            let size = body.bounds().diagonal();
            body.positions.iter_mut().flatten().for_each(|x| *x /= size);
            assert_watertight("a part", body);
            genus.insert((2 - euler(body)) / 2);
        }
        assert_eq!(genus.into_iter().collect::<Vec<_>>(), [0, 1, 4, 9]);
    }
    assert_ne!(parts(5_000, 1), parts(5_000, 2));
}

#[test]
fn the_gyroid_is_one_piece_with_many_tunnels() {
    let mesh = gyroid(40_000);
    let components: BTreeSet<u32> =
        face_components(&mesh.faces, mesh.positions.len()).0.into_iter().collect();
    assert_eq!(components.len(), 1);
    let genus = (2 - euler(&mesh)) / 2;
    assert!(genus >= 25, "genus {genus}");
}

#[test]
fn sphere_and_torus_near_their_closed_forms() {
    use std::f64::consts::PI;
    let exact = 4.0 / 3.0 * PI;
    assert!((volume(&sphere(20_000)) / exact - 1.0).abs() < 1e-3);
    let exact = 2.0 * PI * PI * 0.7 * 0.3 * 0.3;
    assert!((volume(&torus(20_000)) / exact - 1.0).abs() < 2e-3);
}

#[test]
fn a_faceted_torus_lies_in_50_planes() {
    // 12 × 6 facets, but the 12 on top lie in one plane, and so do those below.
    let mesh = faceted_torus(10_000);
    let mut planes: Vec<(DVec3, f64)> = Vec::new();
    for &face in &mesh.faces {
        let [a, b, c] = mesh.triangle(face);
        let normal = (b - a).cross(c - a).normalize();
        let known = planes
            .iter()
            .any(|(n, d)| normal.distance(*n) < 1e-9 && (normal.dot(a) - d).abs() < 1e-12);
        if !known {
            planes.push((normal, normal.dot(a)));
        }
    }
    assert_eq!(planes.len(), 50);
}

#[test]
fn terrain_is_one_open_sheet_that_looks_up() {
    let mesh = terrain(5_000);
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    assert_eq!(connectivity.boundary_edges(), 4 * 50);
    assert_eq!((connectivity.non_manifold_edges(), connectivity.inconsistent_edges()), (0, 0));
    for &face in &mesh.faces {
        let [a, b, c] = mesh.triangle(face);
        assert!((b - a).cross(c - a).y > 0.0);
    }
}

#[test]
fn finer_terrain_is_the_same_landscape() {
    let (coarse, fine) = (terrain(2 * 20 * 20), terrain(2 * 40 * 40));
    for row in 0..=20 {
        for column in 0..=20 {
            let a = DVec3::from(coarse.positions[row * 21 + column]);
            let b = DVec3::from(fine.positions[2 * row * 41 + 2 * column]);
            assert!(a.distance(b) < 1e-12);
        }
    }
}

#[test]
fn a_sample_is_the_same_each_time() {
    for name in NAMES {
        assert_eq!(named(name, 3_000), named(name, 3_000));
    }
}

#[test]
fn boxes_and_voxels_are_closed_and_look_outwards() {
    for seed in 0..3 {
        let boxes = boxes(20_000, seed);
        assert_watertight("boxes", &boxes);
        let voxels = voxels(50_000, seed);
        assert!(voxels.faces.len().abs_diff(50_000) < 10_000, "{}", voxels.faces.len());
        let edges = directed_edges(&voxels);
        assert!(edges.iter().all(|(&[a, b], count)| edges.get(&[b, a]) == Some(count)));
        assert!(volume(&voxels) > 0.3 * 8.0 && volume(&voxels) < 0.7 * 8.0);
    }
    assert_ne!(boxes(20_000, 1), boxes(20_000, 2));
}

#[test]
fn a_turned_sample_is_as_large_and_on_no_axis() {
    let cube = cube(100);
    for seed in 0..5 {
        let turned = turned(&cube, seed);
        assert!((volume(&turned) - 1.0).abs() < 1e-12);
        let is_off = |face: &[VertexId; 3]| {
            let [a, b, c] = turned.triangle(*face);
            (b - a).cross(c - a).normalize().abs().max_element() < 1.0 - 1e-6
        };
        assert!(turned.faces.iter().all(is_off), "{seed}");
    }
}

#[test]
fn terrain_row_by_row_is_the_same() {
    for faces in [2, 300, 5_000] {
        let (mesh, rows) = (terrain(faces), TerrainRows::new(faces));
        let places: Vec<[f64; 3]> = (0..rows.count()).flat_map(|row| rows.places(row)).collect();
        let of_rows = (0..rows.count() - 1).flat_map(|row| rows.faces(row));
        let expected = mesh.faces.iter().map(|face| face.map(|v| v.0));
        assert!(of_rows.eq(expected) && places == mesh.positions);
        assert_eq!(rows.sizes(), [mesh.positions.len(), mesh.faces.len()].map(|n| n as u64));
    }
}

#[test]
fn colours_of_terrain_rise_from_water_to_snow() {
    assert_eq!(terrain_color(-9.0), [46, 84, 92]);
    assert_eq!(terrain_color(0.02), [70, 104, 54]);
    assert_eq!(terrain_color(0.09), [93, 104, 69]);
    assert_eq!(terrain_color(9.0), [240, 243, 246]);
    let mesh = colored_terrain(200);
    assert_eq!(mesh.validate(), Ok(()));
}

#[test]
fn gyroids_slab_by_slab_are_closed_and_connected() {
    for faces in [0, 200_000, 500_000] {
        let slabs = GyroidSlabs::new(faces);
        let mesh = slabs.mesh();
        let sizes = [mesh.positions.len(), mesh.faces.len()];
        assert_eq!(slabs.sizes(), sizes.map(|n| n as u64));
        let off = sizes[1].abs_diff(faces);
        assert!(faces == 0 || off < faces / 10, "{faces}: {}", sizes[1]);
        assert_eq!(face_components(&mesh.faces, sizes[0]).1, 1);
        assert_watertight("gyroid by slabs", &mesh);
    }
}

#[test]
fn a_gyroid_of_few_cells_has_many_tunnels() {
    let mesh = GyroidSlabs::with_periods(4, 8).mesh();
    assert_watertight("foam", &mesh);
    assert!(euler(&mesh) < -2 * 4 * 50, "{}", euler(&mesh));
}
