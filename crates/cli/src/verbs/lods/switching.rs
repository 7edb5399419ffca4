//! When an engine should show each level: distances and sizes on the screen, for a camera.

use clap::Args;
use meshlod::measure::Distance;
use meshlod::mesh::Bounds;
use serde_json::{Value, json};

use crate::options::parse;

/// Camera for which the distances of the levels are computed.
#[derive(Clone, Copy, Args)]
#[command(next_help_heading = "Distances of the levels")]
pub struct Camera {
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

impl Default for Camera {
    fn default() -> Self {
        Self { fov: 60.0, lines: 1080, pixels: 1.0 }
    }
}

/// Place from which on a level is within the error on the screen, in the measures of engines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch {
    /// Distance of the camera from the middle of the model, in model units.
    pub distance: f64,
    /// Greatest extent of the bounding box as a fraction of the screen's height, at that distance.
    pub screen_height: f64,
    /// Diameter of the bounding sphere as a fraction of the screen's height, at that distance.
    pub screen_diameter: f64,
}

impl Camera {
    /// Returns where a level begins whose greatest distance from the original is `error`, in model
    /// units; 0 for the original itself.
    ///
    /// The nearest point of the bounding sphere must be so far away that `error` spans at most the
    /// allowed pixels.
    pub fn switch(&self, error: f64, bounds: &Bounds) -> Switch {
        let slope = (0.5 * self.fov.to_radians()).tan();
        let radius = 0.5 * bounds.diagonal();
        let away = error * self.lines as f64 / (2.0 * self.pixels * slope);
        if error == 0.0 {
            return Switch { distance: 0.0, screen_height: 1.0, screen_diameter: 1.0 };
        }
        let distance = away + radius;
        let fraction = |length: f64| (length / (2.0 * distance * slope)).min(1.0);
        Switch {
            distance,
            screen_height: fraction(greatest_extent(bounds)),
            screen_diameter: fraction(2.0 * radius),
        }
    }

    /// Returns the fraction of the screen's area that a model covers when its greatest distance from
    /// the original spans the allowed pixels.
    pub fn screen_coverage(&self, distance: &Distance) -> f64 {
        let coverage =
            (distance.diagonal / distance.max() * self.pixels / self.lines as f64).powi(2);
        if coverage.is_finite() { coverage.min(1.0) } else { 1.0 }
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
        json!({
            "field_of_view_degrees": self.fov,
            "screen_lines": self.lines,
            "pixels": self.pixels,
            "center": middle,
            "radius": 0.5 * bounds.diagonal(),
            "size": greatest_extent(bounds),
        })
    }
}

fn greatest_extent(bounds: &Bounds) -> f64 {
    (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max)
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
    fn an_error_spans_the_pixels_at_its_distance() {
        // 90 degrees: at distance d the screen is 2 d high.
        let camera = Camera { fov: 90.0, lines: 1000, pixels: 2.0 };
        let bounds = Bounds { min: [-1.0, -0.5, -0.5], max: [1.0, 0.5, 0.5] };
        let radius = 0.5 * 6f64.sqrt();
        let switch = camera.switch(0.01, &bounds);
        assert!((switch.distance - (2.5 + radius)).abs() < 1e-12, "{switch:?}");
        assert!((switch.screen_height - 1.0 / switch.distance).abs() < 1e-12);
        assert!((switch.screen_diameter - radius / switch.distance).abs() < 1e-12);
        assert_eq!(camera.switch(0.0, &bounds).distance, 0.0);
    }

    #[test]
    fn what_no_camera_has_is_refused() {
        for text in ["0", "180", "-4", "nan", "x"] {
            assert!(field_of_view(text).is_err(), "{text}");
        }
        assert!(pixels("0").is_err() && pixels("inf").is_err() && pixels("0.5").is_ok());
    }
}
