//! Removes non-finite vertices and faces with missing vertices.

use meshlod_mesh::Mesh;

use super::edit::retain_faces;

/// Counts of the invalid vertices and faces removed.
pub struct Dropped {
    pub faces: usize,
    pub vertices: usize,
}

/// Removes non-finite vertices and the faces with a non-finite or missing vertex.
pub fn drop_invalid(mesh: &mut Mesh) -> Dropped {
    let mut kept = 0;
    let moved: Vec<Option<u32>> = mesh
        .positions
        .iter()
        .map(|position| {
            let finite = position.iter().all(|x| x.is_finite());
            kept += u32::from(finite);
            finite.then(|| kept - 1)
        })
        .collect();
    let to = |v: usize| moved.get(v).copied().flatten();
    let faces = {
        let valid: Vec<bool> =
            mesh.faces.iter().map(|face| face.iter().all(|v| to(v.index()).is_some())).collect();
        retain_faces(mesh, |face| valid[face])
    };
    let vertices = mesh.positions.len() - kept as usize;
    if vertices > 0 {
        mesh.positions.retain(|position| position.iter().all(|x| x.is_finite()));
        for v in mesh.faces.as_flattened_mut() {
            v.0 = to(v.index()).unwrap_or_default();
        }
    }
    Dropped { faces, vertices }
}
