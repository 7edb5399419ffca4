//! Where the new vertex goes: the least of the squares on the plane of equal volumes, in doubles.

use glam::{DMat3, DVec3};

use crate::fast::cost::PULL;
use crate::fast::vertex::Star;

/// What a contraction sweeps, seen from the middle of its edge.
#[derive(Clone, Copy)]
pub(super) struct Swept {
    /// Half the edge.
    pub(super) half: DVec3,
    /// The sum of the stars' squares, each face once.
    pub(super) sum: DMat3,
    /// What the squares have along the edge: (A₁ − A₀)h.
    pub(super) slope: DVec3,
    /// The squares in the middle.
    pub(super) at_middle: f64,
    /// The sum of n over the faces, each once.
    pub(super) normal: DVec3,
    /// `normal`·x where the volume stays.
    pub(super) level: f64,
}

impl Swept {
    /// The squares there.
    #[inline(always)]
    pub(super) fn at(&self, x: DVec3) -> f64 {
        x.dot(self.sum * x) - 2.0 * self.slope.dot(x) + self.at_middle
    }

    /// The sum of the faces' weights.
    pub(super) fn weight(&self) -> f64 {
        self.sum.x_axis.x + self.sum.y_axis.y + self.sum.z_axis.z
    }

    /// The best place; not a number where there is none.
    #[inline(always)]
    pub(super) fn best(&self) -> DVec3 {
        let squared = self.normal.length_squared();
        if squared <= f64::MIN_POSITIVE {
            return DVec3::ZERO;
        }
        let up = self.normal / squared.sqrt();
        let on_plane = self.normal * (self.level / squared);
        let (e1, e2) = up.any_orthonormal_pair();
        let pull = f64::from(PULL) * self.weight();
        let (a1, a2) = (self.sum * e1, self.sum * e2);
        let (m11, m12, m22) = (e1.dot(a1) + pull, e1.dot(a2), e2.dot(a2) + pull);
        let slope = self.slope - self.sum * on_plane;
        let (r1, r2) = (e1.dot(slope), e2.dot(slope));
        let determinant = m11 * m22 - m12 * m12;
        if determinant <= 0.0 {
            return on_plane;
        }
        on_plane
            + e1 * ((m22 * r1 - m12 * r2) / determinant)
            + e2 * ((m11 * r2 - m12 * r1) / determinant)
    }
}

/// The sum of n n'.
#[inline(always)]
pub(super) fn matrix(star: &Star) -> DMat3 {
    symmetric(star.squares())
}

/// The matrix of xx, yy, zz, xy, xz, yz.
#[inline(always)]
pub(super) fn symmetric([xx, yy, zz, xy, xz, yz]: [f32; 6]) -> DMat3 {
    let column = |x: f32, y: f32, z: f32| DVec3::new(x.into(), y.into(), z.into());
    DMat3::from_cols(column(xx, xy, xz), column(xy, yy, yz), column(xz, yz, zz))
}
