//! Scripts: films of a stage, drawn without a window.
//!
//! A script is JSON. Angles are in degrees, distances in those at which the model fills the picture;
//! between its keys everything changes evenly:
//!
//! ```json
//! {
//!   "size": [960, 540],
//!   "frames": 60,
//!   "keys": [
//!     { "frame": 0, "yaw": 25, "pitch": -15, "pixels": 1 },
//!     { "frame": 59, "yaw": 385 }
//!   ]
//! }
//! ```
//!
//! docs/scripts has more, and docs/notes/view.md describes every field.

mod film;
mod key;

use meshlod::picture::UpAxis;
use serde::Deserialize;
use thiserror::Error;

pub use self::film::{ScriptFilm, ScriptFrame};
use self::key::{Key, Pose};
use crate::stage::Display;

/// Film of what is on a stage.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Script {
    /// Width and height of the pictures, in pixels.
    #[serde(default = "default_size")]
    pub size: [u32; 2],
    /// Number of pictures.
    pub frames: u32,
    /// Axis that points up.
    #[serde(default)]
    up: Up,
    /// Field of view along the shorter side, in degrees.
    #[serde(default = "default_fov")]
    fov: f64,
    /// How the stage is shown.
    #[serde(default)]
    display: Option<Display>,
    keys: Vec<Key>,
}

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

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Up {
    #[default]
    Y,
    Z,
}

/// Longest film: a quarter of an hour.
const MAX_FRAMES: u32 = 27_000;

fn default_size() -> [u32; 2] {
    [960, 540]
}

fn default_fov() -> f64 {
    45.0
}

impl Script {
    /// Reads a script from JSON.
    ///
    /// # Errors
    /// Text that is no script, and numbers out of range.
    pub fn parse(json: &str) -> Result<Self, ScriptError> {
        let script: Self = serde_json::from_str(json)?;
        if !(1..=MAX_FRAMES).contains(&script.frames) {
            return Err(ScriptError::Frames(script.frames));
        }
        if !(5.0..=120.0).contains(&script.fov) {
            return Err(ScriptError::Fov(script.fov));
        }
        if script.keys.first().is_none_or(|key| key.frame != 0) {
            return Err(ScriptError::NoStart);
        }
        if !script.size.iter().all(|side| (1..=16_384).contains(side)) {
            return Err(ScriptError::Size(script.size));
        }
        let frames = script.frames;
        for (at, pair) in script.keys.windows(2).enumerate() {
            if pair[1].frame <= pair[0].frame || pair[1].frame >= frames {
                return Err(ScriptError::Order { key: at + 1, frames });
            }
        }
        script.keys.iter().enumerate().try_for_each(|(at, key)| key.check(at))?;
        Ok(script)
    }

    /// Returns the axis that points up.
    pub fn up(&self) -> UpAxis {
        match self.up {
            Up::Y => UpAxis::Y,
            Up::Z => UpAxis::Z,
        }
    }

    /// Returns how the stage is shown.
    pub fn display(&self) -> Display {
        self.display.unwrap_or(Display { is_dark: false, ..Display::default() })
    }

    /// Returns the pose of a frame: between the keys around it, each value by its own last and next
    /// key that has it.
    fn pose(&self, frame: u32) -> Pose {
        Pose::between(&self.keys, f64::from(frame))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_change_evenly_between_their_keys() {
        let script = Script::parse(
            r#"{ "frames": 11, "keys": [
                { "frame": 0, "yaw": 0, "pixels": 4 },
                { "frame": 5, "distance": 2 },
                { "frame": 10, "yaw": 90, "distance": 4 }
            ] }"#,
        )
        .unwrap();
        let at = |frame| {
            let pose = script.pose(frame);
            (pose.yaw, pose.distance, pose.pixels)
        };
        assert_eq!(at(0), (0.0, 2.0, Some(4.0)));
        assert_eq!(at(5), (45.0, 2.0, Some(4.0)));
        assert_eq!(at(7), (63.0, 2.8, Some(4.0)));
        assert_eq!(at(10), (90.0, 4.0, Some(4.0)));
    }

    #[test]
    fn mistakes_are_named() {
        let error = |json: &str| Script::parse(json).unwrap_err().to_string();
        assert!(error(r#"{ "frames": 2, "keys": [], "sized": 1 }"#).contains("sized"));
        assert!(error(r#"{ "frames": 0, "keys": [] }"#).starts_with("frames must be"));
        assert!(error(r#"{ "frames": 2, "keys": [] }"#).contains("at frame 0"));
        let keys = r#""keys": [{ "frame": 0 }]"#;
        assert!(error(&format!(r#"{{ "frames": 1, "size": [0, 9], {keys} }}"#)).contains("0 x 9"));
        let display = r#""display": { "wirefame": true }"#;
        assert!(error(&format!(r#"{{ "frames": 1, {display}, {keys} }}"#)).contains("wirefame"));
        let keys = r#""keys": [{ "frame": 0 }, { "frame": 5 }]"#;
        assert!(error(&format!(r#"{{ "frames": 2, {keys} }}"#)).contains("key 1"));
        let keys = r#""keys": [{ "frame": 0 }, { "frame": 0 }]"#;
        assert!(error(&format!(r#"{{ "frames": 2, {keys} }}"#)).contains("key 1"));
        let keys = r#""keys": [{ "frame": 0, "pixels": -1 }]"#;
        let message = error(&format!(r#"{{ "frames": 2, {keys} }}"#));
        assert_eq!(message, "key 0: pixels must be 0 or above, not -1");
        let keys = r#""keys": [{ "frame": 0, "distance": 0 }]"#;
        assert!(error(&format!(r#"{{ "frames": 2, {keys} }}"#)).contains("above 0"));
    }
}
