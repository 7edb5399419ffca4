//! Distances that a query allows, triangle by triangle, for those who check its answer.

use glam::DVec3;
use meshlod_mesh::Frame;
use meshlod_spatial::closest_point;

use crate::query::{Area, Ball, Query, QueryError, Region, Tolerance};

/// Factor that covers the rounding of reaches.
const SLACK: f64 = 1.0 + 1e-6;

/// Distances from the surface that a query allows, prepared for triangles of one model.
#[derive(Clone, Debug)]
pub struct Limits {
    frame: Frame,
    limit: LocalLimit,
}

/// Allowed distance in a region, in stored units.
#[derive(Clone, Debug)]
struct LocalLimit {
    region: Region,
    allowed: Allowed,
}

#[derive(Clone, Debug)]
enum Allowed {
    Uniform(f64),
    /// A fraction of the distance from the eye.
    Perspective {
        eye: DVec3,
        slope: f64,
    },
    /// The least of several, each in its own region.
    Each(Vec<LocalLimit>),
}

impl Limits {
    /// Prepares the limits of a query.
    /// # Errors
    /// An invalid query, or one whose tolerance is a field.
    pub(crate) fn new(query: &Query<'_>, frame: &Frame) -> Result<Self, QueryError> {
        query.validate()?;
        Ok(Self { frame: *frame, limit: LocalLimit::new(query, frame)? })
    }

    /// Returns the least distance that the query allows in a triangle, both in model units; infinity
    /// if the triangle misses the focus.
    ///
    /// Three equal corners ask for a point. Triangles outside but close to a segment or a frustum may
    /// count as inside.
    pub fn in_triangle(&self, corners: [[f64; 3]; 3]) -> f64 {
        if let LocalLimit { region: Region::Everything, allowed: Allowed::Uniform(most) } =
            self.limit
        {
            return self.frame.model_length(most);
        }
        let corners = corners.map(|corner| self.frame.local(corner));
        self.frame.model_length(self.limit.in_triangle(&corners))
    }

    /// Returns how far from a ball, in model units, a point that it is compared with may be: the
    /// greatest distance between a point of the focus and one of the ball that the query allows.
    pub fn reach(&self, center: [f64; 3], radius: f64) -> f64 {
        let (center, radius) = (self.frame.local(center), self.frame.local_length(radius));
        self.frame.model_length(self.limit.reach(center, radius))
    }

    /// Returns true if a point of the focus may be compared with one of the ball.
    pub(crate) fn concerns(&self, ball: &Ball) -> bool {
        self.limit.concerns(ball)
    }

    /// Returns true if a point of the focus may be compared with one of the box.
    pub(crate) fn concern_area(&self, area: &Area) -> bool {
        self.limit.concerns_area(area)
    }
}

impl LocalLimit {
    fn new(query: &Query<'_>, frame: &Frame) -> Result<Self, QueryError> {
        let allowed = match &query.tolerance {
            Tolerance::Uniform(most) => Allowed::Uniform(frame.local_length(*most)),
            Tolerance::Pixels { camera, pixels } => Allowed::Perspective {
                eye: frame.local(camera.eye),
                slope: pixels * camera.pixel(),
            },
            Tolerance::Field(_) => return Err(QueryError::FieldUnchecked),
            Tolerance::Each(queries) => {
                let each = queries.iter().map(|query| Self::new(query, frame));
                Allowed::Each(each.collect::<Result<_, _>>()?)
            }
        };
        Ok(Self { region: Region::new(&query.focus, frame), allowed })
    }

    fn in_triangle(&self, corners: &[DVec3; 3]) -> f64 {
        if !self.region.meets_triangle(*corners) {
            return f64::INFINITY;
        }
        match &self.allowed {
            Allowed::Uniform(most) => *most,
            Allowed::Perspective { eye, slope } => {
                slope * closest_point(*eye, corners).distance(*eye)
            }
            Allowed::Each(each) => {
                let limits = each.iter().map(|limit| limit.in_triangle(corners));
                limits.fold(f64::INFINITY, f64::min)
            }
        }
    }

    fn reach(&self, center: DVec3, radius: f64) -> f64 {
        match &self.allowed {
            Allowed::Uniform(most) => SLACK * most,
            // A point p that is allowed to be slope · |p - eye| from q is at most as far from q as
            // this fraction of |q - eye|.
            Allowed::Perspective { eye, slope } if *slope < 1.0 => {
                SLACK * slope / (1.0 - slope) * (eye.distance(center) + radius)
            }
            Allowed::Perspective { .. } => f64::INFINITY,
            // Only what concerns the ball allows points near it.
            Allowed::Each(each) => {
                let near = each.iter().map(|limit| (limit, limit.reach(center, radius)));
                let near =
                    near.filter(|(limit, reach)| limit.region.meets_ball(center, radius + reach));
                near.map(|(_, reach)| reach).fold(0.0, f64::max)
            }
        }
    }

    fn concerns(&self, ball: &Ball) -> bool {
        let Ball { center, radius, .. } = *ball;
        let meets = || self.region.meets_ball(center, radius + self.reach(center, radius));
        match &self.allowed {
            Allowed::Each(each) => each.iter().any(|limit| limit.concerns(ball)) && meets(),
            _ => meets(),
        }
    }

    fn concerns_area(&self, area: &Area) -> bool {
        if let Allowed::Each(each) = &self.allowed
            && !each.iter().any(|limit| limit.concerns_area(area))
        {
            return false;
        }
        let Area { min, max, .. } = *area;
        let (center, radius) = (0.5 * (min + max), 0.5 * min.distance(max));
        let reach = self.reach(center, radius);
        let meets_box = match &self.region {
            Region::Box([low, high]) => {
                (*low - reach).cmple(max).all() && (*high + reach).cmpge(min).all()
            }
            _ => true,
        };
        meets_box && self.region.meets_ball(center, radius + reach)
    }
}
