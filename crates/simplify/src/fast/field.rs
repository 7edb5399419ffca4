//! What the faces around a wedge expect of its attributes, summed so that an edge asks its two ends
//! only.
//!
//! An attribute is linear over a face: at *x* from the wedge it is *a + g·x*. All faces around agree on
//! *a*, the wedge's own value; so seen from there a star is, by squares of areas *w* as the geometry's,
//! *W* = Σ *w*, *B* = Σ *w g* for each channel and *G* = Σ *w g g'* over all of them. A vertex at *x*
//! with the value *a + δ* is off by *x'Gx* − 2 *δ B·x* + *W δ²* [Hop99].

use glam::{DMat3, DVec3, Vec3, Vec4};

use crate::fast::lanes::{LANES, Lanes3, transpose};
use crate::fast::looks::Parts;
use crate::fast::place::{Swept, symmetric};

/// Keeps a division by nothing from being one.
pub(super) const TINY: f32 = 1e-30;

/// The sums of a star, in whole registers.
///
/// ```text
/// G.xx G.yy G.zz G.xy | G.xz G.yz W 0 | of each channel: B.x B.y B.z a
/// ```
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Field<const K: usize> {
    pub(super) squares: [Vec4; 2],
    pub(super) channels: [Vec4; K],
}

impl<const K: usize> Field<K> {
    pub(super) const EMPTY: Self = Self { squares: [Vec4::ZERO; 2], channels: [Vec4::ZERO; K] };

    /// A wedge of these values that has no faces yet.
    pub(super) fn of_values(values: [f32; K]) -> Self {
        let mut field = Self::EMPTY;
        for (channel, value) in field.channels.iter_mut().zip(values) {
            channel.w = value;
        }
        field
    }

    /// One face, its corners at the origin, `a` and `b`, where the channels are `to_a` and `to_b`
    /// more; it comes to the same from every corner.
    #[inline(always)]
    pub(super) fn face(a: Vec3, b: Vec3, to_a: [f32; K], to_b: [f32; K]) -> Self {
        let normal = a.cross(b);
        let weight = normal.length_squared();
        let (along_a, along_b) = (b.cross(normal).extend(0.0), normal.cross(a).extend(0.0));
        let mut field = Self::EMPTY;
        for (k, channel) in field.channels.iter_mut().enumerate() {
            let slope = along_a * to_a[k] + along_b * to_b[k];
            let [x, y, z, _] = slope.to_array();
            field.squares[0] += Vec4::new(x, y, z, x) * Vec4::new(x, y, z, y);
            field.squares[1] += Vec4::new(x, y, 0.0, 0.0) * Vec4::new(z, z, 0.0, 0.0);
            *channel = slope;
        }
        let scale = 1.0 / (weight + TINY);
        field.squares[0] *= scale;
        field.squares[1] *= scale;
        field.squares[1].z = weight;
        field
    }

    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        self.squares[0] += other.squares[0];
        self.squares[1] += other.squares[1];
        for (channel, other) in self.channels.iter_mut().zip(&other.channels) {
            *channel += *other;
        }
    }

    #[inline(always)]
    pub(super) fn take(&mut self, other: &Self) {
        self.squares[0] -= other.squares[0];
        self.squares[1] -= other.squares[1];
        for (channel, other) in self.channels.iter_mut().zip(&other.channels) {
            *channel -= *other;
        }
    }

    #[inline(always)]
    pub(super) fn weight(&self) -> f32 {
        self.squares[1].z
    }

    /// Its values; only of what is at a wedge, not of one face.
    #[inline(always)]
    pub(super) fn values(&self) -> [f32; K] {
        let mut values = [0.0; K];
        for (value, channel) in values.iter_mut().zip(&self.channels) {
            *value = channel.w;
        }
        values
    }

    /// G: xx, yy, zz, xy, xz, yz.
    #[inline(always)]
    pub(super) fn squares(&self) -> [f32; 6] {
        let [a, b] = &self.squares;
        [a.x, a.y, a.z, a.w, b.x, b.y]
    }

    fn matrix(&self) -> DMat3 {
        symmetric(self.squares())
    }

    /// What it costs if the wedge goes to a place `by` further, and takes the values there.
    pub(super) fn onto(&self, by: Vec3, values: &Self) -> f32 {
        let by4 = by.extend(0.0);
        let squares = by.as_dvec3().dot(self.matrix() * by.as_dvec3()) as f32;
        let each = self.channels.iter().zip(&values.channels).map(|(own, other)| {
            let change = other.w - own.w;
            change * (self.weight() * change - 2.0 * own.dot(by4))
        });
        squares + each.sum::<f32>()
    }
}

