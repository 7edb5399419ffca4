//! The attribute quadric [Hop99] of a wedge: the error against the linear attributes of the faces
//! around, summed such that an edge needs only its two ends.
//!
//! An attribute is linear over a face: *a + g·x* at *x* from the wedge. All faces around have the
//! wedge's own value *a* in common. Relative to the wedge, with the weights *w* of the geometry,
//! the sums are *W* = Σ *w*, *B* = Σ *w g* for each channel and *G* = Σ *w g g'* over all channels.
//! A vertex at *x* with the value *a + δ* has the error *x'Gx* − 2 *δ B·x* + *W δ²*.

use glam::{DMat3, DVec3, Vec3, Vec4};

use crate::kernel::metric::Metric;
use crate::kernel::metric::edge_quadric::{
    EdgeQuadric, EdgeQuadrics, EdgeSide, SymmetricMatrix, lane_of,
};
use crate::kernel::metric::edge_quadric_f64::{EdgeQuadricF64, symmetric};
use crate::kernel::simd::{LANES, Row, TINY};

/// Attribute quadric of a wedge, in whole registers.
///
/// ```text
/// G.xx G.yy G.zz G.xy | G.xz G.yz W 0 | for each channel: B.x B.y B.z a
/// ```
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct AttributeQuadric<const K: usize> {
    pub(crate) squares: [Vec4; 2],
    pub(crate) channels: [Vec4; K],
}

impl<const K: usize> AttributeQuadric<K> {
    pub(crate) const EMPTY: Self = Self { squares: [Vec4::ZERO; 2], channels: [Vec4::ZERO; K] };

    /// Returns the quadric of a wedge that has these attribute values and no faces yet.
    pub(crate) fn of_values(values: [f32; K]) -> Self {
        let mut quadric = Self::EMPTY;
        for (channel, value) in quadric.channels.iter_mut().zip(values) {
            channel.w = value;
        }
        quadric
    }

    /// Returns the quadric of one face with corners at the origin, `a` and `b`; `to_a` and `to_b`
    /// are the differences of the channels. It is the same from every corner.
    #[inline(always)]
    pub(crate) fn face<M: Metric>(a: Vec3, b: Vec3, to_a: [f32; K], to_b: [f32; K]) -> Self {
        let normal = a.cross(b);
        let (weight, per_square) = M::face_weight(normal.length_squared());
        let (along_a, along_b) = (b.cross(normal).extend(0.0), normal.cross(a).extend(0.0));
        let mut quadric = Self::EMPTY;
        for (k, channel) in quadric.channels.iter_mut().enumerate() {
            let slope = (along_a * to_a[k] + along_b * to_b[k]) * per_square;
            let [x, y, z, _] = slope.to_array();
            quadric.squares[0] += Vec4::new(x, y, z, x) * Vec4::new(x, y, z, y);
            quadric.squares[1] += Vec4::new(x, y, 0.0, 0.0) * Vec4::new(z, z, 0.0, 0.0);
            *channel = slope;
        }
        let scale = 1.0 / (weight + TINY);
        quadric.squares[0] *= scale;
        quadric.squares[1] *= scale;
        quadric.squares[1].z = weight;
        quadric
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, other: &Self) {
        self.squares[0] += other.squares[0];
        self.squares[1] += other.squares[1];
        for (channel, other) in self.channels.iter_mut().zip(&other.channels) {
            *channel += *other;
        }
    }

    #[inline(always)]
    pub(crate) fn take(&mut self, other: &Self) {
        self.squares[0] -= other.squares[0];
        self.squares[1] -= other.squares[1];
        for (channel, other) in self.channels.iter_mut().zip(&other.channels) {
            *channel -= *other;
        }
    }

    #[inline(always)]
    pub(crate) fn weight(&self) -> f32 {
        self.squares[1].z
    }

    /// Returns the attribute values of the wedge. They mean nothing in the quadric of a single
    /// face.
    #[inline(always)]
    pub(crate) fn values(&self) -> [f32; K] {
        let mut values = [0.0; K];
        for (value, channel) in values.iter_mut().zip(&self.channels) {
            *value = channel.w;
        }
        values
    }

    /// Returns the matrix G of the quadric, the sum over all channels: xx, yy, zz, xy, xz, yz.
    #[inline(always)]
    pub(crate) fn squares(&self) -> [f32; 6] {
        let [a, b] = &self.squares;
        [a.x, a.y, a.z, a.w, b.x, b.y]
    }

    fn matrix(&self) -> DMat3 {
        symmetric(self.squares())
    }

    /// Returns the cost of moving the wedge by `by` and giving it these attribute values.
    pub(crate) fn cost_onto(&self, by: Vec3, values: &[f32; K]) -> f32 {
        let by4 = by.extend(0.0);
        let squares = by.as_dvec3().dot(self.matrix() * by.as_dvec3()) as f32;
        let each = self.channels.iter().zip(values).map(|(own, value)| {
            let change = value - own.w;
            change * (self.weight() * change - 2.0 * own.dot(by4))
        });
        squares + each.sum::<f32>()
    }

