//! Simplification by meshoptimizer with its border lock.

use meshlod::mesh::{Labels, Mesh, VertexId};
use meshopt::{SimplifyOptions, simplify_decoder};

/// Simplifies a mesh to about `faces` faces by meshoptimizer with open borders locked, using
/// positions only. No vertex moves, and unused vertices stay in the list.
///
/// Objects are kept if no two share a vertex: a face belongs to the object of two of its corners,
/// because at coincident vertices the library may replace all of them by a vertex of another
/// object.
pub fn simplify_with_border_lock(mesh: &Mesh, faces: usize) -> Mesh {
    let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.map(|x| x as f32)).collect();
    let indices: Vec<u32> = mesh.faces.iter().flatten().map(|v| v.0).collect();
    let lock = SimplifyOptions::LockBorder;
    let left = simplify_decoder(&indices, &positions, 3 * faces, f32::MAX, lock, None);
    let (triples, _) = left.as_chunks::<3>();
    let faces = triples.iter().map(|face| face.map(VertexId)).collect();
    let mut level = Mesh::new(mesh.positions.clone(), faces);
    level.objects = mesh.objects.as_ref().map(|objects| Labels {
        names: objects.names.clone(),
        of_face: by_corners(&level.faces, &of_vertices(mesh, objects)),
    });
    level
}

/// Returns the object of each vertex; 0 for unused vertices.
fn of_vertices(mesh: &Mesh, objects: &Labels) -> Vec<u32> {
    let mut of_vertex = vec![0; mesh.positions.len()];
    for (face, &object) in mesh.faces.iter().zip(&objects.of_face) {
        face.iter().for_each(|v| of_vertex[v.index()] = object);
    }
    of_vertex
}

fn by_corners(faces: &[[VertexId; 3]], of_vertex: &[u32]) -> Vec<u32> {
    let of_face = |face: &[VertexId; 3]| {
        let [a, b, c] = face.map(|v| of_vertex[v.index()]);
        if b == c { b } else { a }
    };
    faces.iter().map(of_face).collect()
}

#[cfg(test)]
mod tests {
    use meshlod::mesh::face_components;
    use meshlod::samples;

    use super::*;

    #[test]
    fn levels_have_the_size_asked_for_and_the_objects_of_the_mesh() {
        let mut mesh = samples::sphere(2000);
        let ball = mesh.clone();
        let moved = |v: VertexId| VertexId::new(ball.positions.len() + v.index());
        mesh.faces.extend(ball.faces.iter().map(|face| face.map(moved)));
        mesh.positions.extend(ball.positions.iter().map(|&[x, y, z]| [x + 3.0, y, z]));
        let (of_face, _) = face_components(&mesh.faces, mesh.positions.len());
        mesh.objects = Some(Labels { names: vec!["left".into(), "right".into()], of_face });
        let level = simplify_with_border_lock(&mesh, 400);
        level.validate().unwrap();
        assert!((380..=400).contains(&level.faces.len()), "{}", level.faces.len());
        for (face, object) in level.faces.iter().zip(level.objects.unwrap().of_face) {
            assert!(face.iter().all(|v| (v.index() >= ball.positions.len()) == (object == 1)));
        }
    }

    #[test]
    fn a_face_is_of_the_object_of_two_of_its_corners() {
        let faces = [[0, 1, 2], [2, 0, 1], [1, 2, 0], [3, 4, 2]].map(|face| face.map(VertexId));
        assert_eq!(by_corners(&faces, &[5, 5, 7, 7, 7]), [5, 5, 5, 7]);
    }
}
