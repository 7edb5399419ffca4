//! Cameras that look at a flock.

use glam::{DVec3, Vec3};
use meshlod_multires::ViewCamera;
use thiserror::Error;

use crate::members::frame_of;

/// Perspective camera with square pixels, in body lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlockCamera {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    size: [u32; 2],
    /// Tangents of half the fields of view across and down.
    tangents: [f32; 2],
    fov_rad: f32,
    velocity: Vec3,
    gaze: [f32; 2],
}

/// Reason why a camera cannot be made.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum CameraError {
    /// The eye or the target has a coordinate that is not finite.
    #[error("the camera's eye and target must be finite, not {eye:?} and {target:?}")]
    NotFinite {
        /// Position of the eye.
        eye: [f32; 3],
        /// Point that the camera looks at.
        target: [f32; 3],
    },
    /// The eye is at the target, so that there is no direction to look in.
    #[error("the camera's eye is at its target, {0:?}")]
    NoDirection([f32; 3]),
    /// The field of view is outside 1° to 150°.
    #[error("the camera's field of view must be between 1° and 150°, not {0}°")]
    FieldOfView(f32),
    /// The picture has no pixels.
    #[error("the camera's picture must have pixels, not {0} x {1}")]
    Size(u32, u32),
}

impl FlockCamera {
    /// Creates a camera at `eye` that looks at `target`, with +y up in the picture.
    ///
    /// `fov_rad` is the field of view along the picture's shorter side, in radians; `size` is width
    /// and height in pixels.
    ///
    /// # Errors
    /// A coordinate that is not finite, an eye at the target, a field of view outside 1° to 150°,
    /// or a picture without pixels.
    pub fn look_at(
        eye: [f32; 3],
        target: [f32; 3],
        fov_rad: f32,
        size: [u32; 2],
    ) -> Result<Self, CameraError> {
        let (from, to) = (Vec3::from(eye), Vec3::from(target));
        if !(from.is_finite() && to.is_finite()) {
            return Err(CameraError::NotFinite { eye, target });
        }
        Self::look_along(eye, (to - from).into(), fov_rad, size)
    }

    /// Creates a camera at `eye` that looks along `forward`, a vector of any length above zero, with
    /// +y up in the picture; the rest is as in [`FlockCamera::look_at`].
    ///
    /// A unit vector is kept bit for bit, so that a camera can be stored by it.
    ///
    /// # Errors
    /// Those of [`FlockCamera::look_at`].
    pub fn look_along(
        eye: [f32; 3],
        forward: [f32; 3],
        fov_rad: f32,
        size: [u32; 2],
    ) -> Result<Self, CameraError> {
        let (from, along) = (Vec3::from(eye), Vec3::from(forward));
        if !(from.is_finite() && along.is_finite()) {
            let target = (from + along).into();
            return Err(CameraError::NotFinite { eye, target });
        }
        let is_unit = (along.length_squared() - 1.0).abs() < 1e-6;
        let forward = if is_unit { Some(along) } else { along.try_normalize() };
        let forward = forward.ok_or(CameraError::NoDirection(eye))?;
        if !(0.017..=2.62).contains(&fov_rad) {
            return Err(CameraError::FieldOfView(fov_rad.to_degrees()));
        }
        let [width, height] = size;
        if width == 0 || height == 0 {
            return Err(CameraError::Size(width, height));
        }
        let sideways = forward.cross(Vec3::Y).try_normalize();
        let right = sideways.unwrap_or(Vec3::X);
        let half = (fov_rad * 0.5).tan();
        let shorter = width.min(height) as f32;
        let tangents = size.map(|side| half * side as f32 / shorter);
        Ok(Self {
            eye: from,
            right,
            up: right.cross(forward),
            forward,
            size,
            tangents,
            fov_rad,
            velocity: Vec3::ZERO,
            gaze: [0.0; 2],
        })
    }

    /// Returns this camera moving at a velocity, in body lengths a second; one that is not finite
    /// counts as rest.
    pub fn moving(self, velocity: [f32; 3]) -> Self {
        let velocity = Vec3::from(velocity);
        Self { velocity: if velocity.is_finite() { velocity } else { Vec3::ZERO }, ..self }
    }

