//! Triangle fan around a vertex whose position is not fixed yet, with closest-point queries.

use glam::DVec3;

/// Triangles from a centre to the edges of a ring, and the feature edges among the spokes.
#[derive(Default)]
pub(crate) struct Fan {
    centre: DVec3,
    spokes: Vec<Triangle>,
    rims: Vec<Rim>,
}

/// A spoke of the fan that is a boundary edge or a seam.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rim {
    /// Index in the ring of its other end.
    pub(crate) place: u32,
    /// Position of the spoke's other end.
    pub(crate) end: DVec3,
    /// Index of one of the faces at the spoke.
    pub(crate) spoke: u32,
}

/// Triangle of the fan, with what a projection onto it needs.
#[derive(Clone, Copy)]
struct Triangle {
    /// Corners other than the centre.
    ends: [DVec3; 2],
    /// Those corners relative to the centre.
    legs: [DVec3; 2],
    /// Unit normal; zero for a sliver.
    normal: DVec3,
    /// Squared lengths of the legs.
    lengths: [f64; 2],
    /// Rows that map a point to its coefficients of the legs: the inverse of their Gram matrix.
    inverse: [DVec3; 2],
}

/// Squared sine of the angle at the centre below which a face is treated as its edges only.
const SLIVER: f64 = 1e-12;

/// Closest point of a triangle fan to a query point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// Vector from the closest point to the query point.
    pub(crate) off: DVec3,
    /// Squared length of `off`.
    pub(crate) squared: f64,
    /// Barycentric weight of the centre in the closest point: 1 at the centre, 0 on the ring.
    pub(crate) weight: f64,
    /// Index of the face that contains the closest point.
    pub(crate) spoke: usize,
    /// Rim edge that contains it, if it had to be on one.
    pub(crate) rim: Option<usize>,
}

impl Fan {
    pub(crate) fn clear(&mut self) {
        self.spokes.clear();
        self.rims.clear();
    }

    /// Adds the triangle between the centre and the next edge of the ring.
    pub(crate) fn add_spoke(&mut self, ends: [DVec3; 2]) {
        self.spokes.push(Triangle::new(ends, self.centre));
    }

    pub(crate) fn add_rim(&mut self, rim: Rim) {
        self.rims.push(rim);
    }

    pub(crate) fn rims(&self) -> &[Rim] {
        &self.rims
    }

    /// Moves the centre of the fan.
    pub(crate) fn place(&mut self, centre: DVec3) {
        self.centre = centre;
        for triangle in &mut self.spokes {
            *triangle = Triangle::new(triangle.ends, centre);
        }
    }

    /// Returns the sum of the squared lengths of the spokes, for a closed ring.
    pub(crate) fn squared_lengths(&self) -> f64 {
        self.spokes.iter().map(|triangle| 0.5 * triangle.lengths.iter().sum::<f64>()).sum()
    }

    /// Returns the unit normal of a face; zero for a sliver.
    #[inline]
    pub(crate) fn normal(&self, spoke: usize) -> DVec3 {
        self.spokes[spoke].normal
    }

    /// Returns the point of the fan nearest to `x`, restricted to the rim if `on_rim` is set and
    /// there is a rim.
    #[inline]
    pub(crate) fn nearest(&self, x: DVec3, on_rim: bool) -> Nearest {
        let from = x - self.centre;
        let mut nearest =
            Nearest { off: DVec3::ZERO, squared: f64::INFINITY, weight: 0.0, spoke: 0, rim: None };
        if on_rim && !self.rims.is_empty() {
            for (i, rim) in self.rims.iter().enumerate() {
                let spoke = rim.spoke as usize;
                let (off, along) = to_segment(from, rim.end - self.centre);
                nearest.offer(off, 1.0 - along, spoke, Some(i));
            }
            return nearest;
        }
        for (spoke, triangle) in self.spokes.iter().enumerate() {
            triangle.offer(from, spoke, &mut nearest);
        }
        nearest
    }
}

impl Nearest {
    #[inline]
    fn offer(&mut self, off: DVec3, weight: f64, spoke: usize, rim: Option<usize>) {
        let squared = off.length_squared();
        if squared < self.squared {
            *self = Self { off, squared, weight, spoke, rim };
        }
    }
}

impl Triangle {
    fn new(ends: [DVec3; 2], centre: DVec3) -> Self {
        let legs = ends.map(|end| end - centre);
        let [a, b] = legs;
        let (aa, ab, bb) = (a.length_squared(), a.dot(b), b.length_squared());
        let cross = a.cross(b);
        let squared = cross.length_squared();
        let upright = squared > SLIVER * aa * bb;
        let normal = if upright { cross / squared.sqrt() } else { DVec3::ZERO };
        let inverse = [(a * bb - b * ab) / squared, (b * aa - a * ab) / squared];
        Self { ends, legs, normal, lengths: [aa, bb], inverse }
    }

    /// Offers the triangle's point nearest to `from`, which is relative to the centre.
    ///
    /// If the projection falls outside, the nearest point is on one of the edges that it lies
    /// beyond.
    #[inline]
    fn offer(&self, from: DVec3, spoke: usize, nearest: &mut Nearest) {
        let [a, b] = self.legs;
        let sliver = self.normal == DVec3::ZERO;
        let [s, t] = self.inverse.map(|row| row.dot(from));
        if s >= 0.0 && t >= 0.0 && s + t <= 1.0 && !sliver {
            nearest.offer(self.normal * self.normal.dot(from), 1.0 - s - t, spoke, None);
            return;
        }
        if t < 0.0 || sliver {
            let (off, along) = to_segment(from, a);
            nearest.offer(off, 1.0 - along, spoke, None);
        }
        if s < 0.0 || sliver {
            let (off, along) = to_segment(from, b);
            nearest.offer(off, 1.0 - along, spoke, None);
        }
        if s + t > 1.0 || sliver {
            let (off, _) = to_segment(from - a, b - a);
            nearest.offer(off, 0.0, spoke, None);
        }
    }
}

/// Returns the vector to `x` from the nearest point of the segment from the origin to `end`, and
/// that point's parameter.
#[inline]
fn to_segment(x: DVec3, end: DVec3) -> (DVec3, f64) {
    let along = x.dot(end) / end.length_squared();
    let along = if along.is_finite() { along.clamp(0.0, 1.0) } else { 0.0 };
    (x - end * along, along)
}
