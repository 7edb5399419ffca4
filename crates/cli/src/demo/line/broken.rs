//! A sample mesh broken on purpose, in every way that `repair` mends.

use std::collections::HashMap;
use std::path::Path;

use meshlod::mesh::VertexId;
use meshlod::{Mesh, Scene, WriteOptions, write};

use crate::demo::line::steps::BROKEN;
use crate::failure::Failure;

/// Writes a mesh with a hole, a tear, reversed faces and duplicate faces.
pub fn write_file(mesh: &Mesh, folder: &Path) -> Result<(), Failure> {
    let scene = Scene::from_mesh("broken", broken(mesh));
    Ok(write(&folder.join(BROKEN), &scene, &WriteOptions::default())?)
}

/// Balls in which the mesh is broken: centers as fractions of the bounding box, and radii as
/// fractions of the diagonal.
const HOLE: ([f64; 3], f64) = ([0.62, 0.62, 0.0], 0.02);
const REVERSED: ([f64; 3], f64) = ([0.45, 0.5, 0.0], 0.05);
const TORN: ([f64; 3], f64) = ([0.3, 0.5, 0.0], 0.05);
const TWICE: ([f64; 3], f64) = ([0.72, 0.45, 0.0], 0.025);

/// Breaks the geometry of a mesh; attributes are left out.
fn broken(mesh: &Mesh) -> Mesh {
    let bounds = mesh.bounds();
    let inside = |face: &[VertexId; 3], (center, radius): ([f64; 3], f64)| {
        let corners = mesh.triangle(*face);
        let middle = ((corners[0] + corners[1] + corners[2]) / 3.0).to_array();
        let offset = |axis: usize| {
            let extent = bounds.max[axis] - bounds.min[axis];
            middle[axis] - (bounds.min[axis] + center[axis] * extent)
        };
        let square: f64 = [0, 1, 2].map(|axis| offset(axis).powi(2)).iter().sum();
        square < (radius * bounds.diagonal()).powi(2)
    };
    let mut positions = mesh.positions.clone();
    let mut copies: HashMap<VertexId, VertexId> = HashMap::new();
    let mut faces = Vec::new();
    for face in mesh.faces.iter().filter(|face| !inside(face, HOLE)) {
        let [a, b, c] = *face;
        if inside(face, TWICE) {
            faces.push([a, b, c]);
        }
        faces.push(match (inside(face, REVERSED), inside(face, TORN)) {
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
