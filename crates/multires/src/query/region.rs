//! The focus of a query in stored units, with its intersection tests.

use glam::DVec3;
use meshlod_mesh::Frame;
use meshlod_spatial::closest_point;

use crate::query::ground::Wall;
use crate::query::{Focus, Ground, GroundShape, ViewCamera};

/// A focus prepared for intersection tests.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Region {
    Everything,
    Segment([DVec3; 2]),
    Box([DVec3; 2]),
    Sphere(DVec3, f64),
    /// Half-spaces `normal · x >= offset` whose intersection is the region.
    Planes([(DVec3, f64); 5]),
    /// A vertical wall over a line on the ground.
    Wall(Wall),
}

/// Half the height of an unbounded region, in stored units; a model spans about one.
const UNBOUNDED_HALF_HEIGHT: f64 = 1024.0;

/// Slack of the triangle tests: positions are rounded to 2⁻²⁴ of the unit.
const ROUNDING: f64 = 1.0 / (1u64 << 22) as f64;

impl Region {
    /// Converts a valid focus to stored units.
    pub(crate) fn new(focus: &Focus, frame: &Frame) -> Self {
        let point = |p: [f64; 3]| frame.local(p);
        match focus {
            Focus::Everything => Self::Everything,
            Focus::Point(at) => Self::Sphere(point(*at), 0.0),
            Focus::Segment(ends) => Self::Segment(ends.map(point)),
            Focus::Box(corners) => Self::Box(corners.map(point)),
            Focus::Sphere { center, radius } => {
                Self::Sphere(point(*center), frame.local_length(*radius))
            }
            Focus::Frustum(camera) => Self::Planes(planes(camera, point(camera.eye))),
            Focus::Ground(ground) => Self::over(ground, frame),
        }
    }

    fn over(ground: &Ground, frame: &Frame) -> Self {
        let (GroundShape::Line(ends) | GroundShape::Box(ends)) = ground.shape;
        let mut places = ends.map(|place| frame.local(ground.over(place, 0.0)));
        match ground.shape {
            GroundShape::Line(_) => Self::Wall(Wall::new(ground.up, places)),
            GroundShape::Box(_) => {
                (places[0][ground.up], places[1][ground.up]) =
                    (-UNBOUNDED_HALF_HEIGHT, UNBOUNDED_HALF_HEIGHT);
                Self::Box(places)
            }
        }
    }

    /// Returns true if a ball intersects the region.
    #[inline]
    pub(crate) fn meets_ball(&self, center: DVec3, radius: f64) -> bool {
        let squared = match self {
            Self::Everything => return true,
            Self::Segment(ends) => center.distance_squared(closest(center, *ends)),
            Self::Box([min, max]) => center.distance_squared(center.clamp(*min, *max)),
            Self::Wall(wall) => wall.distance_squared(center),
            Self::Sphere(middle, reach) => {
                return center.distance_squared(*middle) <= (reach + radius) * (reach + radius);
            }
            Self::Planes(planes) => {
                return planes.iter().all(|&(normal, least)| normal.dot(center) + radius >= least);
            }
        };
        squared <= radius * radius
    }

    /// Returns true if a triangle intersects the region. The tests against segments and frusta are
    /// conservative: they compare with the triangle's bounding ball, and accept triangles that are
    /// outside but not beyond any single plane.
    pub(crate) fn meets_triangle(&self, corners: [DVec3; 3]) -> bool {
        match self {
            Self::Everything => true,
            Self::Segment(_) => {
                let center = (corners[0] + corners[1] + corners[2]) / 3.0;
                let radius = corners.iter().map(|corner| corner.distance(center));
                self.meets_ball(center, radius.fold(ROUNDING, f64::max))
            }
            Self::Box([min, max]) => {
                let (center, half) = (0.5 * (*min + *max), 0.5 * (*max - *min) + ROUNDING);
                meets_box(corners.map(|corner| corner - center), half)
            }
            Self::Sphere(middle, reach) => {
                closest_point(*middle, &corners).distance(*middle) <= reach + ROUNDING
            }
            Self::Wall(wall) => wall.meets_triangle(corners, ROUNDING),
            Self::Planes(planes) => planes.iter().all(|&(normal, least)| {
                corners.iter().any(|&corner| normal.dot(corner) >= least - ROUNDING)
            }),
        }
    }
}

