//! Quadrics: weighted squared distances to planes [GH97], relative to a point of the surface.
//!
//! A quadric is stored relative to its vertex, not to the world's origin. The planes around a
//! vertex pass through it, so the sums stay small and nothing cancels, wherever the model is.

use std::ops::{Add, Mul};

use glam::{DMat3, DVec3};

/// Determinant of a matrix of trace 1 above which it counts as invertible.
const DETERMINED: f64 = 1e-10;

/// Symmetric 3 × 3 matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Symmetric {
    /// xx, yy, zz.
    diagonal: DVec3,
    /// yz, zx, xy.
    off_diagonal: DVec3,
}

impl Add for Symmetric {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            diagonal: self.diagonal + other.diagonal,
            off_diagonal: self.off_diagonal + other.off_diagonal,
        }
    }
}

impl Mul<f64> for Symmetric {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self { diagonal: self.diagonal * factor, off_diagonal: self.off_diagonal * factor }
    }
}

impl Symmetric {
    /// Returns the outer product n n'.
    #[inline]
    pub(crate) fn outer(n: DVec3) -> Self {
        Self { diagonal: n * n, off_diagonal: DVec3::new(n.y * n.z, n.z * n.x, n.x * n.y) }
    }

    /// Returns the identity matrix times `factor`.
    #[inline]
    pub(crate) fn scalar(factor: f64) -> Self {
        Self { diagonal: DVec3::splat(factor), off_diagonal: DVec3::ZERO }
    }

    #[inline]
    pub(crate) fn trace(&self) -> f64 {
        self.diagonal.element_sum()
    }

    /// Returns the matrix times `x`.
    #[inline]
    pub(crate) fn apply(&self, x: DVec3) -> DVec3 {
        let o = self.off_diagonal;
        self.diagonal * x
            + DVec3::new(o.z * x.y + o.y * x.z, o.z * x.x + o.x * x.z, o.y * x.x + o.x * x.y)
    }

    #[inline]
    pub(crate) fn determinant(&self) -> f64 {
        let (d, o) = (self.diagonal, self.off_diagonal);
        d.element_product() + 2.0 * o.element_product() - (d * o * o).element_sum()
    }

    /// Returns PAP, where A is the matrix and P the projection along the unit vector `n`.
    #[inline]
    pub(crate) fn within(&self, n: DVec3) -> Self {
        let an = self.apply(n);
        // PAP = A − n(An)' − (An)n' + (n·An) nn'.
        let half = an - n * (0.5 * n.dot(an));
        Self {
            diagonal: self.diagonal - 2.0 * n * half,
            off_diagonal: self.off_diagonal
                - DVec3::new(
                    n.y * half.z + n.z * half.y,
                    n.z * half.x + n.x * half.z,
                    n.x * half.y + n.y * half.x,
                ),
        }
    }

    /// Solves matrix · x = `right` for x; the result is not finite if the matrix is singular.
    #[inline]
    pub(crate) fn solve(&self, right: DVec3) -> DVec3 {
        // The determinant is a cubic in the entries. Scaling by a power of two keeps it in range
        // and changes no digit.
        let unit = 1.0 / f64::from_bits(self.trace().to_bits() & f64::INFINITY.to_bits());
        let (d, o, right) = (self.diagonal * unit, self.off_diagonal * unit, right * unit);
        // The matrix is symmetric, so the rows of the adjugate are cross products of the columns.
        let (x, y, z) =
            (DVec3::new(d.x, o.z, o.y), DVec3::new(o.z, d.y, o.x), DVec3::new(o.y, o.x, d.z));
        let (yz, zx, xy) = (y.cross(z), z.cross(x), x.cross(y));
        DMat3::from_cols(yz, zx, xy) * right / x.dot(yz)
    }
}

/// Quadratic function Q(x) = x'Ax + 2b·x + c with its weight, where x is an offset from the
/// quadric's origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Quadric {
    a: Symmetric,
    b: DVec3,
    c: f64,
    /// Sum of the planes' weights: with areas as weights, Q / weight is a mean squared distance.
    weight: f64,
}

impl Add for Quadric {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            a: self.a + other.a,
            b: self.b + other.b,
            c: self.c + other.c,
            weight: self.weight + other.weight,
        }
    }
}

