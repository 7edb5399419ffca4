//! Errors of scripts.

use thiserror::Error;

/// Longest film: a quarter of an hour.
pub(super) const MAX_FRAMES: u32 = 27_000;

/// Reason why a script cannot be run.
#[derive(Debug, Error)]
pub enum ScriptError {
    /// The text is not JSON of a script.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// The script has no frames, or more than a film can have.
    #[error("frames must be between 1 and {MAX_FRAMES}, not {0}")]
    Frames(u32),
    /// The first key is not at the first frame.
    #[error("the first key must be at frame 0")]
    NoStart,
    /// A key is not after the one before, or beyond the last frame.
    #[error("the frames of keys must ascend and be below {frames}; that of key {key} does not")]
    Order {
        /// Number of the key, from 0.
        key: usize,
        /// Number of frames.
        frames: u32,
    },
    /// The size of the pictures is out of range.
    #[error("sides of size must be between 1 and 16384 pixels, not {} x {}", .0[0], .0[1])]
    Size([u32; 2]),
    /// A number of a key is out of range.
    #[error("key {key}: {name} must be {range}, not {value}")]
    Range {
        /// Number of the key, from 0.
        key: usize,
        /// Name of the field.
        name: &'static str,
        /// Range of the field, in words.
        range: &'static str,
        /// Value in the script.
        value: f64,
    },
    /// The field of view is out of range.
    #[error("fov must be between 5 and 120 degrees, not {0}")]
    Fov(f64),
}
