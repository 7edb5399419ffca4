//! Sources for tests.

use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, WedgeId};

use super::{Source, Triangles};

/// Returns a terrain of about this many faces, with layers of some kinds.
pub(crate) fn patch(faces: usize, kinds: &[LayerKind]) -> Mesh {
    let mesh = meshlod_samples::terrain(faces);
    let layer = |&kind: &LayerKind| {
        let value = |place: &[f64; 3]| match kind {
            LayerKind::Normal => vec![0.0, 1.0, 0.0],
            LayerKind::Uv(_) => vec![place[0] as f32, place[2] as f32],
            _ => place.iter().map(|x| ((x + 1.0) * 127.0).floor() as f32 / 255.0).collect(),
        };
        let values: Vec<f32> = mesh.positions.iter().flat_map(value).collect();
        let width = values.len() / mesh.positions.len();
        Layer { kind, name: kind.to_string(), width, values }
    };
    let attributes = Attributes {
        corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
        wedge_count: mesh.positions.len(),
        layers: kinds.iter().map(layer).collect(),
    };
    Mesh { attributes: Some(attributes), ..mesh }
}

/// Returns all triangles of a source.
pub(crate) fn all(source: &dyn Source) -> Triangles {
    let mut all = Triangles::default();
    let added = source.triangles(&mut |some| {
        assert!(some.places.len() <= super::MOST_TRIANGLES);
        all.places.extend(&some.places);
        all.values.extend(&some.values);
        all.materials.extend(&some.materials);
        Ok(())
    });
    added.unwrap();
    all
}
