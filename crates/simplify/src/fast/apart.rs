//! How far a contraction takes the surface away from itself: the two old vertices from the new
//! faces, the new vertex from the old ones.
//!
//! The cost is a mean over planes, and planes do not see the tip of a spike: all of them pass close
//! by its foot. Nor do they see a vertex that slides out along a fin.

use glam::Vec3;

use crate::fast::hood::{Hood, Spokes, row3};
use crate::fast::wide::{LANES, least, most};

/// Keeps a division by nothing from being one.
const TINY: f32 = 1e-30;

impl Hood {
    /// The square of the greatest of the three distances. `place` as seen from v0; the new faces are
    /// those last put.
    #[inline(always)]
    pub(super) fn apart(&self, place: Vec3) -> f32 {
        let beyond = [f32::INFINITY; LANES];
        let (mut of_v0, mut of_v1, mut of_new) = (beyond, beyond, beyond);
        let along = self.along;
        for start in self.starts() {
            let Spokes { a, b, of_v1: at_v1 } = self.spokes(start);
            let (old, new) = (row3(&self.old, start), row3(&self.new, start));
            for lane in 0..LANES {
                let (a, b) = (a.get(lane), b.get(lane));
                let face = Spoke::new(a - place, b - place, new.get(lane));
                of_v0[lane] = least(face.squared(-place), of_v0[lane]);
                of_v1[lane] = least(face.squared(along - place), of_v1[lane]);
                let apex = along * at_v1[lane];
                let face = Spoke::new(a - apex, b - apex, old.get(lane));
                of_new[lane] = least(face.squared(place - apex), of_new[lane]);
            }
        }
        let (first, last) = self.dying();
        let (wing0, wing1) = (self.seen(0), self.seen(self.of_v0));
        of_new[0] = least(Spoke::new(along, wing0, first).squared(place), of_new[0]);
        of_new[0] = least(Spoke::new(wing1, along, last).squared(place), of_new[0]);
        let mut nearest = [of_v0[0], of_v1[0], of_new[0]];
        for lane in 1..LANES {
            nearest[0] = least(of_v0[lane], nearest[0]);
            nearest[1] = least(of_v1[lane], nearest[1]);
            nearest[2] = least(of_new[lane], nearest[2]);
        }
        most(nearest[0], most(nearest[1], nearest[2]))
    }
}

/// A face with a corner at the origin.
struct Spoke {
    a: Vec3,
    normal: Vec3,
    b: Vec3,
    aa: f32,
    bb: f32,
    ab: f32,
    to_a: f32,
    /// The square of the normal, and one over it.
    nn: f32,
    to_unit: f32,
}

impl Spoke {
    #[inline(always)]
    fn new(a: Vec3, b: Vec3, normal: Vec3) -> Self {
        let (aa, bb, ab, nn) = (a.dot(a), b.dot(b), a.dot(b), normal.dot(normal));
        let (to_a, to_unit) = ((aa + TINY).recip(), (nn + TINY).recip());
        Self { a, b, normal, aa, bb, ab, to_a, nn, to_unit }
    }

    /// The square of the distance of a point from it, or from its first edge where it does not lie
    /// over it: the outer edge is left out.
    #[inline(always)]
    fn squared(&self, point: Vec3) -> f32 {
        let (pa, pb) = (point.dot(self.a), point.dot(self.b));
        let (u, v) = (pa * self.bb - pb * self.ab, pb * self.aa - pa * self.ab);
        let is_over = (u >= 0.0) & (v >= 0.0) & (u + v <= self.nn) & (self.nn > 0.0);
        let height = point.dot(self.normal);
        let t = least(most(pa * self.to_a, 0.0), 1.0);
        let edge = most(point.dot(point) - t * (pa + pa - t * self.aa), 0.0);
        if is_over { height * height * self.to_unit } else { edge }
    }
}
