//! The sample fish as modellers make fish: a body with fins that only touch it and eyes that stick
//! in it, each a mesh of its own.

use meshlod::mesh::{Mesh, VertexId};
use meshlod::samples;

/// Number of faces of the sample before it is taken apart, and of each eyeball.
const FACES: usize = 6_000;
const EYE_FACES: usize = 300;

/// Builds the fish in parts. Each texture chart of the sample becomes a part with vertices of its
/// own, so fins touch the body along open borders; a ball crosses the body at each side of the head.
pub fn fish_in_parts() -> Mesh {
    let fish = samples::fish(FACES);
    let wedges = fish.attributes.as_ref().map_or_else(Vec::new, |all| all.corners.clone());
    // A vertex of the result for each wedge: charts have no wedge in common.
    let corners: Vec<[u32; 3]> = wedges.iter().map(|face| face.map(|wedge| wedge.0)).collect();
    let count = corners.iter().flatten().max().map_or(0, |&most| most as usize + 1);
    let mut mesh = Mesh::new(vec![[0.0; 3]; count], Vec::new());
    for (face, own) in fish.faces.iter().zip(&corners) {
        for (v, &wedge) in face.iter().zip(own) {
            mesh.positions[wedge as usize] = fish.positions[v.index()];
        }
        mesh.faces.push(own.map(VertexId));
    }
    let mesh = joined_along_the_body(mesh);
    let eyes = [1.0, -1.0].map(|side| eye(&mesh, side));
    eyes.into_iter().fold(mesh, both)
}

/// Joins the belly seam again, where the body's chart is cut: of the vertices at one place, those of
/// the largest part become one.
fn joined_along_the_body(mut mesh: Mesh) -> Mesh {
    let (of_face, parts) = meshlod::mesh::face_components(&mesh.faces, mesh.positions.len());
    let mut sizes = vec![0; parts];
    of_face.iter().for_each(|&part| sizes[part as usize] += 1);
    let body = (0..parts).max_by_key(|&part| sizes[part]).unwrap_or(0) as u32;
    let mut first = std::collections::BTreeMap::new();
    for (face, part) in mesh.faces.iter_mut().zip(&of_face) {
        if *part == body {
            for v in face {
                let place = mesh.positions[v.index()].map(f64::to_bits);
                *v = *first.entry(place).or_insert(*v);
            }
        }
    }
    mesh
}

/// Builds an eyeball that is half in the head.
fn eye(fish: &Mesh, side: f64) -> Mesh {
    let looks = |p: &&[f64; 3]| (p[0] + 0.72).abs() < 0.04 && (p[1] - 0.06).abs() < 0.04;
    let skin = fish.positions.iter().filter(looks).map(|p| side * p[2]).fold(0.0, f64::max);
    let mut ball = samples::sphere(EYE_FACES);
    let middle = [-0.72, 0.06, side * skin];
    for position in &mut ball.positions {
        *position = std::array::from_fn(|k| middle[k] + 0.07 * position[k]);
    }
    ball
}

fn both(mut mesh: Mesh, other: Mesh) -> Mesh {
    let base = mesh.positions.len();
    mesh.positions.extend(other.positions);
    mesh.faces.extend(other.faces.iter().map(|f| f.map(|v| VertexId::new(base + v.index()))));
    mesh
}
