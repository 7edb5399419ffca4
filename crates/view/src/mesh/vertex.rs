//! Vertices as buffers hold them.

use wgpu::{VertexBufferLayout, VertexStepMode, vertex_attr_array};

/// Attributes of a vertex in a buffer: 20 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct VertexAttributes {
    /// Normal as 16-bit fractions; the fourth is padding.
    pub normal: [i16; 4],
    /// sRGB colour.
    pub color: [u8; 4],
    pub uv: [f32; 2],
}

/// Layout of positions, then of attributes.
pub(crate) const VERTEX_BUFFERS: [VertexBufferLayout<'static>; 2] = [
    VertexBufferLayout {
        array_stride: 12,
        step_mode: VertexStepMode::Vertex,
        attributes: &vertex_attr_array![0 => Float32x3],
    },
    VertexBufferLayout {
        array_stride: 20,
        step_mode: VertexStepMode::Vertex,
        attributes: &vertex_attr_array![1 => Snorm16x4, 2 => Unorm8x4, 3 => Float32x2],
    },
];

impl VertexAttributes {
    /// Attributes without a normal and texture coordinates.
    pub(super) const WHITE: Self = Self { normal: [0; 4], color: [255; 4], uv: [0.0; 2] };
}

/// Packs a unit vector in 16-bit fractions.
pub(crate) fn fractions(normal: [f32; 3]) -> [i16; 4] {
    let [x, y, z] = normal.map(|x| (x * 32767.0).round() as i16);
    [x, y, z, 0]
}
