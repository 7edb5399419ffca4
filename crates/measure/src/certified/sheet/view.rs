//! Triangles seen along a direction.

use glam::{DVec2, DVec3, Vec3Swizzles};

/// Sine of an angle of a triangle below which its plane is not trusted.
const THIN: f64 = 1e-3;

/// Part of a triangle by which it is shrunk at most.
const MOST_SHRUNK: f64 = 0.9;

/// A triangle, and the direction at right angles to it, along which others are seen.
pub(super) struct View {
    origin: DVec3,
    /// Two axes across the direction, and the direction.
    axes: [DVec3; 3],
    /// Corners of the triangle, shrunk about its middle, anticlockwise.
    inner: [DVec2; 3],
    /// Bound on the distance of a point of the triangle from that of the inner one over which it is
    /// seen.
    pub(super) spent: f64,
}

/// A triangle as it is seen: two coordinates across the direction, and the height along it.
pub(super) struct Seen([DVec3; 3]);

/// Part of a seen triangle.
pub(super) struct Piece {
    corners: [DVec3; 6],
    count: usize,
}

impl View {
    /// Looks at a triangle along its normal, or that of `other` if it is too thin; `None` if both
    /// are. Shrinks it by at most `inset`.
    pub(super) fn of(triangle: [DVec3; 3], other: [DVec3; 3], inset: f64) -> Option<Self> {
        let direction = normal(triangle).or_else(|| normal(other))?;
        let (x, y) = direction.any_orthonormal_pair();
        let origin = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
        let reach = triangle.map(|at| at.distance(origin)).into_iter().fold(0.0, f64::max);
        let part = (inset / reach).min(MOST_SHRUNK);
        let mut view =
            Self { origin, axes: [x, y, direction], inner: [DVec2::ZERO; 3], spent: part * reach };
        let seen = view.see(triangle);
        view.spent += seen.height();
        view.inner = seen.0.map(|at| at.xy() * (1.0 - part));
        if turn(view.inner) < 0.0 {
            view.inner.swap(1, 2);
        }
        Some(view)
    }

    pub(super) fn see(&self, triangle: [DVec3; 3]) -> Seen {
        let [x, y, z] = self.axes;
        Seen(triangle.map(|at| {
            let at = at - self.origin;
            DVec3::new(at.dot(x), at.dot(y), at.dot(z))
        }))
    }

    /// Returns true if a segment crosses the inner triangle, or comes nearer than `near`.
    pub(super) fn is_crossed(&self, [from, to]: [DVec2; 2], near: f64) -> bool {
        let is_apart = |a: DVec2, b: DVec2| {
            let along = b - a;
            let outside = |at: DVec2| along.perp_dot(at - a) < -near * along.length();
            outside(from) && outside(to)
        };
        let [a, b, c] = self.inner;
        if is_apart(a, b) || is_apart(b, c) || is_apart(c, a) {
            return false;
        }
        let along = to - from;
        let sides = self.inner.map(|at| along.perp_dot(at - from));
        let near = near * along.length();
        !(sides.iter().all(|&side| side > near) || sides.iter().all(|&side| side < -near))
    }
}

impl Seen {
    /// Returns the largest height, above or below.
    pub(super) fn height(&self) -> f64 {
        self.0.iter().fold(0.0, |most, at| most.max(at.z.abs()))
    }

    /// Returns the ends of a side.
    pub(super) fn side(&self, i: usize) -> [DVec2; 2] {
        [self.0[i].xy(), self.0[(i + 1) % 3].xy()]
    }

    /// Returns the part over the inner triangle of a view.
    pub(super) fn over(&self, view: &View) -> Piece {
        let mut piece = Piece { corners: [DVec3::ZERO; 6], count: 3 };
        piece.corners[..3].copy_from_slice(&self.0);
        let [a, b, c] = view.inner;
        for [from, to] in [[a, b], [b, c], [c, a]] {
            piece = piece.left_of(from, to);
        }
        piece
    }

    /// Returns 1 if the triangle covers a point, -1 if it is seen from behind, 0 if it does not
    /// cover it, and `None` if the point is too near its sides to tell.
    pub(super) fn cover(&self, at: DVec2, near: f64) -> Option<i32> {
        let corners = self.0.map(|corner| corner.xy());
        let [low, high] =
            [corners.into_iter().fold(at, DVec2::min), corners.into_iter().fold(at, DVec2::max)];
        let [least, most] = [
            corners.into_iter().fold(DVec2::INFINITY, DVec2::min),
            corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max),
        ];
        if (least - low).max(high - most).max_element() > near {
            return Some(0);
        }
        let (mut left, mut right) = (0, 0);
        for i in 0..3 {
            let [from, to] = self.side(i);
            let side = (to - from).perp_dot(at - from);
            let near = near * (to - from).length();
            left += i32::from(side > near);
            right += i32::from(side < -near);
        }
        match (left, right) {
            (3, _) => Some(1),
            (_, 3) => Some(-1),
            (1.., 1..) => Some(0),
            _ => None,
        }
    }
}

impl Piece {
    /// Returns the middle of the corners; `None` if there are none.
    pub(super) fn middle(&self) -> Option<DVec2> {
        let sum: DVec2 = self.corners().iter().map(|at| at.xy()).sum();
        (self.count > 0).then(|| sum / self.count as f64)
    }

    /// Returns the largest height, above or below.
    pub(super) fn height(&self) -> f64 {
        self.corners().iter().fold(0.0, |most, at| most.max(at.z.abs()))
    }

    fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// Returns the part to the left of a line.
    fn left_of(&self, from: DVec2, to: DVec2) -> Self {
        let along = to - from;
        let side = |at: &DVec3| along.perp_dot(at.xy() - from);
        let mut left = Self { corners: [DVec3::ZERO; 6], count: 0 };
        let mut add = |at: DVec3| {
            if let Some(slot) = left.corners.get_mut(left.count) {
                *slot = at;
                left.count += 1;
            }
        };
        let corners = self.corners();
        for (i, a) in corners.iter().enumerate() {
            let b = &corners[(i + 1) % corners.len()];
            let [of_a, of_b] = [side(a), side(b)];
            if of_a >= 0.0 {
                add(*a);
            }
            if (of_a < 0.0) != (of_b < 0.0) {
                add(a.lerp(*b, of_a / (of_a - of_b)));
            }
        }
        left
    }
}

/// Returns the unit normal of a triangle; `None` if it is too thin.
fn normal([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    let [ab, ac, bc] = [b - a, c - a, c - b];
    let across = ab.cross(ac);
    let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
    (across.length() > THIN * longest).then(|| across.normalize())
}

/// Returns twice the area of a triangle, negative if it is clockwise.
fn turn([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}
