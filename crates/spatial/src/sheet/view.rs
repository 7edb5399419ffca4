//! Triangles seen along a direction.

use glam::{DVec2, DVec3, Vec3Swizzles};

use crate::Triangle;

/// Sine of an angle of a triangle below which its plane is not trusted: coordinates that were rounded
/// to 32 bits turn it.
const THIN: f64 = 1e-6;

/// Part of a triangle by which it is shrunk at most.
const MOST_SHRUNK: f64 = 0.9;

/// Weights of the corners at the point that is counted: no simple fractions, so that edges of regular
/// grids do not pass through it.
const INSIDE: [f64; 3] = [0.311_830_913, 0.367_387_944, 0.320_781_143];

/// Rounding of a coordinate in the hierarchy's frame, in which the mesh is about 4 wide.
pub(super) const ROUNDING: f64 = 64.0 * f64::EPSILON;

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

/// How a seen triangle and the inner one of the view lie over each other.
pub(super) struct Overlap<'s> {
    seen: &'s Seen,
    inner: &'s [DVec2; 3],
    /// Distance of each corner beyond each line of the inner triangle: lines, then corners.
    beyond: [[f64; 3]; 3],
    /// Twice the area, signed, between each side and each corner of the inner triangle, and its
    /// rounding.
    left: [[f64; 3]; 3],
    near: [f64; 3],
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
    #[inline(always)]
    pub(super) fn see(&self, triangle: &Triangle) -> Seen {
        let [x, y, z] = self.axes;
        let see = |at: DVec3| {
            let at = at - self.origin;
            DVec3::new(at.dot(x), at.dot(y), at.dot(z))
        };
        let [a, b, c] = *triangle;
        Seen([see(a), see(b), see(c)])
    }

    /// Compares a seen triangle with the inner one.
    #[inline(always)]
    pub(super) fn compare<'s>(&'s self, seen: &'s Seen) -> Overlap<'s> {
        let (mut beyond, mut left, mut near) = ([[0.0; 3]; 3], [[0.0; 3]; 3], [0.0; 3]);
        for i in 0..3 {
            let (across, distance) = self.lines[i];
            let from = seen.0[i].xy();
            let along = seen.0[NEXT[i]].xy() - from;
            for k in 0..3 {
                beyond[i][k] = across.dot(seen.0[k].xy()) - distance;
                left[i][k] = along.perp_dot(self.inner[k] - from);
            }
            near[i] = ROUNDING * (along.x.abs() + along.y.abs());
        }
        Overlap { seen, inner: &self.inner, beyond, left, near }
    }
}

/// The next corner of a triangle.
const NEXT: [usize; 3] = [1, 2, 0];

impl Seen {
    /// Returns the largest height, above or below.
    #[inline(always)]
    pub(super) fn height(&self) -> f64 {
        let [a, b, c] = &self.0;
        a.z.abs().max(b.z.abs()).max(c.z.abs())
    }

    /// Returns the side beyond which the middle of the view is, farthest in proportion; `None` if the
    /// triangle covers it.
    #[inline(always)]
    pub(super) fn side_towards_middle(&self) -> Option<usize> {
        let [a, b, c] = [self.0[0].xy(), self.0[1].xy(), self.0[2].xy()];
        let turn = (b - a).perp_dot(c - a).signum();
        let left = [a.perp_dot(b - a), b.perp_dot(c - b), c.perp_dot(a - c)];
        let (mut least, mut side) = (0.0, None);
        for (i, left) in left.into_iter().enumerate() {
            if turn * left < least {
                (least, side) = (turn * left, Some(i));
            }
        }
        side
    }
}