    /// Returns this camera for a viewer who looks at a point of the picture: 0 is the middle, -1 and
    /// 1 are the left and right, or the lower and upper rim. Values are clamped to that range.
    pub fn with_gaze(self, gaze: [f32; 2]) -> Self {
        Self { gaze: gaze.map(|x| if x.is_nan() { 0.0 } else { x.clamp(-1.0, 1.0) }), ..self }
    }

    /// Returns the velocity of the camera, in body lengths a second.
    pub fn velocity(&self) -> Vec3 {
        self.velocity
    }

    /// Returns the tangents of the angles between the view axis and where the viewer looks, to the
    /// right and up.
    pub fn gaze_tangents(&self) -> [f32; 2] {
        [self.gaze[0] * self.tangents[0], self.gaze[1] * self.tangents[1]]
    }

    /// Returns the position of the eye.
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// Returns unit vectors to the right, up and into the picture.
    pub fn axes(&self) -> [Vec3; 3] {
        [self.right, self.up, self.forward]
    }

    /// Returns width and height of the picture in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the tangents of half the fields of view across and down.
    pub fn tangents(&self) -> [f32; 2] {
        self.tangents
    }

    /// Returns the field of view along the picture's shorter side, in radians.
    pub fn fov_rad(&self) -> f32 {
        self.fov_rad
    }

    /// Returns the number of pixels that a body length spans at distance 1.
    pub fn pixels_at_one(&self) -> f32 {
        self.size[0] as f32 / (2.0 * self.tangents[0])
    }

    /// Returns the camera of [`meshlod_picture`] that sees the same, for drawing.
    pub fn for_picture(&self) -> meshlod_picture::Camera {
        self.looking(self.forward.as_dvec3())
    }

    /// Returns the camera of [`meshlod_multires`] that sees the model of a member, in the frame of
    /// the member, as this one sees the member.
    pub fn for_member(&self, position: Vec3, heading: Vec3) -> ViewCamera {
        let to_member = frame_of(heading).transpose();
        let local = |v: Vec3| (to_member * v).as_dvec3();
        let eye = local(self.eye - position);
        ViewCamera {
            eye: eye.into(),
            look: (eye + local(self.forward)).into(),
            up: local(self.up).into(),
            fov_rad: 2.0 * f64::from(self.tangents[1]).atan(),
            viewport: self.size,
        }
    }

    /// Returns the camera of [`meshlod_picture`] turned by a fraction of a pixel, to the right and
    /// up: its samples lie between those of [`FlockCamera::for_picture`].
    pub fn shifted(&self, pixels: [f64; 2]) -> meshlod_picture::Camera {
        let [right, up, forward] = self.axes().map(|axis| axis.as_dvec3());
        let pixel = 1.0 / f64::from(self.pixels_at_one());
        let way = forward + (right * pixels[0] + up * pixels[1]) * pixel;
        self.looking(way)
    }

    /// Returns the camera of [`meshlod_picture`] at the same place that looks along `way`.
    fn looking(&self, way: DVec3) -> meshlod_picture::Camera {
        let (eye, up) = (self.eye.as_dvec3(), self.up.as_dvec3());
        let target = (eye + way).to_array();
        meshlod_picture::Camera::look_at(eye.into(), target, up.into(), self.fov_rad.into())
            .with_near(NEAR)
    }
}

/// Distance of the near plane in pictures, in body lengths.
const NEAR: f64 = 0.01;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_that_sees_nothing_is_refused() {
        let look = |eye, target, fov| FlockCamera::look_at(eye, target, fov, [4, 3]);
        assert!(matches!(
            look([f32::NAN, 0.0, 0.0], [0.0; 3], 1.0),
            Err(CameraError::NotFinite { .. })
        ));
        assert!(matches!(look([1.0; 3], [1.0; 3], 1.0), Err(CameraError::NoDirection(_))));
        assert!(matches!(look([1.0; 3], [0.0; 3], f32::NAN), Err(CameraError::FieldOfView(_))));
        assert!(FlockCamera::look_at([1.0; 3], [0.0; 3], 1.0, [0, 3]).is_err());
    }

    #[test]
    fn straight_down_has_a_frame_too() {
        let camera = FlockCamera::look_at([0.0, 9.0, 0.0], [0.0; 3], 1.0, [40, 30]).unwrap();
        let [right, up, forward] = camera.axes();
        assert!((right.cross(up) + forward).length() < 1e-6 && right.is_normalized());
        assert!((camera.tangents()[0] / camera.tangents()[1] - 4.0 / 3.0).abs() < 1e-6);
    }
}
