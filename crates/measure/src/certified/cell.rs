//! Cell of a face, with bounds on its distances from another surface.

use glam::DVec3;
use meshlod_mesh::FaceId;
use meshlod_spatial::{Bvh, Cover, Sheet};

/// Part of the distance at which a cell may be discarded below which a distance need not be the
/// least. CPU time for the dragon and its tenth: 0 5.7 s, .1 5.4, .3 5.0, .5 5.3.
pub(super) const CALM: f64 = 0.3;

/// Multiple of a bound from which on an edge is long.
const MANY: f64 = 8.0;

/// Point with its distance from a surface, and the face of it that is closest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    pub(super) at: DVec3,
    pub(super) distance: f64,
    pub(super) face: FaceId,
}

impl Probe {
    /// Measures the distance of a point from the surface; `hint` is a face thought to be near.
    pub(super) fn new(at: DVec3, surface: &Bvh, hint: Option<FaceId>) -> Self {
        let closest = surface.closest(at.into(), hint);
        Self { at, distance: closest.distance_squared.sqrt(), face: closest.face }
    }

    /// Measures the distance of a point, or takes any that is at most `calm`.
    pub(super) fn near(at: DVec3, surface: &Bvh, hint: Option<FaceId>, calm: f64) -> Self {
        let near = surface.near(at.into(), hint, [calm, f64::INFINITY]);
        let closest = near.expect("there is no limit");
        Self { at, distance: closest.distance_squared.sqrt(), face: closest.face }
    }

    /// Returns the farther of two; the first if they are equally far.
    pub(super) fn farther(self, other: Self) -> Self {
        if other.distance > self.distance { other } else { self }
    }
}

/// Triangle within a face, whose distances from the other surface are at most `upper`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    corners: [Probe; 3],
    pub(super) upper: f64,
}

impl Cell {
    /// Bounds the distances in a triangle from above, no more tightly than `enough` and at most by
    /// `most`.
    pub(super) fn new(corners: [Probe; 3], surface: &Bvh, [enough, most]: [f64; 2]) -> Self {
        let mut cell = Self { corners, upper: most };
        cell.bound_by(cell.by_ways());
        for i in 0..3 {
            let face = corners[i].face;
            if cell.upper > enough && corners[..i].iter().all(|corner| corner.face != face) {
                cell.bound_by_face(face, surface);
            }
        }
        cell
    }

    /// Returns the positions of the corners.
    pub(super) fn corners(&self) -> [[f64; 3]; 3] {
        self.corners.map(|corner| corner.at.to_array())
    }

    /// Measures the middle of the triangle and bounds its distances by the face that is closest
    /// there.
    pub(super) fn probe_middle(&mut self, surface: &Bvh, enough: f64) -> Probe {
        let [a, b, c] = self.corners;
        let at = (a.at + b.at + c.at) / 3.0;
        let middle = Probe::near(at, surface, Some(a.face), CALM * enough);
        let way = self.corners.map(|corner| corner.at.distance(middle.at));
        self.bound_by(middle.distance + way.into_iter().fold(0.0, f64::max));
        self.bound_by_face(middle.face, surface);
        middle
    }

    /// Lowers the bound to that by the faces that lie over the triangle, if that is at most `most`,
    /// and no closer than `enough`; `near` is a face near it, as those at its corners are.
    pub(super) fn bound_by_sheet(
        &mut self,
        near: FaceId,
        sheet: &mut Sheet<'_>,
        [enough, most]: [f64; 2],
    ) {
        let [a, b, c] = self.corners.map(|corner| corner.face);
        if let Cover::Within(bound) = sheet.cover(self.corners(), &[near, a, b, c], [enough, most])
        {
            self.bound_by(bound);
        }
    }

    /// Returns true if it takes many divisions until the ways from the corners alone bound the
    /// distances by `enough`.
    pub(super) fn is_large(&self, enough: f64) -> bool {
        let [a, b, _] = self.longest_edge_first();
        self.upper > enough && a.at.distance(b.at) > MANY * enough
    }

    /// Divides the triangle at the middle of its longest edge. Returns both halves and the middle.
    pub(super) fn halves(&self, surface: &Bvh, enough: f64) -> ([Self; 2], Probe) {
        let [a, b, c] = self.longest_edge_first();
        let middle = Probe::near(a.at.midpoint(b.at), surface, Some(a.face), CALM * enough);
        let half = |corners| Self::new(corners, surface, [enough, self.upper]);
        ([half([a, middle, c]), half([middle, b, c])], middle)
    }

    fn bound_by(&mut self, upper: f64) {
        self.upper = self.upper.min(upper);
    }

    /// Returns a bound by the ways from the corners: distances grow no faster.
    fn by_ways(&self) -> f64 {
        let [a, b, c] = self.corners;
        let squared = [(a, b), (b, c), (c, a)].map(|(p, q)| p.at.distance_squared(q.at));
        let [ab, bc, ca] = squared.map(f64::sqrt);
        let farthest = a.distance.max(b.distance).max(c.distance);
        let from_nearest = farthest + farthest_from_corners(squared);
        let from_one = [(a, ca.max(ab)), (b, ab.max(bc)), (c, bc.max(ca))];
        from_one.into_iter().map(|(corner, way)| corner.distance + way).fold(from_nearest, f64::min)
    }

    /// Lowers the bound to the greatest distance of a corner from one face of the surface, if that is
    /// less. The distance from a triangle is convex, and that from the surface is no greater.
    fn bound_by_face(&mut self, face: FaceId, surface: &Bvh) {
        let most = self.upper * self.upper;
        let mut farthest = 0f64;
        for corner in &self.corners {
            farthest = farthest.max(match corner.face == face {
                true => corner.distance * corner.distance,
                false => surface.distance_squared_to(corner.at.into(), face),
            });
            if farthest >= most {
                return;
            }
        }
        self.upper = farthest.sqrt();
    }

    /// Returns the corners in their order, the first two at the longest edge.
    fn longest_edge_first(&self) -> [Probe; 3] {
        let [a, b, c] = self.corners;
        let [ab, bc, ca] =
            [(a, b), (b, c), (c, a)].map(|(from, to)| from.at.distance_squared(to.at));
        if ab >= bc.max(ca) {
            [a, b, c]
        } else if bc >= ca {
            [b, c, a]
        } else {
            [c, a, b]
        }
    }
}

/// Returns how far a point of a triangle can be from the nearest corner, given the squared sides: the
/// circumradius, or half the longest side if an angle is obtuse.
fn farthest_from_corners([ab, bc, ca]: [f64; 3]) -> f64 {
    let longest = ab.max(bc).max(ca);
    let [p, q] = if longest == ab {
        [bc, ca]
    } else if longest == bc {
        [ab, ca]
    } else {
        [ab, bc]
    };
    let product = (p * q).sqrt();
    let cosine = if product > 0.0 { (p + q - longest) / (2.0 * product) } else { 0.0 };
    let cosine = cosine.clamp(0.0, 0.5);
    longest.sqrt() / (2.0 * (1.0 - cosine * cosine).sqrt())
}
