//! Queries: where a mesh must be fine, and how fine.

mod closest;
mod criterion;
mod ground;
mod limits;
mod region;

use glam::DVec3;
use meshlod_mesh::{Bounds, Frame};
use thiserror::Error;

pub(crate) use closest::closest_point;
pub(crate) use criterion::{Area, Ball, Criterion, PackedBall, QueryKey, SLACK, Viewpoint};
pub use ground::{Ground, GroundShape};
pub use limits::Limits;
pub(crate) use region::Region;

/// A request for a mesh that, within a region, deviates from the surface by no more than a
/// tolerance.
#[derive(Clone, Debug)]
pub struct Query<'f> {
    /// Region where the tolerance must hold; elsewhere the mesh is as coarse as possible.
    pub focus: Focus,
    /// Largest deviation from the surface that is allowed within the focus.
    pub tolerance: Tolerance<'f>,
}

/// Region of interest of a query, in model units.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Focus {
    /// The whole model.
    #[default]
    Everything,
    /// A single point.
    Point([f64; 3]),
    /// The segment between two points.
    Segment([[f64; 3]; 2]),
    /// An axis-aligned box, given by its corners of least and of greatest coordinates.
    Box([[f64; 3]; 2]),
    /// A ball.
    Sphere {
        /// Center of the ball.
        center: [f64; 3],
        /// Radius of the ball.
        radius: f64,
    },
    /// The view frustum of a camera, without a far plane.
    Frustum(ViewCamera),
    /// A line or a box on the ground, unbounded along the vertical axis.
    Ground(Ground),
}

/// Largest deviation from the surface that a query allows for a triangle.
///
/// A tolerance of 0 asks for the finest mesh that there is: it applies every update in the focus, also
/// those that do not move the surface but refine its faces and attributes.
#[derive(Clone)]
pub enum Tolerance<'f> {
    /// One tolerance everywhere, in model units.
    Uniform(f64),
    /// A tolerance in pixels, as seen by a camera.
    Pixels {
        /// The camera from which the mesh is seen.
        camera: ViewCamera,
        /// Number of pixels that the error may span at the triangle's closest point to the camera.
        ///
        /// Pixels are measured in the middle of the picture, so the viewing direction does not
        /// matter; towards the corners an error can span up to [`ViewCamera::stretch`] times as
        /// many.
        pixels: f64,
    },
    /// A tolerance that varies in space: a function that returns the least tolerance within a ball,
    /// given the ball's center and radius in model units.
    ///
    /// It must not decrease from a ball to a ball inside it. Negative values and NaN count as 0,
    /// the finest level.
    Field(&'f dyn Fn([f64; 3], f64) -> f64),
    /// The least tolerance of several queries, each in its own focus, as where a mesh is shown in
    /// several places. Everything outside them is as coarse as possible.
    Each(Vec<Query<'f>>),
}

/// A perspective camera.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ViewCamera {
    /// Position of the camera, in model units.
    pub eye: [f64; 3],
    /// Point that the camera looks at, in model units.
    pub look: [f64; 3],
    /// Direction that points up in the picture.
    pub up: [f64; 3],
    /// Vertical field of view, in radians.
    pub fov_rad: f64,
    /// Width and height of the picture, in pixels.
    pub viewport: [u32; 2],
}

/// Reasons why a query is invalid.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum QueryError {
    /// A coordinate of the focus or the camera is not finite.
    #[error("a coordinate of the {0} is not finite")]
    NotFinite(&'static str),
    /// A length or tolerance is negative or NaN.
    #[error("{what} must be at least 0, not {value}")]
    BadLength {
        /// Name of the invalid length.
        what: &'static str,
        /// The invalid value.
        value: f64,
    },
    /// The range of tolerances to prepare nested balls for is empty, or not positive and finite.
    #[error("a range of tolerances must rise from above 0 to a finite end, not from {0} to {1}")]
    BadRange(f64, f64),
    /// The number of the vertical axis is not 0, 1 or 2.
    #[error("the vertical axis must be 0, 1 or 2, not {0}")]
    NoAxis(usize),
    /// The hysteresis is negative or not finite.
    #[error("the hysteresis must be finite and at least 0, not {0}")]
    BadHysteresis(f64),
    /// The corners of the box are not those of least and of greatest coordinates, in this order.
    #[error("the box is inside out: give its least corner first")]
    InsideOut,
    /// The model has no nested balls that were prepared for this query.
    #[error(
        "only camera queries over the whole model, within a prepared range of tolerances, can be \
         saturated: use `exact`, or call `Model::saturate` first"
    )]
    NotSaturated,
    /// The tolerance is a field, which says nothing of single triangles.
    #[error("a tolerance that is a field cannot be checked: give a length or pixels")]
    FieldUnchecked,
    /// The camera has no valid field of view, picture size or viewing direction.
    #[error("the camera sees nothing: {0}")]
    Blind(&'static str),
}

