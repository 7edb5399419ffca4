//! Regions over the ground: lines and windows on a map, unbounded along the vertical axis.

use glam::{DVec2, DVec3};

use crate::query::QueryError;

/// Region over the ground, which reaches from deepest depth to greatest height.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Ground {
    /// Vertical axis: 0, 1 or 2 for x, y or z. That of a height field is
    /// [`HeightField::axis`](crate::HeightField::axis).
    pub up: usize,
    /// Shape on the ground, by the other two axes in the order x, y, z.
    pub shape: GroundShape,
}

/// Shape on the ground, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum GroundShape {
    /// The segment between two points.
    Line([[f64; 2]; 2]),
    /// An axis-aligned box, given by its corners of least and of greatest coordinates.
    Box([[f64; 2]; 2]),
}

/// Vertical wall over a segment on the ground, in stored units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wall {
    up: usize,
    ends: [DVec2; 2],
}

impl Ground {
    pub(crate) fn validate(&self) -> Result<(), QueryError> {
        if self.up > 2 {
            return Err(QueryError::NoAxis(self.up));
        }
        let (GroundShape::Line(ends) | GroundShape::Box(ends)) = self.shape;
        if !ends.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(QueryError::NotFinite("ground"));
        }
        let is_turned = matches!(self.shape, GroundShape::Box([min, max]) if min[0] > max[0] || min[1] > max[1]);
        if is_turned { Err(QueryError::InsideOut) } else { Ok(()) }
    }

    /// Returns the point over a place on the ground at a height.
    pub(crate) fn over(&self, place: [f64; 2], height: f64) -> [f64; 3] {
        let [first, second] = across(self.up);
        let mut point = [0.0; 3];
        (point[first], point[second], point[self.up]) = (place[0], place[1], height);
        point
    }
}

impl Wall {
    /// Creates the wall over the segment between two points, whose heights do not matter.
    pub(crate) fn new(up: usize, ends: [DVec3; 2]) -> Self {
        Self { up, ends: ends.map(|end| on_ground(end, up)) }
    }

    /// Returns the squared distance of a point from the wall.
    #[inline]
    pub(crate) fn distance_squared(&self, point: DVec3) -> f64 {
        let (point, [a, b]) = (on_ground(point, self.up), self.ends);
        let along = b - a;
        let squared = along.length_squared();
        let t = if squared > 0.0 { (point - a).dot(along) / squared } else { 0.0 };
        point.distance_squared(a + t.clamp(0.0, 1.0) * along)
    }

    /// Returns true if a triangle comes within `slack` of the wall: on the ground, no normal and no
    /// direction of an edge is a separating axis.
    pub(crate) fn meets_triangle(&self, corners: [DVec3; 3], slack: f64) -> bool {
        let [a, b, c] = corners.map(|corner| on_ground(corner, self.up));
        let edges = [b - a, c - b, a - c, self.ends[1] - self.ends[0]];
        let separates = |axis: DVec2| {
            let range = |points: &[DVec2]| {
                let along = points.iter().map(|p| p.dot(axis));
                along.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], x| {
                    [least.min(x), most.max(x)]
                })
            };
            let (own, other) = (range(&self.ends), range(&[a, b, c]));
            (own[0] - other[1]).max(other[0] - own[1]) > slack * axis.length()
        };
        !edges.into_iter().flat_map(|edge| [edge, edge.perp()]).any(separates)
    }
}

/// Returns the two axes of the ground.
fn across(up: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][up]
}

fn on_ground(point: DVec3, up: usize) -> DVec2 {
    let [first, second] = across(up);
    DVec2::new(point[first], point[second])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(corners: [[f64; 2]; 3], heights: [f64; 3]) -> [DVec3; 3] {
        std::array::from_fn(|k| DVec3::new(corners[k][0], heights[k], corners[k][1]))
    }

    #[test]
    fn a_wall_meets_what_its_line_crosses() {
        let wall = Wall::new(1, [DVec3::new(0.0, 7.0, 0.0), DVec3::new(2.0, -7.0, 2.0)]);
        let meets = |corners| wall.meets_triangle(triangle(corners, [9.0, -9.0, 0.0]), 1e-9);
        assert!(meets([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]), "across");
        assert!(!meets([[0.9, 0.8], [3.0, 0.0], [3.0, 0.5]]), "below");
        assert!(meets([[2.0, 2.0], [3.0, 2.0], [2.0, 3.0]]), "at its end");
        assert!(!meets([[2.1, 2.1], [3.0, 2.0], [2.0, 3.0]]), "beyond its end");
        assert!(meets([[-5.0, 9.0], [9.0, -5.0], [9.0, 9.0]]), "around it");
        // Triangles that stand upright are segments on the ground.
        assert!(meets([[0.0, 1.0], [1.0, 0.0], [0.5, 0.5]]));
        assert!(!meets([[3.0, 3.0], [4.0, 4.0], [3.5, 3.5]]));
    }

    #[test]
    fn walls_and_triangles_agree_with_samples() {
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / (1 << 24) as f64
        };
        let (mut met, mut missed) = (0, 0);
        for _ in 0..2000 {
            let ends = [0; 2].map(|_| DVec3::new(next(), next(), next()));
            let corners = [0; 3].map(|_| DVec3::new(next(), next(), 0.6 * next()));
            let wall = Wall::new(2, ends);
            let inner = (0..40).flat_map(|i| (0..40 - i).map(move |k| [i, k].map(f64::from)));
            let inner = inner.map(|[i, k]| {
                let [u, v] = [i / 39.0, k / 39.0];
                corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0])
            });
            let near = inner.map(|p| wall.distance_squared(p)).fold(f64::INFINITY, f64::min);
            let is_met = wall.meets_triangle(corners, 0.0);
            assert!(is_met || near > 0.0);
            assert!(!is_met || near.sqrt() < 0.05, "{near}");
            *(if is_met { &mut met } else { &mut missed }) += 1;
        }
        assert!(met > 300 && missed > 300, "{met}, {missed}");
    }

    #[test]
    fn invalid_grounds_are_refused() {
        let of = |up, shape| Ground { up, shape }.validate();
        assert!(of(2, GroundShape::Line([[0.0; 2], [1.0; 2]])).is_ok());
        assert!(of(3, GroundShape::Line([[0.0; 2], [1.0; 2]])).is_err());
        assert!(of(1, GroundShape::Box([[1.0; 2], [0.0; 2]])).is_err());
        assert!(of(1, GroundShape::Line([[f64::NAN, 0.0], [0.0; 2]])).is_err());
    }
}