    /// Returns the attribute values with the least error at `by` from the wedge.
    pub(crate) fn best_values(&self, by: DVec3) -> [f32; K] {
        let share = 1.0 / f64::from(self.weight() + TINY);
        self.channels.map(|own| own.w + (own.truncate().as_dvec3().dot(by) * share) as f32)
    }
}

/// Adds the attribute error that remains with the best value of each channel to the quadrics x'Sx −
/// 2 q·x + c of eight edges.
#[inline(always)]
pub(crate) fn add_attribute_quadrics<'f, const K: usize>(
    sides: [EdgeSide<u32>; 2],
    quadric: impl Fn(u32) -> &'f AttributeQuadric<K>,
    edges: &mut EdgeQuadrics,
) {
    add_all_channels::<K, false>(sides, quadric, edges, &mut [0.0; LANES]);
}

/// Adds the attribute error as [`add_attribute_quadrics`] does. Also adds to `onto` the cost of
/// contracting each second end onto the first, with the first end's values.
#[inline(always)]
pub(crate) fn add_attribute_quadrics_and_onto<'f, const K: usize>(
    sides: [EdgeSide<u32>; 2],
    quadric: impl Fn(u32) -> &'f AttributeQuadric<K>,
    edges: &mut EdgeQuadrics,
    onto: &mut Row,
) {
    add_all_channels::<K, true>(sides, quadric, edges, onto);
}

#[inline(always)]
fn add_all_channels<'f, const K: usize, const ONTO: bool>(
    sides: [EdgeSide<u32>; 2],
    quadric: impl Fn(u32) -> &'f AttributeQuadric<K>,
    edges: &mut EdgeQuadrics,
    onto: &mut Row,
) {
    let [first, second] = sides.map(|side| side.map(&quadric));
    let squares_of = |side: EdgeSide<&AttributeQuadric<K>>| {
        let row = |k: usize| side.map(|quadric| quadric.squares[k]).rows();
        let ([xx, yy, zz, xy], [xz, yz, weights, _]) = (row(0), row(1));
        ([xx, yy, zz, xy, xz, yz], weights)
    };
    let (g0, w0) = squares_of(first);
    let (g1, w1) = squares_of(second);
    for lane in 0..LANES {
        let h = edges.half.get(lane);
        let (g0, g1) = (SymmetricMatrix(lane_of(&g0, lane)), SymmetricMatrix(lane_of(&g1, lane)));
        let (g0h, g1h) = (g0.apply(h), g1.apply(h));
        for (sum, (g0, g1)) in edges.sum.iter_mut().zip(g0.0.into_iter().zip(g1.0)) {
            sum[lane] += g0 + g1;
        }
        edges.slope.set(lane, edges.slope.get(lane) + (g1h - g0h));
        edges.at_middle[lane] += (g0h + g1h).dot(h);
        if ONTO {
            onto[lane] += 4.0 * g1h.dot(h);
        }
    }
    for k in 0..K {
        let channel =
            |side: EdgeSide<&AttributeQuadric<K>>| side.map(|quadric| quadric.channels[k]).rows();
        let channels = [channel(first), channel(second)];
        add_channel(&channels, [&w0, &w1], edges);
        if ONTO {
            channel_onto(&channels, &w1, edges, onto);
        }
    }
}

/// Adds one channel to the quadrics.
#[inline(always)]
fn add_channel([c0, c1]: &[[Row; 4]; 2], [w0, w1]: [&Row; 2], edges: &mut EdgeQuadrics) {
    for lane in 0..LANES {
        let h = edges.half.get(lane);
        let (b0, b1) = (slope_of(c0, lane), slope_of(c1, lane));
        let (both, less) = (b0 + b1, b0 - b1);
        let weight = w0[lane] + w1[lane];
        let share = (weight + TINY).recip();
        let change = (c1[3][lane] - c0[3][lane]) * 0.5;
        let off = less.dot(h) - (w0[lane] - w1[lane]) * change;
        let part = both * share;
        let [xx, yy, zz, xy, xz, yz] = &mut edges.sum;
        xx[lane] -= both.x * part.x;
        yy[lane] -= both.y * part.y;
        zz[lane] -= both.z * part.z;
        xy[lane] -= both.x * part.y;
        xz[lane] -= both.x * part.z;
        yz[lane] -= both.y * part.z;
        edges.slope.set(lane, edges.slope.get(lane) + less * change + part * off);
        let square = weight * change - both.dot(h) * 2.0;
        edges.at_middle[lane] += change * square - off * off * share;
    }
}

