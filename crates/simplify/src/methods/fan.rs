//! The faces around a vertex that is yet to be placed, and what of them is nearest to a point.

use glam::DVec3;

/// The faces from a centre to the edges of a ring, and the rims among the edges from the centre.
#[derive(Default)]
pub(crate) struct Fan {
    centre: DVec3,
    spokes: Vec<Triangle>,
    rims: Vec<Rim>,
}

/// An edge from the centre that is a boundary edge or a seam.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rim {
    /// Its other end, by place in the ring.
    pub(crate) place: u32,
    /// Where that is.
    pub(crate) end: DVec3,
    /// One of its faces.
    pub(crate) spoke: u32,
}

/// A face, with what a projection onto it wants.
#[derive(Clone, Copy)]
struct Triangle {
    /// The corners after the centre.
    ends: [DVec3; 2],
    /// The same from the centre.
    legs: [DVec3; 2],
    /// Unit normal; zero for a sliver.
    normal: DVec3,
    /// Squared lengths of the legs.
    lengths: [f64; 2],
    /// What weighs the legs, given as products with the legs: the inverse of their Gram matrix.
    inverse: [DVec3; 2],
}

/// Squared sine of the angle at the centre below which a face is all edges.
const SLIVER: f64 = 1e-12;

/// The point of a fan nearest to another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// From it to the other.
    pub(crate) off: DVec3,
    /// The square of that.
    pub(crate) squared: f64,
    /// How much of the centre is in it: 1 there, 0 on the ring.
    pub(crate) weight: f64,
    /// The face that it is on.
    pub(crate) spoke: usize,
    /// The rim that it is on, if it was to be on one.
    pub(crate) rim: Option<usize>,
}

impl Fan {
    pub(crate) fn clear(&mut self) {
        self.spokes.clear();
        self.rims.clear();
    }

    /// Adds the face to an edge of the ring; in order.
    pub(crate) fn add_spoke(&mut self, ends: [DVec3; 2]) {
        self.spokes.push(Triangle::new(ends, self.centre));
    }

    pub(crate) fn add_rim(&mut self, rim: Rim) {
        self.rims.push(rim);
    }

    pub(crate) fn rims(&self) -> &[Rim] {
        &self.rims
    }

    /// Puts the centre somewhere else.
    pub(crate) fn place(&mut self, centre: DVec3) {
        self.centre = centre;
        for triangle in &mut self.spokes {
            *triangle = Triangle::new(triangle.ends, centre);
        }
    }

    /// The sum of the squared lengths of the edges from the centre, of a closed ring.
    pub(crate) fn squared_lengths(&self) -> f64 {
        self.spokes.iter().map(|triangle| 0.5 * triangle.lengths.iter().sum::<f64>()).sum()
    }

    /// The unit normal of a face; zero for a sliver.
    #[inline]
    pub(crate) fn normal(&self, spoke: usize) -> DVec3 {
        self.spokes[spoke].normal
    }

    /// The point nearest to `x`; on a rim where it must be and there is one.
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

    /// Offers its point nearest to `from`, seen from the centre.
    ///
    /// Where the projection falls outside, that is on an edge that it is beyond.
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

/// From the nearest point of the segment from the origin to `end` to `x`, and how far along it is.
#[inline]
fn to_segment(x: DVec3, end: DVec3) -> (DVec3, f64) {
    let along = x.dot(end) / end.length_squared();
    let along = if along.is_finite() { along.clamp(0.0, 1.0) } else { 0.0 };
    (x - end * along, along)
}
