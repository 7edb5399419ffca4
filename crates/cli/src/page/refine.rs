//! Subdivision of a mesh, so that colours at its vertices represent the whole surface.

use meshlod::Mesh;
use meshlod::mesh::{Labels, VertexId};

/// Limit of cuts along a side of a face, so that one face gives at most a million.
const MOST_CUTS: usize = 1000;

/// Subdivides the faces until no edge is longer than `step`, in model units, or a limit on the
/// number of cuts is reached.
///
/// Every face is cut by itself, so vertices on shared edges are duplicated. Of the attributes,
/// material labels are kept.
pub fn refined(mesh: &Mesh, step: f64) -> Mesh {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    let mut label_of_face = Vec::new();
    for (index, &face) in mesh.faces.iter().enumerate() {
        let [a, b, c] = mesh.triangle(face);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let cuts = ((longest / step).ceil() as usize).clamp(1, MOST_CUTS);
        let first = positions.len();
        for row in 0..=cuts {
            for column in 0..=row {
                let [u, v] = [row - column, column].map(|i| i as f64 / cuts as f64);
                positions.push((a + (b - a) * u + (c - a) * v).to_array());
            }
        }
        faces.extend(pieces(first, cuts));
        if let Some(labels) = &mesh.materials {
            label_of_face.resize(faces.len(), labels.of(index));
        }
    }
    let relabel = |labels: &Labels| Labels { names: labels.names.clone(), of_face: label_of_face };
    Mesh { materials: mesh.materials.as_ref().map(relabel), ..Mesh::new(positions, faces) }
}

/// Returns the faces between rows of vertices: row `r` begins `r (r + 1) / 2` after the first.
///
/// ```text
///  0
///  1 2
///  3 4 5
/// ```
fn pieces(first: usize, cuts: usize) -> impl Iterator<Item = [VertexId; 3]> {
    let id = move |row: usize, column: usize| VertexId::new(first + row * (row + 1) / 2 + column);
    (0..cuts).flat_map(move |row| {
        let upright = (0..=row).map(move |i| [id(row, i), id(row + 1, i), id(row + 1, i + 1)]);
        let hanging = (0..row).map(move |i| [id(row, i), id(row + 1, i + 1), id(row, i + 1)]);
        upright.chain(hanging)
    })
}

#[cfg(test)]
mod tests {
    use meshlod::measure::{area, volume};
    use meshlod::samples;

    use super::*;

    #[test]
    fn a_refined_mesh_is_the_same_surface() {
        let mesh = samples::sphere(200);
        let fine = refined(&mesh, 0.05);
        assert!(fine.validate().is_ok() && fine.faces.len() > 10 * mesh.faces.len());
        assert!((area(&fine) / area(&mesh) - 1.0).abs() < 1e-12);
        assert!((volume(&fine) / volume(&mesh) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn small_faces_stay_whole() {
        let mesh = samples::sphere(200);
        assert_eq!(refined(&mesh, 10.0).faces.len(), mesh.faces.len());
    }
}
