//! Options of the viewer, and its report at the end.

use std::path::PathBuf;
use std::time::Instant;

use meshlod::ReadOptions;

/// Options of the viewer.
#[derive(Clone, Debug)]
pub struct ViewerOptions {
    /// Files to open.
    pub files: Vec<PathBuf>,
    /// Options of reading meshes.
    pub reading: ReadOptions,
    /// Time after the first picture at which the window closes by itself, in seconds.
    pub seconds: Option<f64>,
    /// File to which a picture is written once everything is loaded; the window closes then, unless
    /// [`ViewerOptions::seconds`] says when.
    pub screenshot: Option<PathBuf>,
    /// File in which the window and the settings are remembered; by default the usual place of the
    /// system.
    pub memory: Option<PathBuf>,
    /// Start of the process, from which the time to the first picture counts.
    pub started: Instant,
}

/// Figures and problems of the time while the viewer was open.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct ViewerReport {
    /// Name of the GPU.
    pub gpu: String,
    /// Number of faces drawn at the end.
    pub faces: usize,
    /// Number of vertices of the subjects drawn at the end.
    pub vertices: usize,
    /// Size of vertices and faces on the GPU, in bytes.
    pub gpu_bytes: u64,
    /// Number of frames.
    pub frames: usize,
    /// Median time between frames that followed each other at once, in milliseconds.
    pub median_frame_ms: Option<f64>,
    /// Longest time between frames that followed each other at once, in milliseconds.
    pub longest_frame_ms: Option<f64>,
    /// Median time between such frames while a file was read or uploaded, in milliseconds.
    pub median_loading_frame_ms: Option<f64>,
    /// Longest time between such frames while a file was read or uploaded, in milliseconds.
    pub longest_loading_frame_ms: Option<f64>,
    /// Time that reading the last file took, in milliseconds.
    pub load_ms: Option<f64>,
    /// Time from the start of the process to the first frame of the window, in milliseconds.
    pub first_frame_ms: Option<f64>,
    /// Time from the start of the process to the first picture of a file, in milliseconds.
    pub first_picture_ms: Option<f64>,
    /// Error messages, such as those about files that could not be shown.
    pub problems: Vec<String>,
    /// True if the GPU was lost while the window was open.
    pub gpu_was_lost: bool,
}

impl Default for ViewerOptions {
    fn default() -> Self {
        Self {
            files: Vec::new(),
            reading: ReadOptions::default(),
            seconds: None,
            screenshot: None,
            memory: None,
            started: Instant::now(),
        }
    }
}
