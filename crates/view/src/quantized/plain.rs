//! Positions as three `f32`.

use std::borrow::Cow;

use glam::DVec3;
use meshlod::Mesh;

use super::data::{SchemeData, one_run};
use super::pipelines::SchemeShader;
use crate::mesh::middle;

/// Returns the positions of a mesh relative to its middle.
pub(super) fn data(mesh: &Mesh) -> SchemeData<'static> {
    let origin = middle(mesh);
    let place = |p: &[f64; 3]| (DVec3::from(*p) - DVec3::from(origin)).as_vec3().to_array();
    let positions: Vec<[f32; 3]> = mesh.positions.iter().map(place).collect();
    SchemeData {
        origin,
        scale: [1.0; 3],
        shader: SchemeShader::Plain,
        fetched: Some(Cow::Owned(bytemuck::cast_slice(&positions).to_vec())),
        storages: Default::default(),
        runs: one_run(mesh.faces.len()),
        offsets: None,
    }
}
