//! What cannot be: vertices that are nowhere, faces that name what is not there.

use meshlod_mesh::Mesh;

use super::edit::retain_faces;

/// How much was left out.
pub struct Dropped {
    pub faces: usize,
    pub vertices: usize,
}

/// Leaves out vertices that are not finite, and the faces that name one or a vertex that is not
/// there.
pub fn drop_bad(mesh: &mut Mesh) -> Dropped {
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
        let sound: Vec<bool> =
            mesh.faces.iter().map(|face| face.iter().all(|v| to(v.index()).is_some())).collect();
        retain_faces(mesh, |face| sound[face])
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