/// The G of four ends.
#[inline(always)]
pub(super) fn squares_of<const K: usize>(ends: &[&Field<K>; LANES]) -> ([Vec4; 6], Vec4) {
    let row = |k: usize| {
        transpose(ends[0].squares[k], ends[1].squares[k], ends[2].squares[k], ends[3].squares[k])
    };
    let ([xx, yy, zz, xy], [xz, yz, weight, _]) = (row(0), row(1));
    ([xx, yy, zz, xy, xz, yz], weight)
}

/// What the best value of each channel leaves of four edges' squares, beside the G: seen from the
/// middle they are x'Sx − 2 q·x + c, and this adds to S, q and c. The ends are at −h and h.
#[inline(always)]
pub(super) fn join<const K: usize>(
    own: &Field<K>,
    ends: &[&Field<K>; LANES],
    weights: Vec4,
    h: Lanes3,
    Parts { sum, slope, at_middle }: Parts<'_>,
) {
    let own_weight = Vec4::splat(own.weight());
    let weight = own_weight + weights;
    let less_weight = own_weight - weights;
    let share = (weight + Vec4::splat(TINY)).recip();
    for k in 0..K {
        let own = own.channels[k];
        let [x, y, z, value] = transpose(
            ends[0].channels[k],
            ends[1].channels[k],
            ends[2].channels[k],
            ends[3].channels[k],
        );
        let (ours, theirs) = (Lanes3::all(own.truncate()), Lanes3 { x, y, z });
        let (both, less) = (ours + theirs, ours - theirs);
        let change = (value - Vec4::splat(own.w)) * 0.5;
        let off = less.dot(h) - less_weight * change;
        let part = both.by(share);
        sum[0] -= both.x * part.x;
        sum[1] -= both.y * part.y;
        sum[2] -= both.z * part.z;
        sum[3] -= both.x * part.y;
        sum[4] -= both.x * part.z;
        sum[5] -= both.y * part.z;
        *slope = *slope + less.by(change) + part.by(off);
        *at_middle += change * (weight * change - both.dot(h) * 2.0) - off * off * share;
    }
}

/// The same for one edge, in doubles, G with it.
pub(super) fn join_one<const K: usize>(swept: &mut Swept, v0: &Field<K>, v1: &Field<K>) {
    let h = swept.half;
    let (g0, g1) = (v0.matrix(), v1.matrix());
    let [w0, w1] = [v0, v1].map(|v| f64::from(v.weight()));
    let weight = w0 + w1;
    swept.sum += g0 + g1;
    swept.slope += (g1 - g0) * h;
    swept.at_middle += h.dot((g0 + g1) * h);
    for (c0, c1) in v0.channels.iter().zip(&v1.channels) {
        let Meeting { both, less, change, off } = Meeting::new(*c0, *c1, [w0, w1], h);
        let part = both / (weight + f64::from(TINY));
        swept.sum -= DMat3::from_cols(both * part.x, both * part.y, both * part.z);
        swept.slope += less * change + part * off;
        swept.at_middle += change * (weight * change - 2.0 * both.dot(h));
        swept.at_middle -= off * off / (weight + f64::from(TINY));
    }
}

/// The values that fit best at `x` from the middle of an edge.
pub(super) fn best_values<const K: usize>(
    v0: &Field<K>,
    v1: &Field<K>,
    h: DVec3,
    x: DVec3,
) -> [f32; K] {
    let weights = [v0, v1].map(|v| f64::from(v.weight()));
    let weight = weights[0] + weights[1];
    let mut values = [0.0; K];
    for (k, value) in values.iter_mut().enumerate() {
        let (c0, c1) = (v0.channels[k], v1.channels[k]);
        let Meeting { both, off, .. } = Meeting::new(c0, c1, weights, h);
        let middle = 0.5 * (f64::from(c0.w) + f64::from(c1.w));
        *value = (middle + (both.dot(x) + off) / (weight + f64::from(TINY))) as f32;
    }
    values
}

/// A channel of two wedges that become one.
struct Meeting {
    both: DVec3,
    less: DVec3,
    /// Half the change along the edge.
    change: f64,
    /// How far the best value in the middle is from the mean, times the weight.
    off: f64,
}

impl Meeting {
    #[inline(always)]
    fn new(c0: Vec4, c1: Vec4, [w0, w1]: [f64; 2], h: DVec3) -> Self {
        let (b0, b1) = (c0.truncate().as_dvec3(), c1.truncate().as_dvec3());
        let change = 0.5 * (f64::from(c1.w) - f64::from(c0.w));
        let less = b0 - b1;
        Self { both: b0 + b1, less, change, off: less.dot(h) - (w0 - w1) * change }
    }
}
