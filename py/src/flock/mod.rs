//! Flocks: levels of a model, films of schools, and the level of every member.

mod film;
mod level_table;
mod member_sizes;
mod members;
mod selector;

pub use film::NativeFilm;
pub use level_table::NativeLevelTable;
pub use selector::NativeSelector;

use meshlod::flock::FlockCamera;
use pyo3::prelude::*;

use crate::errors::raised;

/// A camera of a flock: eye, direction of view, field of view along the shorter side of the picture
/// in radians, width and height in pixels, velocity, and where in the picture the viewer looks.
type CameraArguments = ([f32; 3], [f32; 3], f32, [u32; 2], [f32; 3], [f32; 2]);

/// Makes a camera.
///
/// # Errors
/// A number that makes no sense there.
fn camera_of(
    (eye, forward, fov_rad, size, velocity, gaze): CameraArguments,
) -> PyResult<FlockCamera> {
    let camera = FlockCamera::look_along(eye, forward, fov_rad, size).map_err(raised)?;
    if !velocity.iter().chain(&gaze).all(|x| x.is_finite()) {
        return Err(raised("the camera's velocity and gaze must be finite"));
    }
    Ok(camera.moving(velocity).with_gaze(gaze))
}
