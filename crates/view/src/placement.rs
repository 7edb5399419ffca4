//! How one thing is seen by one camera: matrix, lights, look.

use std::f32::consts::PI;

use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec3, DVec4, Mat4};
use meshlod::picture::{BackFaces, Camera, Lighting, Wireframe};
use wgpu::{BindGroup, Buffer, Queue};

use crate::Renderer;
use crate::gpu::bindings::bind_buffers;
use crate::gpu::buffers::uniform_of;

/// How one thing is seen by one camera: a small buffer on the GPU.
///
/// A thing in two views of one frame needs two placements, since all uploads of a frame come before
/// its first pass.
#[derive(Debug)]
pub struct Placement {
    buffer: Buffer,
    pub(crate) bind_group: BindGroup,
    queue: Queue,
}

/// Look of a thing, apart from its own colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shade {
    /// Lighting of the surface.
    pub lighting: Lighting,
    /// Appearance of faces seen from behind.
    pub back_faces: BackFaces,
    /// Flat shading: one normal per face.
    pub is_flat: bool,
    /// Lines along the edges of all faces; only drawing face by face shows them.
    pub wireframe: Option<Wireframe>,
    /// Use the colours of faces in place of the mesh's own.
    pub face_colors: bool,
    /// Use the colours of materials, textures and vertices, not only the tint.
    pub own_colors: bool,
    /// Draw a checkerboard in texture coordinates in place of textures.
    pub checker: bool,
    /// Share of the pixels that are drawn, 0 to 1, for dithered transitions. The shares t - 1 and t
    /// draw complementary pixels.
    pub shown: f32,
    /// sRGB colour by which the colour of the surface is multiplied.
    pub tint: [u8; 3],
}

impl Default for Shade {
    fn default() -> Self {
        Self {
            lighting: Lighting::default(),
            back_faces: BackFaces::default(),
            is_flat: false,
            wireframe: None,
            face_colors: false,
            own_colors: true,
            checker: false,
            shown: 1.0,
            tint: [255; 3],
        }
    }
}

/// `Draw` of draw.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct DrawUniforms {
    clip_from_local: [[f32; 4]; 4],
    eye: [f32; 3],
    lighting: u32,
    to_key: [f32; 3],
    flags: u32,
    up: [f32; 3],
    shown: f32,
    wire: [f32; 4],
    back: [f32; 3],
    wire_width: f32,
    tint: [f32; 3],
    seed: f32,
}

impl Renderer {
    /// Creates a placement, which must be set before it is used.
    pub fn placement(&self) -> Placement {
        let buffer = uniform_of(self.gpu(), "placement", &DrawUniforms::zeroed());
        let bind_group = bind_buffers(self.gpu(), &self.draw_layout, &[&buffer]);
        Placement { buffer, bind_group, queue: self.gpu().queue.clone() }
    }
}

impl Placement {
    /// Sets the camera, the size of the picture in pixels, the origin of the thing in the world,
    /// and its look.
    pub fn set(&self, camera: &Camera, size: [u32; 2], origin: [f64; 3], shade: &Shade) {
        let uniforms = DrawUniforms::new(camera, size, origin, shade);
        self.queue.write_buffer(&self.buffer, 0, bytemuck::bytes_of(&uniforms));
    }
}

impl DrawUniforms {
    fn new(camera: &Camera, size: [u32; 2], origin: [f64; 3], shade: &Shade) -> Self {
        let [right, up, forward] = camera.axes().map(|axis| DVec3::from(axis).as_vec3());
        let eye = (DVec3::from(camera.eye()) - DVec3::from(origin)).as_vec3();
        let wire = shade.wireframe.unwrap_or_default();
        let [r, g, b] = linear(wire.color);
        let back = match shade.back_faces {
            BackFaces::Same => [0; 3],
            BackFaces::Tint(color) => color,
        };
        let flags = [
            shade.is_flat,
            shade.back_faces != BackFaces::Same,
            shade.wireframe.is_some(),
            shade.face_colors,
            !shade.own_colors,
            shade.checker,
        ];
        Self {
            clip_from_local: clip_from_local(camera, size, origin).to_cols_array_2d(),
            eye: eye.into(),
            lighting: match shade.lighting {
                Lighting::Studio => 0,
                Lighting::Headlight => 1,
                Lighting::Soft => 2,
                Lighting::Unlit => 3,
            },
            to_key: (up * 0.75 - right * 0.6 - forward * 0.8).normalize_or_zero().into(),
            flags: flags.iter().enumerate().map(|(bit, &is_set)| u32::from(is_set) << bit).sum(),
            up: up.into(),
            shown: shade.shown,
            wire: [r, g, b, wire.opacity],
            back: linear(back),
            wire_width: wire.width_px,
            tint: linear(shade.tint),
            seed: PI,
        }
    }
}

/// Returns the matrix from coordinates relative to `origin` to clip space: depth is 1 at the near
/// plane and 0 at infinity.
pub(crate) fn clip_from_local(camera: &Camera, size: [u32; 2], origin: [f64; 3]) -> Mat4 {
    clip_from_world(camera, size, origin).as_mat4()
}

/// Returns [`clip_from_local`] before it is rounded.
pub(crate) fn clip_from_world(camera: &Camera, size: [u32; 2], origin: [f64; 3]) -> DMat4 {
    let [right, up, forward] = camera.axes().map(DVec3::from);
    let offset = DVec3::from(origin) - DVec3::from(camera.eye());
    let shorter = f64::from(size[0].min(size[1]).max(1));
    let [width, height] = size.map(|side| f64::from(side.max(1)) / shorter * camera.tan_half_fov());
    let row = |axis: DVec3, scale: f64| (axis * scale).extend(axis.dot(offset) * scale);
    let rows = [
        row(right, 1.0 / width),
        row(up, 1.0 / height),
        DVec4::new(0.0, 0.0, 0.0, camera.near()),
        row(forward, 1.0),
    ];
    DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
}

/// sRGB colour of surfaces without colours, the same as [`meshlod::scene::OwnedPaint::CLAY`].
pub(crate) const CLAY: [u8; 3] = [226, 208, 186];

/// Converts an sRGB colour to linear light.
pub(crate) fn linear(color: [u8; 3]) -> [f32; 3] {
    color.map(|level| {
        let x = f32::from(level) / 255.0;
        if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
    })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn depth_is_one_at_the_near_plane_and_zero_far_away() {
        let camera = Camera::look_at([1e6, 0.0, 5.0], [1e6, 0.0, 0.0], [0.0, 1.0, 0.0], 0.8);
        let matrix = clip_from_local(&camera, [200, 100], [1e6, 0.0, 0.0]);
        let depth = |z: f32| {
            let clip = matrix * Vec3::new(0.0, 0.0, z).extend(1.0);
            clip.z / clip.w
        };
        assert!((depth(5.0 - camera.near() as f32) - 1.0).abs() < 1e-3);
        assert!(depth(0.0) > depth(-1.0) && depth(-1e9) > 0.0 && depth(-1e9) < 1e-6);
    }

    #[test]
    fn the_shorter_side_has_the_field_of_view() {
        let camera =
            Camera::look_at([0.0, 0.0, 1.0], [0.0; 3], [0.0, 1.0, 0.0], f64::from(PI) / 2.0);
        let matrix = clip_from_local(&camera, [200, 100], [0.0; 3]);
        let at = matrix.project_point3(Vec3::new(0.5, 0.5, 0.0));
        assert!((at.x - 0.25).abs() < 1e-6 && (at.y - 0.5).abs() < 1e-6, "{at}");
    }
}
