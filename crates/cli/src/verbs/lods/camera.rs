//! The camera for which `lods` says when to show each level.

use clap::Args;
use meshlod::jobs::SwitchCamera;
use meshlod::mesh::Bounds;
use serde_json::{Value, json};

use crate::options::parse;

/// Camera for which the distances of the levels are computed.
#[derive(Clone, Copy, Args)]
#[command(next_help_heading = "Distances of the levels")]
pub(super) struct CameraArgs {
    /// Vertical field of view for the distances beside the levels, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "60", value_parser = field_of_view,
        allow_negative_numbers = true)]
    fov: f64,
    /// Height of the screen, in lines
    #[arg(long, value_name = "N", default_value = "1080", value_parser = parse::positive,
        allow_negative_numbers = true)]
    lines: usize,
    /// Largest error on the screen, in pixels
    #[arg(long, value_name = "N", default_value = "1", value_parser = pixels,
        allow_negative_numbers = true)]
    pixels: f64,
}

impl CameraArgs {
    pub fn camera(&self) -> SwitchCamera {
        SwitchCamera { fov_degrees: self.fov, lines: self.lines, pixels: self.pixels }
    }

    /// Describes the allowed error for people: `within 1 pixel of 1080 lines`.
    pub fn text(&self) -> String {
        let plural = if self.pixels == 1.0 { "" } else { "s" };
        format!(
            "within {} pixel{plural} of the input, on a screen of {} lines",
            self.pixels, self.lines
        )
    }

    pub fn json(&self, bounds: &Bounds) -> Value {
        let middle: Vec<f64> = (0..3).map(|k| 0.5 * (bounds.min[k] + bounds.max[k])).collect();
        let extents = (0..3).map(|k| bounds.max[k] - bounds.min[k]);
        json!({
            "field_of_view_degrees": self.fov,
            "screen_lines": self.lines,
            "pixels": self.pixels,
            "center": middle,
            "radius": 0.5 * bounds.diagonal(),
            "size": extents.fold(0.0, f64::max),
        })
    }
}

fn field_of_view(text: &str) -> Result<f64, String> {
    match parse::number(text)? {
        degrees if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("it must be between 0 and 180 degrees".into()),
    }
}

fn pixels(text: &str) -> Result<f64, String> {
    match parse::number(text)? {
        pixels if pixels > 0.0 && pixels.is_finite() => Ok(pixels),
        _ => Err("it must be above 0".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_camera_has_is_refused() {
        for text in ["0", "180", "-4", "nan", "x"] {
            assert!(field_of_view(text).is_err(), "{text}");
        }
        assert!(pixels("0").is_err() && pixels("inf").is_err() && pixels("0.5").is_ok());
    }
}
