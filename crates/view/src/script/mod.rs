//! Scripts: films of a stage, drawn without a window.
//!
//! A script is JSON. Angles are in degrees, distances in those at which the model fills the
//! picture; between its keys everything changes evenly:
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

mod error;
mod film;
mod key;

use meshlod::picture::UpAxis;
use serde::Deserialize;

use self::error::MAX_FRAMES;
pub use self::error::ScriptError;
pub use self::film::{ScriptFilm, ScriptFrame};
use self::key::{Key, Pose};
use crate::stage::Display;

/// Film of a stage.
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

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Up {
    #[default]
    Y,
    Z,
}

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

    /// Returns the pose of a frame, each value interpolated between the nearest keys with one.
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
