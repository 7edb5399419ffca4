//! The refinement criterion: whether a query requires an update.

use glam::{DVec3, Vec3};
use meshlod_mesh::Frame;

use crate::length16::Length16;
use crate::query::Region;
use crate::query::{Query, QueryError, Tolerance};

/// Factor by which balls are enlarged, so that rounding in a query cannot make a ball miss
/// something that a ball inside it meets.
pub(crate) const SLACK: f64 = 1.0 + 1e-6;

/// Bounding ball of both sides of an update and the error of its coarse side, in stored units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ball {
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
    pub(crate) error: f64,
}

/// Bounding box of a set of updates and the greatest of their errors, in stored units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Area {
    pub(crate) min: DVec3,
    pub(crate) max: DVec3,
    pub(crate) error: f64,
}

impl Area {
    /// The box that holds nothing.
    pub(crate) const EMPTY: Self =
        Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY, error: 0.0 };

    /// Extends the box to hold another one.
    pub(crate) fn join(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.error = self.error.max(other.error);
    }
}

/// A ball as the packed model stores it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PackedBall {
    pub(crate) center: [f32; 3],
    pub(crate) radius: Length16,
    pub(crate) error: Length16,
}

impl PackedBall {
    #[inline]
    pub(crate) fn unpack(&self) -> Ball {
        Ball {
            center: Vec3::from(self.center).as_dvec3(),
            radius: self.radius.get(),
            error: self.error.get(),
        }
    }
}

/// A query in stored units.
///
/// The criterion is monotone: if it requires a ball, it requires every ball that contains it with at
/// least its error. Where the tolerance is 0 it requires every ball, whatever its error.
pub(crate) struct Criterion<'f> {
    region: Region,
    tolerance: StoredTolerance<'f>,
}

enum StoredTolerance<'f> {
    Uniform(f64),
    /// A fraction of the distance from the viewpoint.
    Perspective(Viewpoint),
    /// A fraction of a field.
    Field {
        field: &'f dyn Fn([f64; 3], f64) -> f64,
        part: f64,
        frame: Frame,
    },
    /// The least of several, each in its own region.
    Each(Vec<Criterion<'f>>),
}

/// The part of a camera that determines how large an error appears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Viewpoint {
    pub(crate) at: DVec3,
    /// Tolerance per unit of distance.
    pub(crate) slope: f64,
}

/// Identity of a query, to recognize it when it comes again. Fields and several queries have none.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct QueryKey {
    region: Region,
    uniform: Option<f64>,
    viewpoint: Option<Viewpoint>,
}

impl<'f> Criterion<'f> {
    pub(crate) fn new(query: &Query<'f>, frame: &Frame) -> Result<Self, QueryError> {
        query.validate()?;
        let region = Region::new(&query.focus, frame);
        let tolerance = match &query.tolerance {
            Tolerance::Uniform(most) => StoredTolerance::Uniform(frame.local_length(*most)),
            Tolerance::Pixels { camera, pixels } => StoredTolerance::Perspective(Viewpoint {
                at: frame.local(camera.eye),
                slope: pixels * camera.pixel(),
            }),
            Tolerance::Field(field) => {
                StoredTolerance::Field { field: *field, part: 1.0, frame: *frame }
            }
            Tolerance::Each(queries) => {
                let each = queries.iter().map(|query| Self::new(query, frame));
                StoredTolerance::Each(each.collect::<Result<_, _>>()?)
            }
        };
        Ok(Self { region, tolerance })
    }

    /// Returns true if the ball's update is required: it meets the focus and its error exceeds the
    /// least tolerance in it.
    #[inline]
    pub(crate) fn requires(&self, ball: &Ball) -> bool {
        self.exceeds(ball) && self.meets(ball)
    }

    /// Returns the priority of each ball: its error over the least tolerance in it, next to nothing
    /// if it is exact, and 0 if it misses the focus. Priorities are monotone like the criterion.
    pub(crate) fn priorities(&self, balls: impl Iterator<Item = Ball>) -> Vec<f32> {
        match (&self.region, &self.tolerance) {
            // The common cases, without a branch in the loop.
            (Region::Everything, StoredTolerance::Uniform(most)) => {
                balls.map(|ball| times(ball.error, *most)).collect()
            }
            (Region::Everything, StoredTolerance::Perspective(viewpoint)) => {
                balls.map(|ball| times(ball.error, viewpoint.least(&ball))).collect()
            }
            _ => balls.map(|ball| self.priority(&ball)).collect(),
        }
    }