/// Returns true if a triangle intersects the box of the given half sides about the origin: no face
/// normal of the box, the normal of the triangle or cross product of their edges is a separating
/// axis.
fn meets_box(corners: [DVec3; 3], half: DVec3) -> bool {
    let [a, b, c] = corners;
    let edges = [b - a, c - b, a - c];
    let parts = |axis: DVec3| {
        let along = corners.map(|corner| corner.dot(axis));
        let least = along.into_iter().fold(f64::INFINITY, f64::min);
        let most = along.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let reach = half.dot(axis.abs());
        least > reach || most < -reach
    };
    let across = edges.into_iter().flat_map(|edge| DVec3::AXES.map(|axis| axis.cross(edge)));
    !DVec3::AXES.into_iter().chain([edges[0].cross(edges[1])]).chain(across).any(parts)
}

fn closest(to: DVec3, [a, b]: [DVec3; 2]) -> DVec3 {
    let along = b - a;
    let squared = along.length_squared();
    let t = if squared > 0.0 { ((to - a).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    a + t * along
}

/// Returns the near plane through the eye and the four sides of the view frustum.
fn planes(camera: &ViewCamera, eye: DVec3) -> [(DVec3, f64); 5] {
    let [forward, right, up] = camera.axes();
    let [width, height] = camera.viewport.map(f64::from);
    let high = (0.5 * camera.fov_rad).tan();
    let wide = high * width / height;
    let inside = |normal: DVec3| {
        let normal = normal.normalize_or_zero();
        (normal, normal.dot(eye))
    };
    [
        inside(forward),
        inside(wide * forward + right),
        inside(wide * forward - right),
        inside(high * forward + up),
        inside(high * forward - up),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with many points of each triangle: a triangle with a point inside intersects the
    /// region, and one that intersects has a point close to it.
    #[test]
    fn triangle_tests_agree_with_sampled_points() {
        let mut seed = 1u64;
        let mut roll = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 40) as f64 / (1u64 << 24) as f64 - 0.5
        };
        let mut point = || DVec3::new(roll(), roll(), roll());
        let half = DVec3::new(0.1, 0.2, 0.05);
        let center = DVec3::new(0.05, -0.1, 0.0);
        let places = [
            (Region::Box([center - half, center + half]), true),
            (Region::Sphere(center, 0.15), true),
            (Region::Segment([center - half, center + half]), false),
        ];
        let mut met = [[0; 2]; 3];
        for _ in 0..2000 {
            let corners @ [a, b, c] = [point(), point(), point()];
            const FINE: u32 = 60;
            let inner = (0..=FINE).flat_map(|i| (0..=FINE - i).map(move |j| [i, j]));
            let inner: Vec<_> = inner
                .map(|ij| ij.map(|i| f64::from(i) / f64::from(FINE)))
                .map(|[u, v]| a + u * (b - a) + v * (c - a))
                .collect();
            for ((place, is_exact), met) in places.iter().zip(&mut met) {
                let is_met = place.meets_triangle(corners);
                let within = |reach: f64| inner.iter().any(|&p| place.meets_ball(p, reach));
                assert!(is_met || !within(0.0), "{place:?} {corners:?}");
                // Sample points are a sixtieth of an edge apart, and an edge is at most √3.
                assert!(!is_met || !is_exact || within(0.03), "{place:?} {corners:?}");
                met[usize::from(is_met)] += 1;
            }
        }
        assert!(met.iter().flatten().all(|&count| count > 100), "{met:?}");
    }
}