impl Mul<f64> for Quadric {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self {
            a: self.a * factor,
            b: self.b * factor,
            c: self.c * factor,
            weight: self.weight * factor,
        }
    }
}

impl Quadric {
    /// Returns the squared distance to the plane through the origin with this unit normal, times
    /// `weight`.
    #[inline]
    pub(crate) fn plane(normal: DVec3, weight: f64) -> Self {
        Self { a: Symmetric::outer(normal) * weight, weight, ..Self::default() }
    }

    /// Returns the quadric of a face through the origin, given its normal of twice its area,
    /// weighted by its area; zero for a face without area.
    #[inline]
    pub(crate) fn face(area_normal: DVec3) -> Self {
        let twice_area = area_normal.length();
        if twice_area > 0.0 {
            Self::plane(area_normal / twice_area, 0.5 * twice_area)
        } else {
            Self::default()
        }
    }

    /// Returns x'Ax + 2b·x + c with the trace of A as weight.
    #[inline]
    pub(crate) fn new(a: Symmetric, b: DVec3, c: f64) -> Self {
        Self { a, b, c, weight: a.trace() }
    }

    /// Returns (`normal`·x − `level`)² as a quadric.
    #[inline]
    pub(crate) fn squared_plane(normal: DVec3, level: f64) -> Self {
        Self::new(Symmetric::outer(normal), -level * normal, level * level)
    }

    /// Returns (x − from)'A(x − from) as a quadric.
    #[inline]
    pub(crate) fn squared(a: Symmetric, from: DVec3) -> Self {
        Self::new(a, DVec3::ZERO, 0.0).seen_from(-from)
    }

    /// Returns the quadric with weight zero, so that it does not count in the mean.
    #[inline]
    pub(crate) fn as_constraint(self) -> Self {
        Self { weight: 0.0, ..self }
    }

    /// Adds `weight` times the square of offset + slope·x, without adding to the weight of the
    /// mean.
    #[inline]
    pub(crate) fn add_linear(&mut self, slope: DVec3, offset: f64, weight: f64) {
        self.a = self.a + Symmetric::outer(slope) * weight;
        self.b += slope * (weight * offset);
        self.c += weight * offset * offset;
    }

    /// Returns the quadric plus a constant.
    #[inline]
    pub(crate) fn raised(self, by: f64) -> Self {
        Self { c: self.c + by, ..self }
    }

    /// Returns the quadric relative to an origin moved by `offset`.
    #[inline]
    pub(crate) fn seen_from(self, offset: DVec3) -> Self {
        let ax = self.a.apply(offset);
        Self { b: self.b + ax, c: self.c + (2.0 * self.b + ax).dot(offset), ..self }
    }

    /// Evaluates Q at an offset, clamped at zero because rounding can make it slightly negative.
    #[inline]
    pub(crate) fn at(&self, x: DVec3) -> f64 {
        let value = (self.a.apply(x) + 2.0 * self.b).dot(x) + self.c;
        if value < 0.0 { 0.0 } else { value }
    }

    /// Returns the value of this quadric that corresponds to a mean squared distance.
    #[inline]
    pub(crate) fn mean_of(&self, squared: f64) -> f64 {
        self.weight * squared
    }

    /// Returns the root mean squared distance that a value of this quadric corresponds to.
    #[inline]
    pub(crate) fn distance(&self, value: f64) -> f64 {
        if self.weight > 0.0 { (value / self.weight).sqrt() } else { 0.0 }
    }

    /// Returns the offset at which Q is least; `None` if the planes leave it undetermined.
    pub(crate) fn minimum(&self) -> Option<DVec3> {
        let unit = self.a.trace();
        let is_determined = self.a.determinant() > DETERMINED * unit * unit * unit;
        is_determined.then(|| self.a.solve(-self.b)).filter(|x| x.is_finite())
    }

    /// Returns the offset at which Q + `pull`·trace(A)·|x − toward|² is least.
    ///
    /// The pull matters only where the planes leave the point free, along a flat or an edge, and
    /// keeps the system well conditioned there, without a rank decision or a special case.
    #[inline]
    pub(crate) fn optimum(&self, toward: DVec3, pull: f64) -> DVec3 {
        let spring = pull * self.a.trace();
        if spring <= f64::MIN_POSITIVE {
            return toward;
        }
        let solution = (self.a + Symmetric::scalar(spring)).solve(toward * spring - self.b);
        if solution.is_finite() { solution } else { toward }
    }

