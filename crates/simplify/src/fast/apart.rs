//! How far a contraction takes the surface away from itself: the two old vertices from the new
//! faces, the new vertex from the old ones.
//!
//! The cost is a mean over planes, and planes do not see the tip of a spike: all of them pass close
//! by its foot. Nor do they see a vertex that slides out along a fin.

use glam::{Vec3, Vec4};

use crate::fast::hood::{Hood, load};
use crate::fast::lanes::{LANES, Lanes3};

/// Keeps a division by nothing from being one.
const TINY: f32 = 1e-30;

impl Hood {
    /// The square of the greatest of the three distances. `place` as seen from v0; the new faces are
    /// those last put.
    #[inline(always)]
    pub(super) fn apart(&self, place: Vec3) -> f32 {
        let beyond = Vec4::splat(f32::INFINITY);
        let (mut of_v0, mut of_v1, mut of_new) = (beyond, beyond, self.above_dying(place));
        let (apex, along) = (Lanes3::all(place), Lanes3::all(self.along));
        let ends = [Lanes3::all(-place), along - apex];
        let mut start = 0;
        while start < self.len {
            let (a, b) = (load(&self.ring, start), load(&self.ring, start + 1));
            let new = Spokes::new(a - apex, b - apex, load(&self.new, start));
            of_v0 = of_v0.min(new.squared(ends[0]));
            of_v1 = of_v1.min(new.squared(ends[1]));
            let old_apex = along.by(Vec4::from_slice(&self.of_v1[start..]));
            let old = Spokes::new(a - old_apex, b - old_apex, load(&self.old, start));
            of_new = of_new.min(old.squared(apex - old_apex));
            start += LANES;
        }
        of_v0.min_element().max(of_v1.min_element()).max(of_new.min_element())
    }

    /// The squares of how far a place is from the dying faces.
    #[inline(always)]
    fn above_dying(&self, place: Vec3) -> Vec4 {
        let (first, last) = self.dying();
        let (wing0, wing1, along) = (self.seen(0), self.seen(self.of_v0), self.along);
        let lanes = |a: Vec3, b: Vec3| Lanes3 {
            x: Vec4::new(a.x, b.x, b.x, b.x),
            y: Vec4::new(a.y, b.y, b.y, b.y),
            z: Vec4::new(a.z, b.z, b.z, b.z),
        };
        Spokes::new(lanes(along, wing1), lanes(wing0, along), lanes(first, last))
            .squared(Lanes3::all(place))
    }
}

/// Four faces with a corner at the origin.
struct Spokes {
    a: Lanes3,
    b: Lanes3,
    normal: Lanes3,
    aa: Vec4,
    bb: Vec4,
    ab: Vec4,
    to_a: Vec4,
    /// The square of the normal, and one over it.
    nn: Vec4,
    to_unit: Vec4,
}

impl Spokes {
    #[inline(always)]
    fn new(a: Lanes3, b: Lanes3, normal: Lanes3) -> Self {
        let (aa, bb, ab, nn) = (a.dot(a), b.dot(b), a.dot(b), normal.dot(normal));
        let tiny = Vec4::splat(TINY);
        let (to_a, to_unit) = ((aa + tiny).recip(), (nn + tiny).recip());
        Self { a, b, normal, aa, bb, ab, to_a, nn, to_unit }
    }

    /// The squares of the distances of a point from them, or from their first edges where it does
    /// not lie over them: the outer edges are left out.
    #[inline(always)]
    fn squared(&self, point: Lanes3) -> Vec4 {
        let (pa, pb) = (point.dot(self.a), point.dot(self.b));
        let (u, v) = (pa * self.bb - pb * self.ab, pb * self.aa - pa * self.ab);
        let zero = Vec4::ZERO;
        let over = u.cmpge(zero) & v.cmpge(zero) & (u + v).cmple(self.nn) & self.nn.cmpgt(zero);
        let height = point.dot(self.normal);
        let t = (pa * self.to_a).max(zero).min(Vec4::ONE);
        let edge = point.dot(point) - t * (pa + pa - t * self.aa);
        Vec4::select(over, height * height * self.to_unit, edge.max(zero))
    }
}
