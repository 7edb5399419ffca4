//! Models brought into the frame of a member: facing +z, up +y, one body length long.

use glam::{DMat3, DVec3};
use meshlod_mesh::{LayerKind, Mesh};
use serde::{Deserialize, Serialize};

use crate::levels::normals::add_normals;
use crate::levels::table::TableError;

/// Axes of a model, which say how it becomes a member of a flock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ModelAxes {
    /// Direction in which the model swims, a vector of any length.
    pub forward: [f64; 3],
    /// Direction that is up for the model, a vector of any length.
    pub up: [f64; 3],
}

impl Default for ModelAxes {
    /// Faces +z with +y up, as models in glTF do.
    fn default() -> Self {
        Self { forward: [0.0, 0.0, 1.0], up: [0.0, 1.0, 0.0] }
    }
}

impl ModelAxes {
    /// Axes of the sample fish, which swims towards -x.
    pub const FISH: Self = Self { forward: [-1.0, 0.0, 0.0], up: [0.0, 1.0, 0.0] };

    /// Returns the rotation from model axes to the frame of a member: left, up, heading.
    fn rotation(&self) -> Option<DMat3> {
        let forward = DVec3::from(self.forward).try_normalize()?;
        let left = DVec3::from(self.up).cross(forward).try_normalize()?;
        Some(DMat3::from_cols(left, forward.cross(left), forward).transpose())
    }
}

/// Returns the model in the frame of a member, with normals: centred in its bounding box, and
/// scaled so that its longest side is 1. A [`LevelTable`](crate::levels::LevelTable) is built on it.
///
/// # Errors
/// An invalid model or one without extent, and axes that do not span a plane.
pub fn in_member_frame(model: &Mesh, axes: &ModelAxes) -> Result<Mesh, TableError> {
    model.validate()?;
    let rotation = axes.rotation().ok_or(TableError::Axes(*axes))?;
    let mut mesh = model.clone();
    mesh.positions.iter_mut().for_each(|p| *p = (rotation * DVec3::from(*p)).into());
    let bounds = mesh.bounds();
    let [min, max] = [DVec3::from(bounds.min), DVec3::from(bounds.max)];
    let length = (max - min).max_element();
    if bounds.is_empty() || !length.is_normal() || length <= 0.0 {
        return Err(TableError::NoExtent);
    }
    let middle = min.midpoint(max);
    for p in &mut mesh.positions {
        *p = ((DVec3::from(*p) - middle) / length).into();
    }
    if !mesh.positions.iter().flatten().all(|x| x.is_finite()) {
        return Err(TableError::NoExtent);
    }
    rotate_layers(&mut mesh, rotation);
    add_normals(&mut mesh);
    Ok(mesh)
}

/// Rotates normals and tangents with the model.
fn rotate_layers(mesh: &mut Mesh, rotation: DMat3) {
    let layers = mesh.attributes.iter_mut().flat_map(|attributes| &mut attributes.layers);
    for layer in layers.filter(|l| matches!(l.kind, LayerKind::Normal | LayerKind::Tangent)) {
        for value in layer.values.chunks_exact_mut(layer.width) {
            let turned = rotation * DVec3::new(value[0].into(), value[1].into(), value[2].into());
            value[..3].copy_from_slice(&turned.as_vec3().to_array());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fish_faces_forwards() {
        let fish = meshlod_samples::fish(2_000);
        let mesh = in_member_frame(&fish, &ModelAxes::FISH).unwrap();
        let bounds = mesh.bounds();
        assert!((bounds.max[2] - 0.5).abs() < 1e-12 && (bounds.min[2] + 0.5).abs() < 1e-12);
        // Its left side, towards +z, is now towards +x.
        let most = |m: &Mesh, axis: usize| {
            let key = |i: &usize| m.positions[*i][axis];
            (0..m.positions.len()).max_by(|a, b| key(a).total_cmp(&key(b))).unwrap()
        };
        assert_eq!(most(&fish, 2), most(&mesh, 0));
    }

    #[test]
    fn models_without_extent_or_axes_are_refused() {
        let dot = Mesh::new(vec![[1.0; 3]; 3], vec![[0, 1, 2].map(meshlod_mesh::VertexId)]);
        assert!(matches!(in_member_frame(&dot, &ModelAxes::default()), Err(TableError::NoExtent)));
        let none = in_member_frame(&Mesh::default(), &ModelAxes::default());
        assert!(matches!(none, Err(TableError::NoExtent)));
        let axes = ModelAxes { forward: [0.0; 3], ..ModelAxes::default() };
        let fish = meshlod_samples::fish(2_000);
        assert!(matches!(in_member_frame(&fish, &axes), Err(TableError::Axes(_))));
    }
}