/// Adds the cost of one channel for contracting the second end onto the first.
#[inline(always)]
fn channel_onto([c0, c1]: &[[Row; 4]; 2], w1: &Row, edges: &EdgeQuadrics, onto: &mut Row) {
    for lane in 0..LANES {
        let change = c0[3][lane] - c1[3][lane];
        let along = slope_of(c1, lane).dot(edges.half.get(lane));
        onto[lane] += change * (w1[lane] * change + 4.0 * along);
    }
}

#[inline(always)]
fn slope_of([x, y, z, _]: &[Row; 4], lane: usize) -> Vec3 {
    Vec3::new(x[lane], y[lane], z[lane])
}

/// Returns the quadric, with the best values, of a wedge that moves alone. `from` is its place
/// relative to the middle of the edge.
pub(crate) fn unpaired_quadric<const K: usize>(
    quadric: &AttributeQuadric<K>,
    from: Vec3,
) -> EdgeQuadric {
    let share = 1.0 / (quadric.weight() + TINY);
    let mut squares = quadric.squares();
    for channel in &quadric.channels {
        let [x, y, z, _] = channel.to_array();
        let [px, py, pz] = [x * share, y * share, z * share];
        let products = [x * px, y * py, z * pz, x * py, x * pz, y * pz];
        for (square, product) in squares.iter_mut().zip(products) {
            *square -= product;
        }
    }
    let sum = SymmetricMatrix(squares);
    let slope = sum.apply(from);
    EdgeQuadric { sum, slope, at_middle: from.dot(slope) }
}

/// Adds the attribute error of a pair of wedges to the quadric of one edge, in f64.
pub(crate) fn add_pair_f64<const K: usize>(
    quadric: &mut EdgeQuadricF64,
    v0: &AttributeQuadric<K>,
    v1: &AttributeQuadric<K>,
) {
    let h = quadric.half;
    let (g0, g1) = (v0.matrix(), v1.matrix());
    let [w0, w1] = [v0, v1].map(|v| f64::from(v.weight()));
    let weight = w0 + w1;
    quadric.sum += g0 + g1;
    quadric.slope += (g1 - g0) * h;
    quadric.at_middle += h.dot((g0 + g1) * h);
    for (c0, c1) in v0.channels.iter().zip(&v1.channels) {
        let PairedChannel { both, less, change, off } = PairedChannel::new(*c0, *c1, [w0, w1], h);
        let part = both / (weight + f64::from(TINY));
        quadric.sum -= DMat3::from_cols(both * part.x, both * part.y, both * part.z);
        quadric.slope += less * change + part * off;
        quadric.at_middle += change * (weight * change - 2.0 * both.dot(h));
        quadric.at_middle -= off * off / (weight + f64::from(TINY));
    }
}

/// Adds the attribute error of a wedge that moves alone to the quadric of one edge, in f64. `from`
/// is its place relative to the middle.
pub(crate) fn add_unpaired_f64<const K: usize>(
    edge: &mut EdgeQuadricF64,
    wedge: &AttributeQuadric<K>,
    from: DVec3,
) {
    let share = 1.0 / f64::from(wedge.weight() + TINY);
    let mut squares = wedge.matrix();
    for channel in &wedge.channels {
        let b = channel.truncate().as_dvec3();
        let part = b * share;
        squares -= DMat3::from_cols(b * part.x, b * part.y, b * part.z);
    }
    edge.sum += squares;
    edge.slope += squares * from;
    edge.at_middle += from.dot(squares * from);
}

/// Returns the values of a merged pair that fit best at `x` from the middle of the edge.
pub(crate) fn best_values<const K: usize>(
    v0: &AttributeQuadric<K>,
    v1: &AttributeQuadric<K>,
    h: DVec3,
    x: DVec3,
) -> [f32; K] {
    let weights = [v0, v1].map(|v| f64::from(v.weight()));
    let weight = weights[0] + weights[1];
    let mut values = [0.0; K];
    for (k, value) in values.iter_mut().enumerate() {
        let (c0, c1) = (v0.channels[k], v1.channels[k]);
        let PairedChannel { both, off, .. } = PairedChannel::new(c0, c1, weights, h);
        let middle = 0.5 * (f64::from(c0.w) + f64::from(c1.w));
        *value = (middle + (both.dot(x) + off) / (weight + f64::from(TINY))) as f32;
    }
    values
}

/// One channel of two wedges that become one.
struct PairedChannel {
    both: DVec3,
    less: DVec3,
    /// Half the change of the value along the edge.
    change: f64,
    /// Difference of the best value at the middle from the mean of both, times the weight.
    off: f64,
}

impl PairedChannel {
    #[inline(always)]
    fn new(c0: Vec4, c1: Vec4, [w0, w1]: [f64; 2], h: DVec3) -> Self {
        let (b0, b1) = (c0.truncate().as_dvec3(), c1.truncate().as_dvec3());
        let change = 0.5 * (f64::from(c1.w) - f64::from(c0.w));
        let less = b0 - b1;
        Self { both: b0 + b1, less, change, off: less.dot(h) - (w0 - w1) * change }
    }
}
