//! Distance by which a contraction moves the surface: from the two old vertices to the new faces,
//! and from the new vertex to the old faces.
//!
//! The cost is a mean over planes, and planes do not see the tip of a spike: all of them pass close
//! to its foot. Nor do they see a vertex that slides out along a fin.

use glam::Vec3;

use crate::kernel::collapse::edge_ring::{EdgeRing, ROOM, Spokes, row3};
use crate::kernel::simd::{LANES, Row, Row3, SimdTask, TINY, select_max, select_min, widest};

impl EdgeRing {
    /// Returns the square of the largest of the three distances. `place` is relative to `v0`; the
    /// new faces are those of the last [`EdgeRing::try_place`].
    #[inline(always)]
    pub(crate) fn deviation(&self, place: Vec3) -> f32 {
        let beyond = [f32::INFINITY; LANES];
        let (mut of_v0, mut of_v1, mut of_new) = (beyond, beyond, beyond);
        let along = self.along;
        for start in self.lane_starts() {
            let Spokes { a, b, of_v1: at_v1 } = self.spokes(start);
            let (old, new) = (row3(&self.old, start), row3(&self.new, start));
            for lane in 0..LANES {
                let (a, b) = (a.get(lane), b.get(lane));
                let face = CornerFace::new(a - place, b - place, new.get(lane));
                of_v0[lane] = select_min(face.squared(-place), of_v0[lane]);
                of_v1[lane] = select_min(face.squared(along - place), of_v1[lane]);
                let apex = along * at_v1[lane];
                let face = CornerFace::new(a - apex, b - apex, old.get(lane));
                of_new[lane] = select_min(face.squared(place - apex), of_new[lane]);
            }
        }
        for [a, b, normal] in self.dying_faces() {
            of_new[0] = select_min(CornerFace::new(a, b, normal).squared(place), of_new[0]);
        }
        let mut nearest = [of_v0[0], of_v1[0], of_new[0]];
        for lane in 1..LANES {
            nearest[0] = select_min(of_v0[lane], nearest[0]);
            nearest[1] = select_min(of_v1[lane], nearest[1]);
            nearest[2] = select_min(of_new[lane], nearest[2]);
        }
        select_max(nearest[0], select_max(nearest[1], nearest[2]))
    }

    /// Returns the squared distance of a position from each old face: the spokes first, then the
    /// dying faces.
    pub(crate) fn squared_distances_to_old(&self, place: Vec3) -> [f32; ROOM] {
        let mut squares = [0.0; ROOM];
        for start in self.lane_starts() {
            let (Spokes { a, b, of_v1 }, old) = (self.spokes(start), row3(&self.old, start));
            for lane in 0..LANES {
                let apex = self.along * of_v1[lane];
                let (a, b) = (a.get(lane) - apex, b.get(lane) - apex);
                squares[start + lane] =
                    CornerFace::new(a, b, old.get(lane)).squared_of_all(place - apex);
            }
        }
        for (square, [a, b, normal]) in squares[self.len..].iter_mut().zip(self.dying_faces()) {
            *square = CornerFace::new(a, b, normal).squared_of_all(place);
        }
        squares
    }

    /// Returns the largest squared distance of a position from the planes of the old faces that
    /// stay.
    pub(crate) fn off_planes(&self, place: Vec3) -> f32 {
        let mut farthest = 0.0;
        for start in self.lane_starts() {
            let (old, of_v1) = (row3(&self.old, start), self.spokes(start).of_v1);
            for lane in 0..LANES {
                let normal = old.get(lane);
                let height = normal.dot(place - self.along * of_v1[lane]);
                let to_unit = (normal.dot(normal) + TINY).recip();
                farthest = select_max(height * height * to_unit, farthest);
            }
        }
        farthest
    }

    /// Returns the dying faces: two corners relative to `v0`, and the normal.
    #[inline(always)]
    fn dying_faces(&self) -> [[Vec3; 3]; 2] {
        let (first, last) = self.dying_normals();
        [[self.along, self.relative(0), first], [self.relative(self.of_v0), self.along, last]]
    }
}

