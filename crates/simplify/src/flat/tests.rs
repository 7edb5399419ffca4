use meshlod_fixtures::shape::{bare, topology, volume};
use meshlod_fixtures::{charted, cube, grid, mesh};
use meshlod_samples as samples;

use super::*;

fn flattened(mesh: &Mesh, tolerance: f64) -> Flattened {
    let options = FlatOptions { locks: &Locks::default(), lock_boundary: false, tolerance };
    flatten(mesh, &options)
}

fn flat_within(mesh: &Mesh, tolerance: f64) -> Option<Mesh> {
    flattened(mesh, tolerance).mesh
}

/// Flattens what is exactly flat, and checks that all else is as before.
fn flat(mesh: &Mesh) -> Mesh {
    let found = flattened(mesh, 0.0);
    assert_eq!(found.moved, 0.0);
    let mut level = found.mesh.expect("there is something flat");
    assert!(found.needed_faces <= level.faces.len());
    level.validate().unwrap();
    level.compact();
    assert_eq!(topology(&level), topology(mesh));
    assert!((volume(&level) - volume(mesh)).abs() < 1e-12);
    assert!((area(&level) / area(mesh) - 1.0).abs() < 1e-12);
    level
}

/// Returns numbers below others, drawn by lot.
fn lot(seed: u64) -> impl FnMut(u64) -> u64 {
    let mut state = seed;
    move |below| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    }
}

