//! Cameras of all frames, as `cameras.json`.

use glam::Vec3;
use meshlod::flock::FlockCamera;
use serde::{Deserialize, Serialize};

use crate::recording::limits::FARTHEST;
use crate::recording::{RecordingError, Source, VERSION, json};

/// Name of the file.
const FILE: &str = "cameras.json";

#[derive(Serialize, Deserialize)]
struct CamerasFile {
    version: u32,
    cameras: Vec<CameraEntry>,
}

#[derive(Serialize, Deserialize)]
struct CameraEntry {
    eye: [f32; 3],
    /// Unit vector into the picture.
    forward: [f32; 3],
    /// Unit vector up in the picture.
    up: [f32; 3],
    /// Field of view along the shorter side.
    fov_rad: f32,
    /// Width and height in pixels.
    size: [u32; 2],
    /// In body lengths a second.
    #[serde(default)]
    velocity: [f32; 3],
}

/// Greatest deviation of a vector from the expected one.
const SLACK: f32 = 1e-3;

/// Returns the bytes of the file.
pub fn write(cameras: &[FlockCamera]) -> Vec<u8> {
    let entry = |camera: &FlockCamera| {
        let [_, up, forward] = camera.axes();
        CameraEntry {
            eye: camera.eye().into(),
            forward: forward.into(),
            up: up.into(),
            fov_rad: camera.fov_rad(),
            size: camera.size(),
            velocity: camera.velocity().into(),
        }
    };
    let file = CamerasFile { version: VERSION, cameras: cameras.iter().map(entry).collect() };
    json::compact(&file)
}

/// Reads the cameras of all frames.
pub fn read(source: &mut Source<'_>, frames: usize) -> Result<Vec<FlockCamera>, RecordingError> {
    let file: CamerasFile = source.json(FILE)?;
    if file.cameras.len() != frames {
        return Err(RecordingError::Shape {
            file: FILE.into(),
            found: vec![file.cameras.len()],
            expected: format!("[{frames}]"),
        });
    }
    let camera = |(i, entry): (usize, &CameraEntry)| {
        entry.camera().map_err(|reason| RecordingError::value(FILE, format!("camera {i}"), reason))
    };
    file.cameras.iter().enumerate().map(camera).collect()
}

impl CameraEntry {
    fn camera(&self) -> Result<FlockCamera, String> {
        let [eye, forward, up, velocity] =
            [self.eye, self.forward, self.up, self.velocity].map(Vec3::from);
        if !(forward.length() - 1.0).abs().le(&SLACK) {
            return Err("`forward` must be a unit vector".into());
        }
        if eye.abs().max_element() > FARTHEST || !velocity.is_finite() {
            return Err("`eye` and `velocity` must be finite, and within 1e7 body lengths".into());
        }
        let camera = FlockCamera::look_along(self.eye, self.forward, self.fov_rad, self.size)
            .map_err(|error| error.to_string())?
            .moving(self.velocity);
        // A camera that looks straight up or down may have any other direction up.
        if !(camera.axes()[1] - up).length().le(&SLACK) {
            return Err(
                "`up` must be the unit vector nearest to +y at a right angle to `forward`".into()
            );
        }
        Ok(camera)
    }
}
