//! Triangles seen along a direction.

use glam::{DVec2, DVec3, Vec3Swizzles};

use crate::Triangle;

/// Sine of an angle of a triangle below which its plane is not trusted: coordinates that were rounded
/// to 32 bits turn it.
const THIN: f64 = 1e-6;

/// Part of a triangle by which it is shrunk at most.
const MOST_SHRUNK: f64 = 0.9;

/// A triangle, and the direction at right angles to it, along which others are seen.
pub(super) struct View {
    /// Middle of the triangle.
    origin: DVec3,
    /// Two axes across the direction, and the direction.
    axes: [DVec3; 3],
    /// Corners of the triangle, shrunk about its middle.
    inner: [DVec2; 3],
    /// Lines along its sides: a direction outwards of length one, and the distance of the origin.
    lines: [(DVec2, f64); 3],
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
    /// Looks at a triangle along a direction of length one. Shrinks it by at most `inset`.
    pub(super) fn along(direction: DVec3, triangle: &Triangle, inset: f64) -> Self {
        let (x, y) = direction.any_orthonormal_pair();
        let origin = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
        let reach = triangle.map(|at| at.distance_squared(origin));
        let reach = reach.into_iter().fold(0.0, f64::max).sqrt();
        let part = if reach > 0.0 { (inset / reach).clamp(0.0, MOST_SHRUNK) } else { 0.0 };
        let mut view = Self {
            origin,
            axes: [x, y, direction],
            inner: [DVec2::ZERO; 3],
            lines: [(DVec2::ZERO, 0.0); 3],
            spent: part * reach,
        };
        let seen = view.see(triangle);
        view.spent += seen.height();
        view.inner = seen.0.map(|at| at.xy() * (1.0 - part));
        let [a, b, c] = view.inner;
        let outwards = -(b - a).perp_dot(c - a).signum();
        view.lines = [[a, b], [b, c], [c, a]].map(|[from, to]| {
            let across = outwards * (to - from).perp().normalize_or_zero();
            (across, across.dot(from))
        });
        view
    }

    /// Returns the point of the triangle's plane below a seen one.
    pub(super) fn at(&self, seen: DVec3) -> DVec3 {
        let [x, y, _] = self.axes;
        self.origin + x * seen.x + y * seen.y
    }

    /// Returns a triangle as it is seen.
    #[inline]
    pub(super) fn see(&self, triangle: &Triangle) -> Seen {
        let [x, y, z] = self.axes;
        Seen(triangle.map(|at| {
            let at = at - self.origin;
            DVec3::new(at.dot(x), at.dot(y), at.dot(z))
        }))
    }

    /// Returns which sides of a seen triangle cross the inner one, or come nearer than `near`. A side
    /// without length does not.
    #[inline]
    pub(super) fn crossed_sides(&self, seen: &Seen, near: f64) -> [bool; 3] {
        let corners = seen.0.map(|at| at.xy());
        let is_outside =
            self.lines.map(|(across, distance)| corners.map(|at| across.dot(at) - distance > near));
        [0, 1, 2].map(|i| {
            let k = (i + 1) % 3;
            if is_outside.iter().any(|corner| corner[i] && corner[k]) || seen.0[i] == seen.0[k] {
                return false;
            }
            let along = corners[k] - corners[i];
            let sides = self.inner.map(|at| along.perp_dot(at - corners[i]));
            let near = near * (along.x.abs() + along.y.abs());
            !(sides.iter().all(|&side| side > near) || sides.iter().all(|&side| side < -near))
        })
    }
}

impl Seen {
    /// Returns the largest height, above or below.
    #[inline]
    pub(super) fn height(&self) -> f64 {
        let [a, b, c] = &self.0;
        a.z.abs().max(b.z.abs()).max(c.z.abs())
    }

    /// Returns the side beyond which the middle of the view is, farthest in proportion; `None` if the
    /// triangle covers it.
    pub(super) fn side_towards_middle(&self) -> Option<usize> {
        let [a, b, c] = self.0.map(|at| at.xy());
        let turn = (b - a).perp_dot(c - a).signum();
        let left = [[a, b], [b, c], [c, a]].map(|[from, to]| turn * from.perp_dot(to - from));
        let least = (0..3).min_by(|&i, &k| left[i].total_cmp(&left[k]))?;
        (left[least] < 0.0).then_some(least)
    }

    /// Returns the part over the inner triangle of a view; `None` if rounding gives it more corners
    /// than there can be.
    pub(super) fn over(&self, view: &View) -> Option<Piece> {
        let mut piece = Piece { corners: [DVec3::ZERO; 6], count: 3 };
        piece.corners[..3].copy_from_slice(&self.0);
        for line in view.lines {
            piece = piece.within(line)?;
        }
        Some(piece)
    }

    /// Returns a point of the inner triangle of a view that this triangle covers: the middle, if that
    /// is not near its sides; `None` if there is none.
    pub(super) fn point_over(&self, view: &View, near: f64) -> Option<DVec2> {
        match self.cover(DVec2::ZERO, near) {
            Some(1 | -1) => Some(DVec2::ZERO),
            _ => self.over(view)?.middle(),
        }
    }

    /// Returns 1 if the triangle covers a point, -1 if it is seen from behind, 0 if it does not
    /// cover it, and `None` if the point is too near its sides to tell.
    #[inline]
    pub(super) fn cover(&self, at: DVec2, near: f64) -> Option<i32> {
        let [a, b, c] = self.0.map(|corner| corner.xy());
        let (least, most) = (a.min(b).min(c), a.max(b).max(c));
        if (least - at).max(at - most).max_element() > near {
            return Some(0);
        }
        let (mut left, mut right) = (0, 0);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let along = to - from;
            let side = along.perp_dot(at - from);
            let near = near * (along.x.abs() + along.y.abs());
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

    /// Returns the corner that is highest, above or below.
    pub(super) fn highest(&self) -> DVec3 {
        let higher = |a: DVec3, b: DVec3| if b.z.abs() > a.z.abs() { b } else { a };
        self.corners().iter().copied().fold(DVec3::ZERO, higher)
    }

    fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// Returns the part on the inner side of a line.
    fn within(&self, (across, distance): (DVec2, f64)) -> Option<Self> {
        let outside = |at: &DVec3| across.dot(at.xy()) - distance;
        let mut inside = Self { corners: [DVec3::ZERO; 6], count: 0 };
        let mut add = |at: DVec3| {
            *inside.corners.get_mut(inside.count)? = at;
            inside.count += 1;
            Some(())
        };
        let corners = self.corners();
        for (i, a) in corners.iter().enumerate() {
            let b = &corners[(i + 1) % corners.len()];
            let [of_a, of_b] = [outside(a), outside(b)];
            if of_a <= 0.0 {
                add(*a)?;
            }
            if (of_a > 0.0) != (of_b > 0.0) {
                add(a.lerp(*b, of_a / (of_a - of_b)))?;
            }
        }
        Some(inside)
    }
}

/// Returns the unit normal of a triangle; `None` if it is too thin.
pub(super) fn normal(&[a, b, c]: &Triangle) -> Option<DVec3> {
    let [ab, ac, bc] = [b - a, c - a, c - b];
    let across = ab.cross(ac);
    let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
    let length = across.length();
    (length > THIN * longest).then(|| across / length)
}
