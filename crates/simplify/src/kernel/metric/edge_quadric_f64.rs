//! The quadric of one edge in f64, from which the place of the new vertex is computed.

use glam::{DMat3, DVec3};

use crate::kernel::mesh::vertex::VertexQuadric;
use crate::kernel::metric::edge_quadric::PULL;

/// Quadric of an edge relative to its middle, x'Sx − 2 q·x + c, and the plane of equal volume.
#[derive(Clone, Copy)]
pub(crate) struct EdgeQuadricF64 {
    /// Half of the edge vector.
    pub(crate) half: DVec3,
    /// S.
    pub(crate) sum: DMat3,
    /// q.
    pub(crate) slope: DVec3,
    /// c.
    pub(crate) at_middle: f64,
    /// Sum of the normals of the faces, each face once.
    pub(crate) normal: DVec3,
    /// Value of `normal`·x where the volume is preserved.
    pub(crate) level: f64,
}

impl EdgeQuadricF64 {
    /// Evaluates the quadric at a place relative to the middle.
    #[inline(always)]
    pub(crate) fn at(&self, x: DVec3) -> f64 {
        x.dot(self.sum * x) - 2.0 * self.slope.dot(x) + self.at_middle
    }

    /// Adds the quadric of another edge between the same two places.
    pub(crate) fn with(&self, other: &Self) -> Self {
        Self {
            half: self.half,
            sum: self.sum + other.sum,
            slope: self.slope + other.slope,
            at_middle: self.at_middle + other.at_middle,
            normal: self.normal + other.normal,
            level: self.level + other.level,
        }
    }

    /// Returns where the quadric is smallest, relative to the middle; the middle if there are no
    /// planes.
    #[inline(always)]
    pub(crate) fn minimum(&self) -> DVec3 {
        let pull = f64::from(PULL) * self.weight();
        if pull <= f64::MIN_POSITIVE {
            return DVec3::ZERO;
        }
        (self.sum + DMat3::from_diagonal(DVec3::splat(pull))).inverse() * self.slope
    }

    /// Returns the sum of the faces' weights.
    pub(crate) fn weight(&self) -> f64 {
        self.sum.x_axis.x + self.sum.y_axis.y + self.sum.z_axis.z
    }
}

/// Returns the matrix of a vertex quadric.
#[inline(always)]
pub(crate) fn matrix(star: &VertexQuadric) -> DMat3 {
    symmetric(star.squares())
}

/// Returns the matrix of xx, yy, zz, xy, xz, yz.
#[inline(always)]
pub(crate) fn symmetric([xx, yy, zz, xy, xz, yz]: [f32; 6]) -> DMat3 {
    let column = |x: f32, y: f32, z: f32| DVec3::new(x.into(), y.into(), z.into());
    DMat3::from_cols(column(xx, xy, xz), column(xy, yy, yz), column(xz, yz, zz))
}