impl Overlap<'_> {
    /// Returns which sides cross the inner triangle, or come near it. A side without length does not.
    #[inline(always)]
    pub(super) fn crossed_sides(&self) -> [bool; 3] {
        let Self { seen: Seen(corners), beyond, left, near, .. } = self;
        let mut is_crossed = [false; 3];
        for i in 0..3 {
            let k = NEXT[i];
            let is_outside = |line: &[f64; 3]| (line[i] > ROUNDING) & (line[k] > ROUNDING);
            let is_outside =
                is_outside(&beyond[0]) | is_outside(&beyond[1]) | is_outside(&beyond[2]);
            let [a, b, c] = left[i];
            let (least, most) = (a.min(b).min(c), a.max(b).max(c));
            let is_beside = (least > near[i]) | (most < -near[i]);
            is_crossed[i] = !is_outside & !is_beside & (corners[i] != corners[k]);
        }
        is_crossed
    }

    /// Returns 1 if the triangle covers a point inside the inner one, -1 if it is seen from behind,
    /// 0 if it does not cover it, and `None` if the point is too near its sides to tell.
    #[inline(always)]
    pub(super) fn cover(&self) -> Option<i32> {
        let (mut above, mut below) = (0, 0);
        for i in 0..3 {
            let [a, b, c] = self.left[i];
            let left = INSIDE[0] * a + INSIDE[1] * b + INSIDE[2] * c;
            above += i32::from(left > self.near[i]);
            below += i32::from(left < -self.near[i]);
        }
        match (above, below) {
            (3, _) => Some(1),
            (_, 3) => Some(-1),
            (1.., 1..) => Some(0),
            _ => self.is_apart().then_some(0),
        }
    }

    /// Returns true if all corners are beyond one line of the inner triangle.
    fn is_apart(&self) -> bool {
        self.beyond.iter().any(|line| line.iter().all(|&at| at > ROUNDING))
    }

    /// Returns a highest point, above or below, of the part over the inner triangle: a corner of either
    /// triangle, or a place where their sides cross.
    ///
    /// Where a side runs along one of the inner triangle to within rounding, a crossing may be missed.
    /// The face across that side is as high there: of all faces that cross each other's sides over the
    /// triangle, the highest is not below the true one, up to rounding.
    pub(super) fn highest(&self) -> DVec3 {
        let Seen(corners) = self.seen;
        let is_inside = |at: [f64; 3]| at.into_iter().all(|beyond| beyond <= ROUNDING);
        let mut highest = DVec3::ZERO;
        let mut add = |at: DVec3| {
            if at.z.abs() > highest.z.abs() {
                highest = at;
            }
        };
        for (k, &corner) in corners.iter().enumerate() {
            if is_inside(self.beyond.map(|line| line[k])) {
                add(corner);
            }
        }
        for line in &self.beyond {
            for (i, k) in [(0, 1), (1, 2), (2, 0)] {
                if (line[i] > 0.0) == (line[k] > 0.0) {
                    continue;
                }
                let part = line[i] / (line[i] - line[k]);
                let between = |from: f64, to: f64| from + (to - from) * part;
                if is_inside(self.beyond.map(|line| between(line[i], line[k]))) {
                    let room = ROUNDING / (line[i] - line[k]).abs();
                    add(raised(
                        corners[i].lerp(corners[k], part),
                        [corners[i].z, corners[k].z],
                        room,
                    ));
                }
            }
        }
        for of_inner in 0..3 {
            let weights = [1, 2, 0].map(|side: usize| self.left[side][of_inner]);
            let near = [1, 2, 0].map(|side: usize| self.near[side]);
            let is_over =
                (0..3).all(|k| weights[k] >= -near[k]) || (0..3).all(|k| weights[k] <= near[k]);
            if is_over {
                let [a, b, c] = [0, 1, 2].map(|k| corners[k].z);
                let sum: f64 = weights.iter().sum();
                let z = (a * weights[0] + b * weights[1] + c * weights[2]) / sum;
                let heights = [a.min(b).min(c), a.max(b).max(c)];
                let room = near.iter().sum::<f64>() / sum.abs();
                add(raised(self.inner[of_inner].extend(z), heights, room));
            }
        }
        highest
    }
}

/// Raises a point between two heights by this part of their difference, but not beyond them.
fn raised(at: DVec3, [a, b]: [f64; 2], part: f64) -> DVec3 {
    let most = a.abs().max(b.abs());
    let height = (at.z.abs() + part * (b - a).abs()).min(most);
    at.with_z(if height.is_nan() { most } else { height })
}

/// Returns the unit normal of a triangle; `None` if it is too thin.
pub(super) fn normal(&[a, b, c]: &Triangle) -> Option<DVec3> {
    let [ab, ac, bc] = [b - a, c - a, c - b];
    let across = ab.cross(ac);
    let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
    let length = across.length();
    (length > THIN * longest).then(|| across / length)
}