fn area(mesh: &Mesh) -> f64 {
    let of = |&face: &[VertexId; 3]| {
        let [a, b, c] = mesh.triangle(face);
        (b - a).cross(c - a).length() / 2.0
    };
    mesh.faces.iter().map(of).sum()
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
    assert_eq!(flattened(&cube(), 0.0).needed_faces, 12);
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
        flatten(&square, &options).mesh.unwrap()
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
        let found = flattened(&mesh, tolerance);
        assert!(found.moved <= tolerance && found.moved > 0.0);
        let faces = found.mesh.unwrap().faces.len();
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
    let level = flat_within(&wall, 0.0).unwrap();
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

#[test]
fn coats_that_share_corners_go_in_few_rounds() {
    // Many coats over one square, each with a vertex of its own in the middle.
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let count = 500;
    let middles = (0..count).map(|i| [0.4 + f64::from(i) / 4096.0, 0.5]);
    let places: Vec<[f64; 3]> =
        corners.into_iter().chain(middles).map(|[x, y]| [x, y, 0.0]).collect();
    let fans = (0..count).flat_map(|i| (0..4).map(move |k| [k, (k + 1) % 4, 4 + i]));
    let coats = mesh(&places, &fans.collect::<Vec<_>>());
    // One has the first diagonal, one the other; the rest would be in the way of these.
    let found = flattened(&coats, 0.0);
    assert_eq!(found.needed_faces, 2 * 500);
    assert_eq!(found.mesh.unwrap().faces.len(), 4 * 498 + 4);
}

#[test]
fn sheets_on_each_other_each_have_their_own_faces() {
    let square = grid(12);
    let behind = square.faces.iter().map(|face| face.map(|v| VertexId(v.0 + 13 * 13)));
    for is_turned in [false, true] {
        let turned = |[a, b, c]: [VertexId; 3]| if is_turned { [a, c, b] } else { [a, b, c] };
        let faces = square.faces.iter().copied().chain(behind.clone().map(turned)).collect();
        let positions = square.positions.repeat(2);
        assert_eq!(flat(&Mesh::new(positions, faces)).faces.len(), 4);
    }
    // On the same vertices: its edges would have three faces or more.
    let faces = square.faces.repeat(2);
    assert!(flat_within(&Mesh::new(square.positions, faces), 0.0).is_none());
}

#[test]
fn far_from_the_origin_what_is_flat_goes() {
    let mut square = grid(30);
    for place in &mut square.positions {
        *place = [1e7 + 1e-3 * place[0], 2e7 - 1e-3 * place[1], 1e7 + 2e-3 * place[1]];
    }
    // Of a plane that is on no axis nothing is exactly flat after rounding.
    assert!(flattened(&square, 0.0).needed_faces > 2);
    assert_eq!(flat_within(&square, 1e-7).unwrap().faces.len(), 2);
    square.positions.iter_mut().for_each(|place| place[2] = 1e7);
    assert_eq!(flat_within(&square, 0.0).unwrap().faces.len(), 2);
}

#[test]
fn a_tunnel_without_a_width_stays() {
    // A plate with a slit: its sides lie on each other.
    let mut plate = grid(12);
    let lower = plate.positions.len() as u32;
    let (row, of_slit) = (6 * 13, 4..9);
    let slit: Vec<u32> = of_slit.clone().map(|x| row + x).collect();
    let copy = |v: u32| lower + (v - slit[0]);
    plate
        .positions
        .extend(slit.clone().iter().map(|&v| plate.positions[v as usize]).collect::<Vec<_>>());
    for face in &mut plate.faces {
        let is_above = face.iter().any(|v| v.0 >= row + 13);
        for v in face.iter_mut().filter(|v| is_above && slit[1..4].contains(&v.0)) {
            *v = VertexId(copy(v.0));
        }
    }
    plate.compact();
    let level = flat(&plate);
    assert_eq!(level.faces.len(), 8, "four corners, two ends, and a vertex of each side");
}

#[test]
fn random_faces_on_a_lattice_keep_their_shape() {
    let mut random = lot(7);
    let mut found = 0;
    for round in 0..4_000 {
        // A lattice with holes and steps, some of whose vertices are one, or torn apart.
        let (side, heights) = (2 + random(4), 1 + random(3));
        let mut square = grid(side as u32);
        let count = square.positions.len() as u64;
        for place in &mut square.positions {
            *place = [place[0].round(), place[1].round(), 0.0];
            if random(4) == 0 {
                place[2] = random(heights) as f64;
            }
        }
        for _ in 0..random(3) {
            let [from, to] = [(); 2].map(|()| VertexId(random(count) as u32));
            square.faces.iter_mut().flatten().filter(|v| **v == from).for_each(|v| *v = to);
        }
        square.faces.retain(|&[a, b, c]| random(8) > 0 && a != b && b != c && c != a);
        for _ in 0..random(3) {
            if let Some(face) = square.faces.get(random(30) as usize).copied() {
                square.faces.push(if random(2) == 0 { face } else { [face[0], face[2], face[1]] });
            }
        }
        let Some(level) = flat_within(&square, 0.0) else { continue };
        found += 1;
        level.validate().unwrap();
        let [before, after] = [&square, &level].map(topology);
        assert_eq!(after.euler, before.euler, "round {round}");
        assert_eq!(after.components, before.components, "round {round}");
        assert!(after.non_manifold_edges <= before.non_manifold_edges, "round {round}");
        assert!((volume(&level) - volume(&square)).abs() < 1e-9, "round {round}");
        assert!((area(&level) - area(&square)).abs() < 1e-9, "round {round}");
    }
    assert!(found > 1_000, "{found}");
}

/// Returns a box each of whose sides has points of its own on its rim, with faces without area between
/// the points of two sides: triangulations of points on a line, drawn by lot.
fn box_with_rows(random: &mut impl FnMut(u64) -> u64) -> Mesh {
    let mut places: Vec<[f64; 3]> =
        (0..8).map(|i| [0, 1, 2].map(|k| f64::from(i >> k & 1))).collect();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    let mut rims: Vec<Vec<u32>> = Vec::new();
    for corners in
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    {
        let middle = places.len() as u32;
        let mean = |k: usize| corners.iter().map(|&v| places[v as usize][k]).sum::<f64>() / 4.0;
        places.push([mean(0), mean(1), mean(2)]);
        for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let mut at: Vec<u64> = (0..random(6)).map(|_| 1 + random(1023)).collect();
            at.sort_unstable();
            at.dedup();
            let [a, b] = [from, to].map(|v| places[v as usize]);
            let between = at.iter().map(|&at| at as f64 / 1024.0);
            let first = places.len() as u32;
            places.extend(between.map(|t| [0, 1, 2].map(|k| a[k] + t * (b[k] - a[k]))));
            let row = [from].into_iter().chain(first..places.len() as u32).chain([to]);
            let row: Vec<u32> = row.collect();
            faces.extend(row.windows(2).map(|pair| [pair[0], pair[1], middle]));
            rims.push(row);
        }
    }
    for (i, rim) in rims.iter().enumerate() {
        let is_other =
            |other: &&Vec<u32>| (other[0], other[other.len() - 1]) == (rim[rim.len() - 1], rim[0]);
        let other = rims[..i].iter().find(is_other);
        let Some(other) = other else { continue };
        // Both rims the other way round, as seen from the gap.
        let inner = rim[1..].iter().chain(&other[1..]).rev().copied();
        let mut hole: Vec<u32> = inner.collect();
        while hole.len() > 2 {
            let k = random(hole.len() as u64) as usize;
            let next = |by: usize| hole[(k + by) % hole.len()];
            faces.push([next(0), next(1), next(2)]);
            hole.remove((k + 1) % hole.len());
        }
    }
    mesh(&places, &faces)
}

#[test]
fn rows_of_faces_without_area_go_with_their_vertices() {
    let mut random = lot(3);
    for round in 0..300 {
        let rows = box_with_rows(&mut random);
        assert_eq!(topology(&rows).euler, 2, "round {round}");
        let level = flat(&rows);
        assert_eq!(level.faces.len(), 12, "round {round}, of {}", rows.faces.len());
    }
}
