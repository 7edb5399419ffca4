//! Recorded frames of a flock and its camera.

use meshlod::flock::Flock;
use meshlod::flock::FlockCamera;
use meshlod::mesh::Mesh;

/// Recorded flock and the camera that sees it, frame by frame.
#[derive(Clone, Debug)]
pub struct Footage {
    /// Name of the scene.
    pub name: String,
    /// Flock in every frame.
    pub flocks: Vec<Flock>,
    /// Camera in every frame.
    pub cameras: Vec<FlockCamera>,
    /// Obstacles, in the coordinates of the flock.
    pub obstacles: Vec<Mesh>,
    /// Time from frame to frame, in seconds.
    pub frame_s: f32,
}

impl Footage {
    /// Returns the number of frames.
    pub fn len(&self) -> usize {
        self.flocks.len().min(self.cameras.len())
    }

    /// Returns true if there are no frames.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