    /// Returns the t at which the pulled function of [`Self::optimum`] is least on the line `start`
    /// + t·`direction`.
    #[inline]
    pub(crate) fn least_along(
        &self,
        start: DVec3,
        direction: DVec3,
        toward: DVec3,
        pull: f64,
    ) -> f64 {
        let spring = pull * self.a.trace();
        let slope = self.a.apply(start) + self.b + spring * (start - toward);
        let bend = self.a.apply(direction) + spring * direction;
        -slope.dot(direction) / bend.dot(direction)
    }

    /// Returns the optimum of [`Self::optimum`] restricted to the plane `normal`·x = `level`, or
    /// unrestricted if that is not a plane.
    ///
    /// Across the plane the function is replaced by a stiff one, so that one system of three
    /// unknowns solves the problem of two.
    #[inline]
    pub(crate) fn optimum_on(&self, normal: DVec3, level: f64, toward: DVec3, pull: f64) -> DVec3 {
        let length = normal.length();
        let (n, trace) = (normal / length, self.a.trace());
        let start = toward + n * (level / length - n.dot(toward));
        let spring = pull * trace;
        if !start.is_finite() {
            return self.optimum(toward, pull);
        }
        if spring <= f64::MIN_POSITIVE {
            return start;
        }
        let slope = self.a.apply(start) + self.b;
        let within = self.a.within(n) + Symmetric::outer(n) * trace + Symmetric::scalar(spring);
        let step = within.solve(n * slope.dot(n) - slope);
        // Rounding must not change the volume.
        let step = step - n * step.dot(n);
        if step.is_finite() { start + step } else { start }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner() -> Quadric {
        Quadric::plane(DVec3::X, 1.0)
            + Quadric::plane(DVec3::Y, 2.0)
            + Quadric::plane(DVec3::Z, 3.0)
    }

    #[test]
    fn measures_squared_distance_to_a_plane() {
        let n = DVec3::new(1.0, 2.0, 2.0) / 3.0;
        let quadric = Quadric::plane(n, 4.0);
        assert!((quadric.at(n * 0.5 + DVec3::new(2.0, -1.0, 0.0)) - 1.0).abs() < 1e-15);
        assert!((quadric.distance(1.0) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn is_the_same_function_from_elsewhere() {
        let (quadric, offset) = (corner(), DVec3::new(0.3, -2.0, 5.0));
        let x = DVec3::new(1.0, 2.0, 3.0);
        assert!((quadric.seen_from(offset).at(x - offset) - quadric.at(x)).abs() < 1e-12);
    }

    #[test]
    fn finds_the_corner_where_three_planes_meet() {
        let quadric = corner().seen_from(DVec3::new(1.0, 2.0, 3.0));
        let found = quadric.optimum(DVec3::ZERO, 1e-9);
        assert!((found - DVec3::new(-1.0, -2.0, -3.0)).length() < 1e-6);
    }

    #[test]
    fn three_planes_determine_a_minimum_and_two_do_not() {
        let found = corner().seen_from(DVec3::new(1.0, 2.0, 3.0)).minimum().unwrap();
        assert!((found - DVec3::new(-1.0, -2.0, -3.0)).length() < 1e-12);
        let diagonal = DVec3::new(1.0, 1.0, 0.0).normalize();
        let edge = Quadric::plane(diagonal, 1.0) + Quadric::plane(DVec3::X, 2.0);
        assert_eq!(edge.minimum(), None);
        assert_eq!(Quadric::default().minimum(), None);
    }

    #[test]
    fn on_a_flat_it_stays_where_it_is_pulled() {
        let flat = Quadric::plane(DVec3::Z, 1.0);
        let toward = DVec3::new(7.0, -3.0, 0.0);
        assert!((flat.optimum(toward, 1e-6) - toward).length() < 1e-9);
        assert_eq!(Quadric::default().optimum(toward, 1e-6), toward);
    }
}
