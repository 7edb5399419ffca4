//! An assembly of closed bodies, triangulated as CAD systems do.

use std::f64::consts::TAU;

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};

use crate::blocks::{cube, placed};
use crate::grid::split;
use crate::plate::with_holes;
use crate::random::Random;

/// Builds boxes, cylinders, and plates with round holes, of random sizes and turned at random, as many
/// as it takes. None touches another.
///
/// Each is closed; a plate of k × k holes has genus k². The face count is at least `faces`, and less
/// than 2,400 above.
pub fn parts(faces: usize, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let (mut bodies, mut count) = (Vec::new(), 0);
    while bodies.is_empty() || count < faces {
        let body = body(&mut random);
        count += body.faces.len();
        bodies.push(body);
    }
    // A cell of a grid for each.
    let cells = (bodies.len() as f64).cbrt().ceil() as usize;
    let half = 1.0 / cells as f64;
    let mut all = Mesh::default();
    for (i, body) in bodies.iter().enumerate() {
        let radius = half * random.scale(0.2, 0.99);
        let cell = [i % cells, i / cells % cells, i / cells / cells];
        let middle = cell.map(|at| {
            let aside = (half - radius) * (2.0 * random.unit() - 1.0);
            half * (2 * at + 1) as f64 - 1.0 + aside
        });
        let (turn, middle) = (random.rotation(), DVec3::from(middle));
        let farthest = body.positions.iter().map(|&at| DVec3::from(at).length());
        let scale = radius / farthest.fold(0.0, f64::max);
        let first = all.positions.len();
        all.positions.extend(placed(body, |at| middle + turn * (scale * at)).positions);
        let moved = |face: &[VertexId; 3]| face.map(|v| VertexId::new(first + v.index()));
        all.faces.extend(body.faces.iter().map(moved));
    }
    all
}

/// Makes a body around the origin: every second one a box, every eighth a plate.
fn body(random: &mut Random) -> Mesh {
    match random.whole(0, 7) {
        0..=3 => {
            let size = DVec3::from_array([(); 3].map(|()| random.scale(0.1, 1.0)));
            placed(&cube(12), |at| size * at)
        }
        4..=6 => cylinder(random.whole(12, 48), random.scale(0.1, 3.0)),
        _ => {
            let (holes, sides) = (random.whole(1, 3), 4 * random.whole(3, 16));
            let size = DVec3::new(1.0, random.scale(0.2, 3.0), random.scale(0.3, 1.0));
            placed(&with_holes(holes, sides), |at| size * at)
        }
    }
}

/// Builds a cylinder of radius 1 about the y axis, with no vertex but on the rims of its bases.
fn cylinder(sides: usize, half_height: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for height in [-half_height, half_height] {
        mesh.positions.extend((0..sides).map(|k| {
            let (sine, cosine) = (TAU * k as f64 / sides as f64).sin_cos();
            [cosine, height, -sine]
        }));
    }
    let at = |k: usize, is_upper: bool| VertexId::new(k % sides + sides * usize::from(is_upper));
    for k in 0..sides {
        let side = [at(k, false), at(k + 1, false), at(k + 1, true), at(k, true)];
        mesh.faces.extend(split(side));
    }
    for k in 1..sides - 1 {
        mesh.faces.push([at(0, false), at(k + 1, false), at(k, false)]);
        mesh.faces.push([at(0, true), at(k, true), at(k + 1, true)]);
    }
    mesh
}
