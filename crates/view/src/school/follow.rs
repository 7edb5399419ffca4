//! Cameras of a school: the one of the film, and one that moves along with the leader.

use glam::Vec3;
use meshlod::flock::{Flock, FlockCamera};
use meshlod_school::scene::SceneError;

use crate::ViewError;
use crate::stage::CameraRig;

/// Returns the camera of a rig whose target is relative to the leader of the first school.
pub(super) fn camera(
    rig: &CameraRig,
    flock: &Flock,
    size: [u32; 2],
) -> Result<FlockCamera, ViewError> {
    let leader = flock.schools.first().map_or(Vec3::ZERO, |school| school.leader);
    let camera = rig.camera();
    let [eye, forward] = [camera.eye(), camera.forward()].map(|v| v.map(|x| x as f32));
    let eye = leader + Vec3::from(eye);
    Ok(FlockCamera::look_along(eye.into(), forward, rig.fov_rad() as f32, size)
        .map_err(SceneError::from)?)
}

/// Returns a camera for a picture of another size.
pub(super) fn fitted(camera: &FlockCamera, size: [u32; 2]) -> Result<FlockCamera, ViewError> {
    if camera.size() == size {
        return Ok(*camera);
    }
    let (eye, forward) = (camera.eye().into(), camera.axes()[2].into());
    let fitted = FlockCamera::look_along(eye, forward, camera.fov_rad(), size);
    Ok(fitted.map_err(SceneError::from)?.moving(camera.velocity().into()))
}
