//! Extraction of the current mesh from a surface being simplified.

use meshlod_mesh::{FaceId, Mesh, VertexId};

use crate::surface::Surface;

/// Returns the mesh of the remaining faces, with the vertices and wedges they use, in the order of
/// the input.
pub(crate) fn level(mesh: &Mesh, surface: &Surface) -> Mesh {
    let kept: Vec<u32> =
        (0..surface.face_count() as u32).filter(|&f| surface.is_alive(FaceId(f))).collect();
    let attributes = mesh.attributes.as_ref().and(surface.wedges.as_ref());
    let mut level = Mesh {
        positions: (0..surface.vertex_count())
            .map(|v| surface.position(VertexId::new(v)).into())
            .collect(),
        faces: kept.iter().map(|&f| surface.face(FaceId(f))).collect(),
        attributes: attributes.map(|wedges| wedges.select(&kept)),
        materials: mesh.materials.as_ref().map(|labels| labels.select(&kept)),
        objects: mesh.objects.as_ref().map(|labels| labels.select(&kept)),
        face_layers: mesh.select_face_layers(&kept),
    };
    level.compact();
    level
}
