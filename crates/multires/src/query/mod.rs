//! What is asked: where, and how fine.

mod criterion;
mod region;

use glam::DVec3;
use thiserror::Error;

pub(crate) use criterion::{Area, Ball, Criterion, PackedBall, QueryKey, SLACK, Viewpoint};
pub(crate) use region::Region;

/// A question: within the focus no triangle may be further from the surface than the tolerance.
#[derive(Clone, Debug)]
pub struct Query<'f> {
    /// Where the tolerance must hold; elsewhere the mesh is as coarse as it can be.
    pub focus: Focus,
    /// How far off triangles may be.
    pub tolerance: Tolerance<'f>,
}

/// A set in space, in model units.
#[derive(Clone, Debug, Default)]
pub enum Focus {
    /// All of it.
    #[default]
    Everything,
    /// One place.
    Point([f64; 3]),
    /// Between two places.
    Segment([[f64; 3]; 2]),
    /// From the least corner to the greatest.
    Box([[f64; 3]; 2]),
    /// All within a distance.
    Sphere {
        /// Its middle.
        center: [f64; 3],
        /// The distance.
        radius: f64,
    },
    /// What a camera sees, however far.
    Frustum(ViewCamera),
}

/// How far off a triangle may be.
#[derive(Clone)]
pub enum Tolerance<'f> {
    /// The same everywhere, in model units.
    Uniform(f64),
    /// What a camera cannot tell.
    Pixels {
        /// The camera.
        camera: ViewCamera,
        /// How many of its pixels the error may span where it is closest to the camera: pixels as
        /// they are in the middle of the picture, so that it does not matter where the camera looks.
        /// Away from the middle as much as [`ViewCamera::stretch`] times as many.
        pixels: f64,
    },
    /// The least tolerance in a ball, by its center and its radius in model units. Of a ball within
    /// another it must not be less than of that. What is below 0 or no number is as 0: as fine as can
    /// be.
    Field(&'f dyn Fn([f64; 3], f64) -> f64),
}

/// A perspective camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewCamera {
    /// Where it is.
    pub eye: [f64; 3],
    /// What it looks at.
    pub look: [f64; 3],
    /// A direction that is up in the picture.
    pub up: [f64; 3],
    /// From the lower edge of the picture to the upper one.
    pub fov_rad: f64,
    /// Width and height of the picture in pixels.
    pub viewport: [u32; 2],
}

/// Why a question cannot be asked.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum QueryError {
    /// A coordinate of the focus or the camera is not a number.
    #[error("the {0} has a coordinate that is not finite")]
    NotFinite(&'static str),
    /// A length below zero, or none at all.
    #[error("{what} of {value} is none: give at least 0")]
    BadLength {
        /// What it is of.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// A box from a corner to a lesser one.
    #[error("the box is inside out: its first corner must be the least")]
    InsideOut,
    /// A query that balls were not nested for.
    #[error("the balls nest for cameras that look at everything, within a range of tolerances")]
    NotSaturated,
    /// A camera without a picture.
    #[error("the camera sees nothing: {0}")]
    Blind(&'static str),
}

impl Query<'static> {
    /// The whole surface to a tolerance in model units.
    pub fn uniform(tolerance: f64) -> Self {
        Self { focus: Focus::Everything, tolerance: Tolerance::Uniform(tolerance) }
    }

    /// The whole surface as a camera needs it.
    pub fn pixels(camera: ViewCamera, pixels: f64) -> Self {
        Self { focus: Focus::Everything, tolerance: Tolerance::Pixels { camera, pixels } }
    }
}

impl Query<'_> {
    /// Whether it can be asked.
    pub(crate) fn validate(&self) -> Result<(), QueryError> {
        self.focus.validate()?;
        match &self.tolerance {
            Tolerance::Uniform(most) => length("a tolerance", *most),
            Tolerance::Pixels { camera, pixels } => {
                camera.validate()?;
                length("a tolerance", *pixels)
            }
            Tolerance::Field(_) => Ok(()),
        }
    }
}

impl Focus {
    /// Whether it is one.
    pub(crate) fn validate(&self) -> Result<(), QueryError> {
        match self {
            Self::Everything => Ok(()),
            Self::Point(point) => finite("point", &[*point]),
            Self::Segment(ends) => finite("segment", ends),
            Self::Box(corners) => {
                finite("box", corners)?;
                let is_turned = (0..3).any(|k| corners[0][k] > corners[1][k]);
                if is_turned { Err(QueryError::InsideOut) } else { Ok(()) }
            }
            Self::Sphere { center, radius } => {
                finite("sphere", &[*center])?;
                length("a radius", *radius)
            }
            Self::Frustum(camera) => camera.validate(),
        }
    }
}