    fn priority(&self, ball: &Ball) -> f32 {
        match &self.tolerance {
            _ if !self.meets(ball) => 0.0,
            StoredTolerance::Each(each) => {
                each.iter().map(|one| one.priority(ball)).fold(0.0, f32::max)
            }
            _ => times(ball.error, self.least(ball)),
        }
    }

    /// Returns the least tolerance within a ball.
    fn least(&self, ball: &Ball) -> f64 {
        match &self.tolerance {
            StoredTolerance::Uniform(most) => *most,
            StoredTolerance::Perspective(viewpoint) => viewpoint.least(ball),
            StoredTolerance::Field { field, part, frame } => {
                let center = frame.model(ball.center.as_vec3());
                let most = field(center, frame.model_length(ball.radius));
                // An invalid tolerance counts as 0: `max` prefers the number over NaN.
                frame.local_length(part * most.max(0.0))
            }
            StoredTolerance::Each(each) => {
                let met = each.iter().filter(|one| one.meets(ball));
                met.map(|one| one.least(ball)).fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// Returns false only if no update within the box and with at most its error is required.
    pub(crate) fn may_require_in(&self, area: &Area) -> bool {
        let Area { min, max, error } = *area;
        let ball = Ball { center: 0.5 * (min + max), radius: 0.5 * min.distance(max), error };
        let squared = |from: DVec3| from.distance_squared(from.clamp(min, max));
        let exceeds = match &self.tolerance {
            StoredTolerance::Perspective(viewpoint) => {
                let slope = viewpoint.slope;
                slope == 0.0 || slope * slope * squared(viewpoint.at) < error * error
            }
            StoredTolerance::Uniform(_) | StoredTolerance::Field { .. } => self.exceeds(&ball),
            StoredTolerance::Each(each) => each.iter().any(|one| one.may_require_in(area)),
        };
        exceeds
            && self.meets(&ball)
            && match &self.region {
                Region::Box([low, high]) => low.cmple(max).all() && high.cmpge(min).all(),
                Region::Sphere(middle, reach) => squared(*middle) <= reach * reach,
                Region::Everything | Region::Segment(_) | Region::Planes(_) | Region::Wall(_) => {
                    true
                }
            }
    }

    #[inline]
    fn exceeds(&self, ball: &Ball) -> bool {
        match &self.tolerance {
            StoredTolerance::Uniform(most) => is_exceeded(*most, ball),
            StoredTolerance::Perspective(viewpoint) => viewpoint.exceeded_by(ball),
            StoredTolerance::Field { .. } => is_exceeded(self.least(ball), ball),
            StoredTolerance::Each(each) => each.iter().any(|one| one.requires(ball)),
        }
    }

    /// Returns true if a triangle, in stored units, intersects the focus.
    pub(crate) fn meets_triangle(&self, corners: [DVec3; 3]) -> bool {
        self.region.meets_triangle(corners)
            && match &self.tolerance {
                StoredTolerance::Each(each) => each.iter().any(|one| one.meets_triangle(corners)),
                _ => true,
            }
    }

    #[inline]
    fn meets(&self, ball: &Ball) -> bool {
        self.region.meets_ball(ball.center, ball.radius)
    }

    /// Returns the criterion with its tolerance multiplied by `by`.
    pub(crate) fn scaled(mut self, by: f64) -> Self {
        match &mut self.tolerance {
            StoredTolerance::Uniform(most) => *most *= by,
            StoredTolerance::Perspective(viewpoint) => viewpoint.slope *= by,
            StoredTolerance::Field { part, .. } => *part *= by,
            StoredTolerance::Each(each) => {
                *each = std::mem::take(each).into_iter().map(|one| one.scaled(by)).collect();
            }
        }
        self
    }

    /// Returns the identity of the query, or `None` for a field and for several queries.
    pub(crate) fn key(&self) -> Option<QueryKey> {
        let (uniform, viewpoint) = match self.tolerance {
            StoredTolerance::Uniform(most) => (Some(most), None),
            StoredTolerance::Perspective(viewpoint) => (None, Some(viewpoint)),
            StoredTolerance::Field { .. } | StoredTolerance::Each(_) => return None,
        };
        Some(QueryKey { region: self.region.clone(), uniform, viewpoint })
    }

    /// Returns true if the tolerance is the same everywhere.
    pub(crate) fn is_uniform(&self) -> bool {
        matches!((&self.region, &self.tolerance), (Region::Everything, StoredTolerance::Uniform(_)))
    }

    /// Returns the viewpoint if the criterion depends on nothing else.
    pub(crate) fn viewpoint(&self) -> Option<Viewpoint> {
        match (&self.region, &self.tolerance) {
            (Region::Everything, StoredTolerance::Perspective(viewpoint)) => Some(*viewpoint),
            _ => None,
        }
    }
}

impl Viewpoint {
    /// Returns the least tolerance within a ball.
    #[inline]
    fn least(&self, ball: &Ball) -> f64 {
        self.slope * (self.at.distance(ball.center) - ball.radius)
    }

    #[inline]
    fn exceeded_by(&self, ball: &Ball) -> bool {
        // Compared at the point of the ball closest to the viewpoint.
        let reach = ball.error + self.slope * ball.radius;
        let squared = self.slope * self.slope * self.at.distance_squared(ball.center);
        self.slope == 0.0 || ball.error > 0.0 && squared < reach * reach
    }

    /// Returns the distance below which the viewpoint requires an update, or `None` if that never
    /// changes.
    pub(crate) fn reach(&self, ball: &Ball) -> Option<f64> {
        let reach = ball.radius + ball.error / self.slope;
        (ball.error > 0.0 && reach.is_finite()).then_some(reach)
    }
}

/// Returns true if a ball's error is more than allowed. Nothing is fine enough for a tolerance of 0.
#[inline]
fn is_exceeded(most: f64, ball: &Ball) -> bool {
    ball.error > most || most == 0.0
}

/// Returns an error in multiples of a tolerance, and the least positive number if that is 0. With a
/// tolerance of 0 priorities are in the order of the errors.
#[inline]
fn times(error: f64, most: f64) -> f32 {
    let least = f64::from(f32::MIN_POSITIVE);
    let times = (error / if most > least { most } else { least }).min(f32::MAX.into()) as f32;
    times.max(f32::from_bits(1))
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::Bounds;

    use super::*;
    use crate::query::{Focus, ViewCamera};

    fn criterion(focus: Focus, tolerance: Tolerance<'_>) -> Criterion<'_> {
        let frame = Frame::of_diagonal(&Bounds { min: [-1.0; 3], max: [1.0; 3] });
        Criterion::new(&Query { focus, tolerance }, &frame).unwrap()
    }

    /// A ball given in model units, for a frame whose unit is 4.
    fn ball(center: [f64; 3], radius: f64, error: f64) -> Ball {
        Ball { center: DVec3::from(center) / 4.0, radius: radius / 4.0, error: error / 4.0 }
    }

    fn camera() -> ViewCamera {
        ViewCamera {
            eye: [0.0, 0.0, 5.0],
            look: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            fov_rad: std::f64::consts::FRAC_PI_2,
            viewport: [200, 100],
        }
    }

    #[test]
    fn a_focus_meets_the_balls_that_reach_it() {
        let reached = |focus: Focus, center| {
            let criterion = criterion(focus, Tolerance::Uniform(0.0));
            [0.9, 1.1].map(|radius| criterion.requires(&ball(center, radius, 1.0)))
        };
        let at = [2.0, 0.0, 0.0];
        assert_eq!(reached(Focus::Everything, at), [true, true]);
        assert_eq!(reached(Focus::Point([1.0, 0.0, 0.0]), at), [false, true]);
        assert_eq!(reached(Focus::Segment([[1.0, -3.0, 0.0], [1.0, 3.0, 0.0]]), at), [false, true]);
        assert_eq!(reached(Focus::Segment([[1.0, 0.0, 0.0]; 2]), at), [false, true]);
        assert_eq!(reached(Focus::Box([[-1.0; 3], [1.0; 3]]), at), [false, true]);
        assert_eq!(reached(Focus::Sphere { center: [0.0; 3], radius: 1.0 }, at), [false, true]);
        // The viewport is twice as wide as high, so its upper side rises by one per unit of
        // distance.
        let above = [0.0, 5.0 + 2f64.sqrt(), 0.0];
        assert_eq!(reached(Focus::Frustum(camera()), above), [false, true]);
        assert_eq!(reached(Focus::Frustum(camera()), [9.0, 0.0, 0.0]), [true, true]);
        assert_eq!(reached(Focus::Frustum(camera()), [0.0, 0.0, 6.0]), [false, true]);
    }

    #[test]
    fn pixels_grow_with_the_distance() {
        // A pixel spans a fiftieth of the distance: 0.1 at distance 5.
        let criterion =
            criterion(Focus::Everything, Tolerance::Pixels { camera: camera(), pixels: 1.0 });
        assert!(
            !criterion.requires(&ball([0.0; 3], 0.0, 0.099))
                && criterion.requires(&ball([0.0; 3], 0.0, 0.101))
        );
        // A ball that reaches half-way to the viewpoint is judged from there.
        assert!(
            criterion.requires(&ball([0.0; 3], 2.5, 0.051))
                && !criterion.requires(&ball([0.0; 3], 2.5, 0.049))
        );
        assert!(!criterion.requires(&ball([0.0; 3], 9.0, 0.0)), "what is exact is fine enough");
        let reach = criterion.viewpoint().unwrap().reach(&ball([0.0; 3], 2.0, 0.02)).unwrap();
        assert!((4.0 * reach - 3.0).abs() < 1e-12, "2 + 1: {reach}");
    }

    #[test]
    fn a_field_is_evaluated_in_model_units() {
        let field = |center: [f64; 3], radius: f64| (center[0].abs() - radius).max(0.0);
        let criterion = criterion(Focus::Everything, Tolerance::Field(&field));
        assert!(criterion.requires(&ball([1.0, 0.0, 0.0], 0.5, 0.6)));
        assert!(!criterion.requires(&ball([1.0, 0.0, 0.0], 0.5, 0.4)));
    }

    #[test]
    fn an_invalid_field_value_counts_as_zero() {
        for none in [f64::NAN, -1.0, f64::NEG_INFINITY] {
            let field = |_: [f64; 3], _: f64| none;
            let criterion = criterion(Focus::Everything, Tolerance::Field(&field));
            assert!(criterion.requires(&ball([0.0; 3], 0.1, 1e-6)), "{none}");
            assert!(criterion.requires(&ball([0.0; 3], 0.1, 0.0)), "nothing is fine enough");
            let priorities = criterion.priorities([ball([0.0; 3], 0.1, 1e-6)].into_iter());
            assert!(priorities[0] > 1e20, "{none}: {priorities:?}");
        }
    }

    #[test]
    fn a_tolerance_of_zero_requires_what_is_exact_too() {
        let pixels = |pixels| Tolerance::Pixels { camera: camera(), pixels };
        let exact = ball([0.0; 3], 0.1, 0.0);
        let unit = exact.radius;
        let area = Area { min: DVec3::splat(-unit), max: DVec3::splat(unit), error: 0.0 };
        for (tolerance, is_finest) in [
            (Tolerance::Uniform(0.0), true),
            (Tolerance::Uniform(1e-300), false),
            (pixels(0.0), true),
            (pixels(1e-300), false),
        ] {
            assert_eq!(tolerance.is_finest(), is_finest);
            let all = criterion(Focus::Everything, tolerance.clone());
            let elsewhere = criterion(Focus::Point([3.0; 3]), tolerance);
            assert_eq!([&all, &elsewhere].map(|c| c.requires(&exact)), [is_finest, false]);
            assert_eq!([&all, &elsewhere].map(|c| c.may_require_in(&area)), [is_finest, false]);
            let first = |c: &Criterion<'_>| c.priorities([exact].into_iter())[0];
            assert!(first(&all) > 0.0 && first(&elsewhere) == 0.0);
        }
    }

    #[test]
    fn invalid_queries_are_refused() {
        let frame = Frame::of_diagonal(&Bounds { min: [-1.0; 3], max: [1.0; 3] });
        let ask = |focus, tolerance| Criterion::new(&Query { focus, tolerance }, &frame).err();
        let fine = || Tolerance::Uniform(0.1);
        assert!(ask(Focus::Everything, Tolerance::Uniform(f64::NAN)).is_some());
        assert!(ask(Focus::Everything, Tolerance::Uniform(-1.0)).is_some());
        assert!(ask(Focus::Point([f64::INFINITY, 0.0, 0.0]), fine()).is_some());
        assert_eq!(ask(Focus::Box([[1.0; 3], [0.0; 3]]), fine()), Some(QueryError::InsideOut));
        let along_up = ViewCamera { up: [0.0, 0.0, 1.0], ..camera() };
        assert!(ask(Focus::Frustum(along_up), fine()).is_some());
        let without = ViewCamera { viewport: [0, 10], ..camera() };
        assert!(
            ask(Focus::Everything, Tolerance::Pixels { camera: without, pixels: 1.0 }).is_some()
        );
    }
}
