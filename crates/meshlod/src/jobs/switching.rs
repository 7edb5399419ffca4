//! When an engine should show each level: distances and sizes on the screen, for a camera.

use meshlod_measure::Distance;
use meshlod_mesh::Bounds;

/// Camera for which the distances of levels are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct SwitchCamera {
    /// Vertical field of view in degrees.
    pub fov_degrees: f64,
    /// Height of the screen in lines.
    pub lines: usize,
    /// Largest error on the screen in pixels.
    pub pixels: f64,
}

impl Default for SwitchCamera {
    fn default() -> Self {
        Self { fov_degrees: 60.0, lines: 1080, pixels: 1.0 }
    }
}

/// Place from which on a level is within the error on the screen, in the measures of engines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Switch {
    /// Distance of the camera from the middle of the model, in model units.
    pub distance: f64,
    /// Greatest extent of the bounding box as a fraction of the screen's height, at that distance.
    pub screen_height: f64,
    /// Diameter of the bounding sphere as a fraction of the screen's height, at that distance.
    pub screen_diameter: f64,
}

impl SwitchCamera {
    /// Returns where a level begins whose greatest distance from the original is `error`, in model
    /// units; 0 for the original itself.
    ///
    /// The nearest point of the bounding sphere must be so far away that `error` spans at most the
    /// allowed pixels.
    pub fn switch(&self, error: f64, bounds: &Bounds) -> Switch {
        let slope = (0.5 * self.fov_degrees.to_radians()).tan();
        let radius = 0.5 * bounds.diagonal();
        let away = error * self.lines as f64 / (2.0 * self.pixels * slope);
        if error == 0.0 {
            return Switch { distance: 0.0, screen_height: 1.0, screen_diameter: 1.0 };
        }
        let distance = away + radius;
        let fraction = |length: f64| (length / (2.0 * distance * slope)).min(1.0);
        let extents = (0..3).map(|k| bounds.max[k] - bounds.min[k]);
        Switch {
            distance,
            screen_height: fraction(extents.fold(0.0, f64::max)),
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_spans_the_pixels_at_its_distance() {
        // 90 degrees: at distance d the screen is 2 d high.
        let camera = SwitchCamera { fov_degrees: 90.0, lines: 1000, pixels: 2.0 };
        let bounds = Bounds { min: [-1.0, -0.5, -0.5], max: [1.0, 0.5, 0.5] };
        let radius = 0.5 * 6f64.sqrt();
        let switch = camera.switch(0.01, &bounds);
        assert!((switch.distance - (2.5 + radius)).abs() < 1e-12, "{switch:?}");
        assert!((switch.screen_height - 1.0 / switch.distance).abs() < 1e-12);
        assert!((switch.screen_diameter - radius / switch.distance).abs() < 1e-12);
        assert_eq!(camera.switch(0.0, &bounds).distance, 0.0);
    }
}
