//! Options of the window of a school, and its report at the end.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use meshlod::flock::levels::{Impostor, LevelTable, Look};
use meshlod::flock::select::PolicyName;
use meshlod_school::scene::{Scenario, ScenarioName};

/// Sets up a scenario by its name, on another thread; the error is a line for people.
pub type SchoolScenes = Arc<dyn Fn(ScenarioName) -> Result<Scenario, String> + Send + Sync>;

/// Options of the window of a school.
#[derive(Clone)]
pub struct SchoolWindowOptions {
    /// Levels of the model of the members.
    pub table: Arc<LevelTable>,
    /// Materials of the model.
    pub look: Look,
    /// Views of the model for members that are small on the screen.
    pub impostor: Option<Arc<Impostor>>,
    /// Scene of the start. Time passes in whole frames of it, so a frame should take at most a
    /// hundredth of a second.
    pub scenario: Scenario,
    /// Scenes that the window switches to.
    pub scenes: SchoolScenes,
    /// Policy of the start.
    pub policy: PolicyName,
    /// Most triangles a frame at the start, for policies with a budget.
    pub triangles: usize,
    /// Time after the first picture at which the window closes by itself, in seconds.
    pub seconds: Option<f64>,
    /// File to which a picture is written after thirty frames; the window closes then, unless
    /// [`SchoolWindowOptions::seconds`] says when.
    pub screenshot: Option<PathBuf>,
    /// File in which the window is remembered; by default the usual place of the system.
    pub memory: Option<PathBuf>,
}

/// Figures of the time in which the window of a school was open. Means are over all frames.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct SchoolReport {
    /// Name of the GPU.
    pub gpu: String,
    /// Name of the scene at the end.
    pub camera: String,
    /// Name of the policy at the end.
    pub policy: String,
    /// Number of members of the scene at the end.
    pub members: usize,
    /// Number of schools of the scene at the end.
    pub schools: usize,
    /// Width and height of the picture at the end, in pixels.
    pub size: [u32; 2],
    /// Number of frames.
    pub frames: usize,
    /// Median time between frames in milliseconds.
    pub median_frame_ms: Option<f64>,
    /// Longest time between frames in milliseconds.
    pub longest_frame_ms: Option<f64>,
    /// Mean number of faces that are drawn with levels.
    pub mean_faces: f64,
    /// Mean number of faces of the same members in full detail.
    pub mean_full_faces: f64,
    /// Mean number of members in view.
    pub mean_members_in_view: f64,
    /// Mean time of the choice of levels in milliseconds.
    pub mean_select_ms: f64,
    /// Mean time of the simulation in milliseconds.
    pub mean_simulate_ms: f64,
    /// Lines about what went wrong.
    pub problems: Vec<String>,
}

impl fmt::Debug for SchoolWindowOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SchoolWindowOptions")
            .field("scenario", &self.scenario.name)
            .field("policy", &self.policy)
            .field("triangles", &self.triangles)
            .field("seconds", &self.seconds)
            .field("screenshot", &self.screenshot)
            .finish_non_exhaustive()
    }
}
