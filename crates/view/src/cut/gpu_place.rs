//! Place of a mesh as shaders read it.

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DMat4, DVec3};
use meshlod::model::LevelInstance;
use wgpu::{VertexBufferLayout, VertexStepMode, vertex_attr_array};

/// `Place` of cut.wgsl: rows of matrices that take positions, and normals, relative to the origin.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct GpuPlace([[f32; 4]; 6]);

/// Layout of a buffer with a place for each instance.
pub(super) const PLACES: VertexBufferLayout<'static> = VertexBufferLayout {
    array_stride: size_of::<GpuPlace>() as u64,
    step_mode: VertexStepMode::Instance,
    attributes: &vertex_attr_array![
        4 => Float32x4, 5 => Float32x4, 6 => Float32x4, 7 => Float32x4, 8 => Float32x4, 9 => Float32x4
    ],
};

impl GpuPlace {
    /// Place of an untransformed mesh.
    pub(super) const OWN: Self = Self([
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0, 1.0],
        [0.0, 0.0, 1.0, 1.0],
    ]);

    /// Returns the place of an instance, for positions relative to `origin` before and after.
    pub(super) fn new(instance: &LevelInstance, origin: DVec3) -> Self {
        let matrix = DMat4::from_cols_array_2d(&instance.transform);
        let linear = DMat3::from_mat4(matrix);
        let offset = matrix.transform_point3(origin) - origin;
        let rows = linear.transpose();
        let [x, y, z] = [0, 1, 2].map(|k| rows.col(k).extend(offset[k]).as_vec4().into());
        // Cofactors turn normals as the inverse transpose does, and have no division.
        let [a, b, c] = [linear.x_axis, linear.y_axis, linear.z_axis];
        let side = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
        let cofactors = DMat3::from_cols(b.cross(c), c.cross(a), a.cross(b)) * side;
        let largest = cofactors.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
        let scale = if largest > 0.0 { 1.0 / largest } else { 1.0 };
        let rows = (cofactors * scale).transpose();
        let [i, j, k] = [0, 1, 2].map(|k| rows.col(k).extend(side).as_vec4().into());
        Self([x, y, z, i, j, k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_move_positions_about_the_origin_and_turn_normals() {
        let origin = DVec3::new(4.5e6, 0.0, 1.0);
        let stretch = DMat4::from_scale(DVec3::new(2.0, -1.0, 1.0));
        let transform = DMat4::from_translation(origin) * stretch;
        let transform = (transform * DMat4::from_translation(-origin)).to_cols_array_2d();
        let GpuPlace(rows) = GpuPlace::new(&LevelInstance { mesh: 0, transform }, origin);
        assert_eq!(rows[0], [2.0, 0.0, 0.0, 0.0]);
        assert_eq!(rows[1], [0.0, -1.0, 0.0, 0.0]);
        // A plane across (1, 0, 0) stays one, and so does one across (0, 1, 0), turned over.
        assert_eq!(rows[3], [0.5, 0.0, 0.0, -1.0]);
        assert_eq!(rows[4], [0.0, -1.0, 0.0, -1.0]);
        let own = DMat4::IDENTITY.to_cols_array_2d();
        let own = GpuPlace::new(&LevelInstance { mesh: 0, transform: own }, origin);
        assert_eq!(own, GpuPlace::OWN);
    }
}
