//! Test meshes for distance measurements.

use meshlod_mesh::{Mesh, VertexId};

fn mesh<const N: usize>(positions: Vec<[f64; 3]>, faces: [[u32; 3]; N]) -> Mesh {
    Mesh::new(positions, faces.iter().map(|face| face.map(VertexId)).collect())
}

pub fn tetrahedron() -> Mesh {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    mesh(positions, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
}

pub fn cube() -> Mesh {
    let bit = |i: u32, k: u32| f64::from(i >> k & 1);
    let positions = (0..8).map(|i| [bit(i, 0), bit(i, 1), bit(i, 2)]).collect();
    let faces = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    mesh(positions, faces)
}

/// Builds a sphere about the origin with `n` rings and `2n` sectors, its vertices on the exact
/// sphere.
pub fn sphere(n: usize, radius: f64) -> Mesh {
    let turn = std::f64::consts::PI / n as f64;
    let mut positions = vec![[0.0, 0.0, radius]];
    for ring in 1..n {
        let (sin, cos) = (ring as f64 * turn).sin_cos();
        positions.extend((0..2 * n).map(|sector| {
            let (y, x) = (sector as f64 * turn).sin_cos();
            [x * sin, y * sin, cos].map(|x| x * radius)
        }));
    }
    positions.push([0.0, 0.0, -radius]);
    // Each pole stands for a whole ring.
    let south = positions.len() - 1;
    let vertex = |ring: usize, sector: usize| match ring {
        0 => VertexId(0),
        _ if ring == n => VertexId::new(south),
        _ => VertexId::new(1 + (ring - 1) * 2 * n + sector % (2 * n)),
    };
    let squares = (0..n).flat_map(|ring| (0..2 * n).map(move |sector| (ring, sector)));
    let faces = squares.flat_map(|(ring, sector)| {
        let [a, b] = [vertex(ring, sector), vertex(ring, sector + 1)];
        let [d, c] = [vertex(ring + 1, sector), vertex(ring + 1, sector + 1)];
        [[a, d, c], [a, c, b]]
    });
    Mesh::new(positions, faces.filter(|[a, b, c]| a != b && b != c && c != a).collect())
}

/// Builds the unit square at height `z` from `n` by `n` squares.
pub fn plane(n: usize, z: f64) -> Mesh {
    let at = |i: usize| i as f64 / n as f64;
    let vertex = |x: usize, y: usize| VertexId::new(y * (n + 1) + x);
    let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| [at(x), at(y), z])).collect();
    let faces = (0..n).flat_map(|y| (0..n).map(move |x| (x, y))).flat_map(|(x, y)| {
        let [a, b] = [vertex(x, y), vertex(x + 1, y)];
        let [d, c] = [vertex(x, y + 1), vertex(x + 1, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    Mesh::new(positions, faces.collect())
}

pub fn moved(mesh: &Mesh, offset: f64) -> Mesh {
    mapped(mesh, |x| x + offset)
}

pub fn scaled(mesh: &Mesh, scale: f64) -> Mesh {
    mapped(mesh, |x| x * scale)
}

fn mapped(mesh: &Mesh, change: impl Fn(f64) -> f64) -> Mesh {
    let positions = mesh.positions.iter().map(|position| position.map(&change)).collect();
    Mesh::new(positions, mesh.faces.clone())
}
