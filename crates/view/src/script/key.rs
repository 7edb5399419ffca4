//! Keys of a script, and the values between them.

use meshlod::multires::Focus;
use serde::Deserialize;

use super::error::ScriptError;

/// Values of a script at a frame. A missing value is interpolated between the nearest keys with
/// one.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Key {
    pub frame: u32,
    yaw: Option<f64>,
    pitch: Option<f64>,
    distance: Option<f64>,
    /// Point that the camera looks at, in model units; the middle of the model by default.
    target: Option<[f64; 3]>,
    /// Error of a cut in pixels, as part of the diagonal, or its number of faces.
    pixels: Option<f64>,
    error: Option<f64>,
    faces: Option<f64>,
    focus: Option<KeyFocus>,
}

/// Region of a cut that is fine, in model units.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum KeyFocus {
    Everything,
    View,
    Point([f64; 3]),
    Sphere { center: [f64; 3], radius: f64 },
    Box([[f64; 3]; 2]),
}

/// Values of a frame.
#[derive(Clone, Debug)]
pub(super) struct Pose {
    pub yaw: f64,
    pub pitch: f64,
    pub distance: f64,
    pub target: Option<[f64; 3]>,
    pub pixels: Option<f64>,
    pub error: Option<f64>,
    pub faces: Option<f64>,
    focus: KeyFocus,
}

impl Key {
    /// Checks that all values are in range; `at` is the number of the key.
    pub(super) fn check(&self, at: usize) -> Result<(), ScriptError> {
        let check = |name, value: Option<f64>, range, is_valid: fn(f64) -> bool| match value {
            Some(value) if !(value.is_finite() && is_valid(value)) => {
                Err(ScriptError::Range { key: at, name, range, value })
            }
            _ => Ok(()),
        };
        check("distance", self.distance, "above 0", |x| x > 0.0)?;
        check("pitch", self.pitch, "between -90 and 90", |x| (-90.0..=90.0).contains(&x))?;
        check("pixels", self.pixels, "0 or above", |x| x >= 0.0)?;
        check("error", self.error, "0 or above", |x| x >= 0.0)?;
        check("faces", self.faces, "0 or above", |x| x >= 0.0)?;
        check("yaw", self.yaw, "finite", |_| true)
    }
}

impl Pose {
    /// Returns the values at a frame.
    pub(super) fn between(keys: &[Key], frame: f64) -> Self {
        let number = |of: fn(&Key) -> Option<f64>| interpolated(keys, frame, of);
        let axis = |k: usize| {
            let of: [fn(&Key) -> Option<f64>; 3] = [
                |key| Some(key.target?[0]),
                |key| Some(key.target?[1]),
                |key| Some(key.target?[2]),
            ];
            interpolated(keys, frame, of[k])
        };
        let target = match [axis(0), axis(1), axis(2)] {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        };
        let begun = keys.iter().take_while(|key| f64::from(key.frame) <= frame);
        Self {
            yaw: number(|key| key.yaw).unwrap_or(25.0),
            pitch: number(|key| key.pitch).unwrap_or(-20.0),
            distance: number(|key| key.distance).unwrap_or(1.0),
            target,
            pixels: number(|key| key.pixels),
            error: number(|key| key.error),
            faces: number(|key| key.faces),
            focus: begun.filter_map(|key| key.focus).last().unwrap_or(KeyFocus::Everything),
        }
    }

    /// Returns the focus; `view` is that of the camera.
    pub(super) fn focus(&self, view: Focus) -> Focus {
        match self.focus {
            KeyFocus::Everything => Focus::Everything,
            KeyFocus::View => view,
            KeyFocus::Point(point) => Focus::Point(point),
            KeyFocus::Sphere { center, radius } => Focus::Sphere { center, radius },
            KeyFocus::Box(corners) => Focus::Box(corners),
        }
    }
}

/// Interpolates a value between the last key with one and the next; with keys on one side only,
/// returns the nearest value; `None` if no key has one.
fn interpolated(keys: &[Key], frame: f64, of: fn(&Key) -> Option<f64>) -> Option<f64> {
    let all = || keys.iter().filter_map(|key| Some((f64::from(key.frame), of(key)?)));
    let before = all().take_while(|(at, _)| *at <= frame).last();
    let after = all().find(|(at, _)| *at > frame);
    match (before, after) {
        (Some((a, from)), Some((b, to))) => Some(from + (to - from) * (frame - a) / (b - a)),
        (Some((_, value)), None) | (None, Some((_, value))) => Some(value),
        (None, None) => None,
    }
}
