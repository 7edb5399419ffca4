//! A sample mesh broken on purpose, in every way that `repair` mends.

use std::collections::HashMap;
use std::path::Path;

use meshlod::mesh::VertexId;
use meshlod::{Mesh, Scene, WriteOptions, write};

use crate::demo::pipeline::steps::BROKEN;
use crate::session::failure::Failure;

/// Writes a mesh with a hole, a tear, reversed faces and duplicate faces.
pub fn write_file(mesh: &Mesh, folder: &Path) -> Result<(), Failure> {
    let scene = Scene::from_mesh("broken", broken(mesh));
    Ok(write(folder.join(BROKEN), &scene, &WriteOptions::default())?)
}

/// Where the mesh is broken, on its side that faces +z: the place as fractions of the width and
/// height, and the radius as a fraction of the diagonal.
struct Spot([f64; 2], f64);

const HOLE: Spot = Spot([0.62, 0.62], 0.02);
const REVERSED: Spot = Spot([0.55, 0.7], 0.05);
const TORN: Spot = Spot([0.25, 0.55], 0.05);
const TWICE: Spot = Spot([0.72, 0.45], 0.025);

/// Breaks the geometry of a mesh; attributes are left out.
fn broken(mesh: &Mesh) -> Mesh {
    let [hole, reversed, torn, twice] = [HOLE, REVERSED, TORN, TWICE].map(|spot| spot.faces(mesh));
    let mut positions = mesh.positions.clone();
    let mut copies: HashMap<VertexId, VertexId> = HashMap::new();
    let mut faces = Vec::new();
    for (i, face) in mesh.faces.iter().enumerate().filter(|(i, _)| !hole[*i]) {
        let [a, b, c] = *face;
        if twice[i] {
            faces.push([a, b, c]);
        }
        faces.push(match (reversed[i], torn[i]) {
            (true, _) => [a, c, b],
            (_, true) => face.map(|v| {
                *copies.entry(v).or_insert_with(|| {
                    positions.push(mesh.positions[v.index()]);
                    VertexId::new(positions.len() - 1)
                })
            }),
            _ => [a, b, c],
        });
    }
    Mesh::new(positions, faces)
}

impl Spot {
    /// Returns for each face whether its middle is in the ball around the spot.
    fn faces(&self, mesh: &Mesh) -> Vec<bool> {
        let Self(_, radius) = *self;
        let most = (radius * mesh.bounds().diagonal()).powi(2);
        let center = self.center(mesh);
        let is_inside = |face: &[VertexId; 3]| {
            let [a, b, c] = mesh.triangle(*face).map(|corner| corner.to_array());
            let middle = [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
            square_distance(middle, center) < most
        };
        mesh.faces.iter().map(is_inside).collect()
    }

    /// Returns the vertex nearest to the place as seen from far away along the z axis.
    fn center(&self, mesh: &Mesh) -> [f64; 3] {
        let (Self(place, _), bounds) = (self, mesh.bounds());
        let at =
            |axis: usize| bounds.min[axis] + place[axis] * (bounds.max[axis] - bounds.min[axis]);
        let seen = [at(0), at(1), bounds.max[2]];
        let from_there = |p: &&[f64; 3]| square_distance(**p, seen);
        let nearest = mesh.positions.iter().min_by(|a, b| from_there(a).total_cmp(&from_there(b)));
        *nearest.expect("a sample has vertices")
    }
}

fn square_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    [0, 1, 2].map(|axis| (a[axis] - b[axis]).powi(2)).iter().sum()
}