/// Faces around an edge, laid out for distance queries of many points.
#[derive(Default)]
pub(crate) struct FaceFan {
    rows: Vec<FaceRows>,
    /// Least and greatest coordinates of all corners, relative to `v0`.
    extent: [Vec3; 2],
}

/// Eight faces: the apex relative to `v0`, and what [`CornerFace`] knows of each.
struct FaceRows {
    apex: Row3,
    a: Row3,
    b: Row3,
    normal: Row3,
    aa: Row,
    bb: Row,
    ab: Row,
    to_a: Row,
    nn: Row,
    to_unit: Row,
}

impl FaceFan {
    /// Lays out the faces with the new vertex, from the last [`EdgeRing::try_place`]. `place` is
    /// relative to `v0`.
    pub(crate) fn lay_new(&mut self, edge_ring: &EdgeRing, place: Vec3) {
        self.clear([place; 2]);
        self.lay(edge_ring, &edge_ring.new, |_| place);
    }

    /// Lays out the old faces, including those that the contraction removes.
    pub(crate) fn lay_old(&mut self, edge_ring: &EdgeRing) {
        self.clear([Vec3::ZERO.min(edge_ring.along), Vec3::ZERO.max(edge_ring.along)]);
        self.lay(edge_ring, &edge_ring.old, |of_v1| edge_ring.along * of_v1);
        let [first, last] = edge_ring.dying_faces();
        // A face that is there twice is as near as once.
        let face = |lane| if lane == 0 { first } else { last };
        self.rows.push(FaceRows::new(|lane| (Vec3::ZERO, face(lane))));
    }

    fn clear(&mut self, extent: [Vec3; 2]) {
        self.rows.clear();
        self.extent = extent;
    }

    fn lay(
        &mut self,
        edge_ring: &EdgeRing,
        normals: &[[f32; ROOM]; 3],
        apex: impl Fn(f32) -> Vec3,
    ) {
        for start in edge_ring.lane_starts() {
            let (Spokes { a, b, of_v1 }, normal) = (edge_ring.spokes(start), row3(normals, start));
            self.rows.push(FaceRows::new(|lane| {
                let apex = apex(of_v1[lane]);
                (apex, [a.get(lane) - apex, b.get(lane) - apex, normal.get(lane)])
            }));
        }
        let [least, most] = &mut self.extent;
        for i in 0..edge_ring.len {
            (*least, *most) = (least.min(edge_ring.relative(i)), most.max(edge_ring.relative(i)));
        }
    }

    /// Returns true if all faces are farther than this from a point given relative to `v0`; `squared`
    /// is a squared distance. Not always if they are.
    #[inline]
    pub(crate) fn is_far_from(&self, point: Vec3, squared: f32) -> bool {
        let [least, most] = self.extent;
        let apart = (least - point).max(point - most).max(Vec3::ZERO);
        apart.length_squared() > FAR * squared
    }

    /// Returns the squared distance from the faces to a point given relative to `v0`.
    #[inline]
    pub(crate) fn squared(&self, point: Vec3) -> f32 {
        widest(NearestInFan { rows: &self.rows, point })
    }
}

/// Factor on a squared distance that leaves room for rounding.
const FAR: f32 = 1.0001;

/// SIMD task of [`FaceFan::squared`].
struct NearestInFan<'f> {
    rows: &'f [FaceRows],
    point: Vec3,
}

impl SimdTask for NearestInFan<'_> {
    type Output = f32;

    #[inline(always)]
    fn work(self) -> f32 {
        let mut nearest = [f32::INFINITY; LANES];
        for rows in self.rows {
            for lane in 0..LANES {
                let (face, point) = (rows.face(lane), self.point - rows.apex.get(lane));
                let squared = select_min(face.squared(point), face.squared_of_rim(point));
                nearest[lane] = select_min(squared, nearest[lane]);
            }
        }
        nearest.into_iter().fold(f32::INFINITY, select_min)
    }
}