impl<'f> Tolerance<'f> {
    /// Returns true if the tolerance is 0 everywhere, which asks for the finest mesh.
    pub fn is_finest(&self) -> bool {
        match self {
            Self::Uniform(most) => *most == 0.0,
            Self::Pixels { pixels, .. } => *pixels == 0.0,
            Self::Field(_) => false,
            Self::Each(queries) => {
                !queries.is_empty() && queries.iter().all(|query| query.tolerance.is_finest())
            }
        }
    }

    /// Returns the tolerance multiplied by `part`. A field stays as it is.
    pub fn scaled(&self, part: f64) -> Self {
        match self {
            Self::Uniform(most) => Self::Uniform(part * most),
            Self::Pixels { camera, pixels } => {
                Self::Pixels { camera: *camera, pixels: part * pixels }
            }
            Self::Field(field) => Self::Field(*field),
            Self::Each(queries) => {
                let scaled = |query: &Query<'f>| Query {
                    focus: query.focus.clone(),
                    tolerance: query.tolerance.scaled(part),
                };
                Self::Each(queries.iter().map(scaled).collect())
            }
        }
    }
}

impl Query<'static> {
    /// Creates a query for the whole surface, at the finest level.
    pub fn finest() -> Self {
        Self::uniform(0.0)
    }

    /// Creates a query for the whole surface with the same tolerance everywhere, in model units.
    pub fn uniform(tolerance: f64) -> Self {
        Self { focus: Focus::Everything, tolerance: Tolerance::Uniform(tolerance) }
    }

    /// Creates a query for the whole surface with a tolerance in pixels, as seen by a camera.
    pub fn pixels(camera: ViewCamera, pixels: f64) -> Self {
        Self { focus: Focus::Everything, tolerance: Tolerance::Pixels { camera, pixels } }
    }
}

impl Query<'_> {
    /// Checks that the query is valid, as whatever answers it does first.
    ///
    /// # Errors
    /// A coordinate, angle or length that is not finite or out of range.
    pub fn validate(&self) -> Result<(), QueryError> {
        self.focus.validate()?;
        match &self.tolerance {
            Tolerance::Uniform(most) => length("the tolerance", *most),
            Tolerance::Pixels { camera, pixels } => {
                camera.validate()?;
                length("the tolerance", *pixels)
            }
            Tolerance::Field(_) => Ok(()),
            Tolerance::Each(queries) => queries.iter().try_for_each(Query::validate),
        }
    }

    /// Returns true if the query asks for something everywhere, and not only in some region.
    pub fn is_everywhere(&self) -> bool {
        let is_each = match &self.tolerance {
            Tolerance::Each(queries) => queries.iter().any(Query::is_everywhere),
            _ => true,
        };
        is_each && matches!(self.focus, Focus::Everything)
    }
}

impl Focus {
    /// Returns false only if the focus misses the ball around a box, in model units.
    ///
    /// The focus must be valid.
    pub fn may_meet(&self, bounds: &Bounds) -> bool {
        let frame = Frame::of_diagonal(bounds);
        let [min, max] = [bounds.min, bounds.max].map(|corner| frame.local(corner));
        let (center, radius) = (0.5 * (min + max), 0.5 * min.distance(max));
        Region::new(self, &frame).meets_ball(center, SLACK * radius)
    }

    /// Checks that the focus is valid.
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
                length("the radius", *radius)
            }
            Self::Frustum(camera) => camera.validate(),
            Self::Ground(ground) => ground.validate(),
        }
    }
}

impl ViewCamera {
    /// Returns the size of a pixel in the middle of the picture, as a fraction of the distance from
    /// the camera.
    pub fn pixel(&self) -> f64 {
        2.0 * (0.5 * self.fov_rad).tan() / f64::from(self.viewport[1])
    }

    /// Returns the factor by which an error in a corner of the picture can span more pixels than in
    /// its middle.
    ///
    /// Divide a pixel tolerance by it to make it hold everywhere. It is 1.7 for a wide picture 45°
    /// high.
    ///
    /// A picture is flat: at an angle from its middle it is further away, and the line of sight
    /// meets it at that angle. Both stretch what is seen by the inverse of its cosine.
    pub fn stretch(&self) -> f64 {
        let [width, height] = self.viewport.map(f64::from);
        let high = (0.5 * self.fov_rad).tan();
        1.0 + high * high * (1.0 + (width / height) * (width / height))
    }

    /// Returns the orthonormal directions forward, right and up.
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
            return Err(QueryError::Blind(
                "it looks at its own position, or along its up direction",
            ));
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
            Self::Each(queries) => f.debug_tuple("Each").field(queries).finish(),
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

    /// Turns errors of one pixel's length in all directions, at points all over the picture.
    #[test]
    fn stretch_bounds_the_span_of_an_error() {
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