impl ViewCamera {
    /// How much of the distance a pixel spans in the middle of the picture.
    pub fn pixel(&self) -> f64 {
        2.0 * (0.5 * self.fov_rad).tan() / f64::from(self.viewport[1])
    }

    /// How many times as many pixels the same error may span in a corner of the picture: for pixels
    /// that hold everywhere, divide by this. 1.7 for a wide picture 45° high.
    ///
    /// A picture is flat: at an angle from its middle it is further away, and the line of sight meets
    /// it at that angle. Both stretch what is seen by the inverse of its cosine.
    pub fn stretch(&self) -> f64 {
        let [width, height] = self.viewport.map(f64::from);
        let high = (0.5 * self.fov_rad).tan();
        1.0 + high * high * (1.0 + (width / height) * (width / height))
    }

    /// Forward, right and up, at right angles and of length one.
    pub(crate) fn axes(&self) -> [DVec3; 3] {
        let forward = (DVec3::from(self.look) - DVec3::from(self.eye)).normalize_or_zero();
        let right = forward.cross(self.up.into()).normalize_or_zero();
        [forward, right, right.cross(forward)]
    }

    fn validate(&self) -> Result<(), QueryError> {
        finite("camera", &[self.eye, self.look, self.up])?;
        if !(self.fov_rad > 0.0 && self.fov_rad < std::f64::consts::PI) {
            return Err(QueryError::Blind("its field of view is not between 0 and 180 degrees"));
        }
        if self.viewport.contains(&0) {
            return Err(QueryError::Blind("its picture has no pixels"));
        }
        if self.axes().contains(&DVec3::ZERO) {
            return Err(QueryError::Blind("it looks at itself, or along its up"));
        }
        Ok(())
    }
}

impl std::fmt::Debug for Tolerance<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Uniform(most) => f.debug_tuple("Uniform").field(most).finish(),
            Self::Pixels { camera, pixels } => {
                f.debug_struct("Pixels").field("camera", camera).field("pixels", pixels).finish()
            }
            Self::Field(_) => f.write_str("Field"),
        }
    }
}

fn finite(what: &'static str, points: &[[f64; 3]]) -> Result<(), QueryError> {
    let ok = points.iter().flatten().all(|x| x.is_finite());
    if ok { Ok(()) } else { Err(QueryError::NotFinite(what)) }
}

fn length(what: &'static str, value: f64) -> Result<(), QueryError> {
    if value >= 0.0 { Ok(()) } else { Err(QueryError::BadLength { what, value }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of one pixel's length are turned into every direction at places all over the picture.
    #[test]
    fn errors_are_stretched_away_from_the_middle_and_no_more() {
        let camera = ViewCamera {
            eye: [1.0, 2.0, 3.0],
            look: [4.0, 3.0, 1.0],
            up: [0.0, 0.0, 1.0],
            fov_rad: 0.8,
            viewport: [1920, 1080],
        };
        let [forward, right, up] = camera.axes();
        let eye = DVec3::from(camera.eye);
        let pixels = |place: DVec3| {
            let from = place - eye;
            let at = glam::DVec2::new(from.dot(right), from.dot(up)) / from.dot(forward);
            at / camera.pixel()
        };
        let spanned = |x: f64, y: f64| {
            let place = eye + 100.0 * (forward + camera.pixel() * (x * right + y * up));
            let error = 1e-3 * camera.pixel() * place.distance(eye);
            let turned = (0..2000).map(|i| {
                let (a, z) = (2.4 * f64::from(i), 1.0 - f64::from(i) / 1000.0);
                let around = (1.0 - z * z).max(0.0).sqrt();
                let to = DVec3::new(around * a.cos(), around * a.sin(), z);
                pixels(place + error * to).distance(pixels(place)) / 1e-3
            });
            turned.fold(0.0, f64::max)
        };
        assert!((spanned(0.0, 0.0) - 1.0).abs() < 0.01);
        assert!((spanned(960.0, 540.0) / camera.stretch() - 1.0).abs() < 0.01);
        assert!(spanned(960.0, 0.0) < camera.stretch() && camera.stretch() > 1.7);
    }
}