impl FaceRows {
    /// Lays out faces given by apex, the other corners relative to it, and normal.
    #[inline(always)]
    fn new(faces: impl Fn(usize) -> (Vec3, [Vec3; 3])) -> Self {
        let none = [0.0; LANES];
        let [apex, a, b, normal] = [Row3::ZERO; 4];
        let [aa, bb, ab, to_a, nn, to_unit] = [none; 6];
        let mut rows = Self { apex, a, b, normal, aa, bb, ab, to_a, nn, to_unit };
        for lane in 0..LANES {
            let (apex, [a, b, normal]) = faces(lane);
            let face = CornerFace::new(a, b, normal);
            rows.apex.set(lane, apex);
            rows.a.set(lane, a);
            rows.b.set(lane, b);
            rows.normal.set(lane, normal);
            (rows.aa[lane], rows.bb[lane], rows.ab[lane]) = (face.aa, face.bb, face.ab);
            (rows.to_a[lane], rows.nn[lane], rows.to_unit[lane]) =
                (face.to_a, face.nn, face.to_unit);
        }
        rows
    }

    #[inline(always)]
    fn face(&self, lane: usize) -> CornerFace {
        CornerFace {
            a: self.a.get(lane),
            b: self.b.get(lane),
            normal: self.normal.get(lane),
            aa: self.aa[lane],
            bb: self.bb[lane],
            ab: self.ab[lane],
            to_a: self.to_a[lane],
            nn: self.nn[lane],
            to_unit: self.to_unit[lane],
        }
    }
}

/// A face with a corner at the origin.
struct CornerFace {
    a: Vec3,
    normal: Vec3,
    b: Vec3,
    aa: f32,
    bb: f32,
    ab: f32,
    to_a: f32,
    /// Square of the normal. `to_unit` is its inverse.
    nn: f32,
    to_unit: f32,
}

impl CornerFace {
    #[inline(always)]
    fn new(a: Vec3, b: Vec3, normal: Vec3) -> Self {
        let (aa, bb, ab, nn) = (a.dot(a), b.dot(b), a.dot(b), normal.dot(normal));
        let (to_a, to_unit) = ((aa + TINY).recip(), (nn + TINY).recip());
        Self { a, b, normal, aa, bb, ab, to_a, nn, to_unit }
    }

    /// Returns the squared distance of a point from the face, or from its first edge if the point
    /// is not over the face. The outer edge is left out.
    #[inline(always)]
    fn squared(&self, point: Vec3) -> f32 {
        let (pa, pb) = (point.dot(self.a), point.dot(self.b));
        let (u, v) = (pa * self.bb - pb * self.ab, pb * self.aa - pa * self.ab);
        let is_over = (u >= 0.0) & (v >= 0.0) & (u + v <= self.nn) & (self.nn > 0.0);
        let height = point.dot(self.normal);
        let t = select_min(select_max(pa * self.to_a, 0.0), 1.0);
        let edge = select_max(point.dot(point) - t * (pa + pa - t * self.aa), 0.0);
        if is_over { height * height * self.to_unit } else { edge }
    }

    /// Returns the squared distance of a point from the whole face.
    #[inline(always)]
    fn squared_of_all(&self, point: Vec3) -> f32 {
        let pb = point.dot(self.b);
        let t = select_min(select_max(pb * (self.bb + TINY).recip(), 0.0), 1.0);
        let second = select_max(point.dot(point) - t * (pb + pb - t * self.bb), 0.0);
        select_min(select_min(self.squared(point), second), self.squared_of_rim(point))
    }

    /// Returns the squared distance of a point from the outer edge; infinite if the face has no
    /// area.
    #[inline(always)]
    fn squared_of_rim(&self, point: Vec3) -> f32 {
        let (along, from_a) = (self.b - self.a, point - self.a);
        let t = from_a.dot(along) * (along.dot(along) + TINY).recip();
        let apart = from_a - along * select_min(select_max(t, 0.0), 1.0);
        if self.nn > 0.0 { apart.dot(apart) } else { f32::INFINITY }
    }
}
