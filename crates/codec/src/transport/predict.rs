//! Prediction of vertex positions and of the spread around them, for four blocks at a time.
//!
//! The prediction is a parallelogram [TG98] corrected by weighted features of its surroundings. It
//! is more certain across the surface than along it. Each number is one lane of four, so that the
//! processor works on four blocks at once. All operations are `f32` sums, products and quotients,
//! each rounded by itself: the results are the same on every machine, whichever blocks are side by
//! side.

use glam::{BVec4A, Mat4, Vec3A, Vec4};

use super::gate::Gate;
use super::lanes::{LANES, LastAxis, Vec3x4};
use super::models::{CLASSES, Models};

/// Point or vector, in cells.
pub(super) type CellVec = Vec3A;

/// Upper limit of cell coordinates.
pub(super) const MAX_CELLS: i32 = 1 << 21;

pub(super) const FEATURES: usize = 5;
/// Number of kinds of gates.
pub(super) const GATES: usize = 5 * 4;

impl Gate {
    /// Returns the kind of the gate, by the numbers of known faces at its ends.
    #[inline(always)]
    pub(super) fn kind(&self) -> usize {
        let a = usize::from(self.faces_a.clamp(1, 5)) - 1;
        let b = usize::from(self.faces_b.clamp(1, 4)) - 1;
        4 * a + b
    }
}

/// Minimum variance, for the rounding of positions. Of .1 to .3, .15 takes the fewest bytes.
const FLOOR: f32 = 0.15;
/// Weight of a new vertex in the spread scale: .08 and .125 take as much, .18 and .06 some
/// thousandths more.
const GAIN: f32 = 0.1;

/// Geometry around the gates of all lanes.
struct GateGeometry {
    corner: Vec3x4,
    /// Vectors added to the corner by weights. In a regular mesh all but the first two are zero.
    features: [Vec3x4; FEATURES],
    /// Normal of the surface, of any length.
    normal: Vec3x4,
    /// Sum of the squared sides of the known face on the gate, plus 1.
    sides: Vec4,
}

impl GateGeometry {
    #[inline(always)]
    fn new(gates: &[Gate; LANES], at: impl Fn(usize, u16) -> Vec4) -> Self {
        let four = |of: fn(&Gate) -> u16| {
            let [a, b, c, d] = gates;
            Vec3x4::new([at(0, of(a)), at(1, of(b)), at(2, of(c)), at(3, of(d))])
        };
        let (a, b) = (four(|gate| gate.a), four(|gate| gate.b));
        let (apex, previous_apex) = (four(|gate| gate.apex), four(|gate| gate.previous_apex));
        let (previous, next) = (four(|gate| gate.previous), four(|gate| gate.next));
        let (edge, spoke, rim) = (b - a, apex - a, apex - b);
        Self {
            corner: b - spoke,
            features: [
                b - spoke - apex,
                edge,
                // The error of the previous parallelogram.
                (b - spoke) - (a + a - previous_apex),
                next - b + rim,
                previous - a + spoke,
            ],
            normal: edge.cross(spoke) + spoke.cross(previous_apex - a),
            sides: edge.dot(edge) + spoke.dot(spoke) + rim.dot(rim) + Vec4::ONE,
        }
    }
}

/// Running ratio of observed to modelled variances; an update takes effect one vertex later.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpreadScales {
    now: [Vec4; 2],
    next: [Vec4; 2],
}

/// Predicted normal distribution of a vertex in each lane, factored into one conditional
/// distribution per axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Predictions {
    mean: Vec3x4,
    /// Means in coding order. The axis closest to the normal is last, and nearly certain by then.
    turns: [Vec4; 3],
    /// Dependence of the second axis on the first, and of the third on both.
    second: Vec4,
    third: [Vec4; 2],
    /// Variances in coding order.
    variances: [Vec4; 3],
    last: LastAxis,
    normal: Vec3x4,
    /// 1 / squared length of the normal, or 0.
    inverse: Vec4,
    /// Variances along the surface and across it.
    expected: [Vec4; 2],
}

/// Variance of the first corner of a separate face, relative to that of its other corners.
const APART: f32 = 64.0;

impl SpreadScales {
    pub(super) fn new() -> Self {
        Self { now: [Vec4::ONE; 2], next: [Vec4::ONE; 2] }
    }

    /// Predicts a vertex in each lane from its gate, given the vertices before.
    #[inline(always)]
    pub(super) fn predict(
        &self,
        gates: &[Gate; LANES],
        models: &Models,
        at: impl Fn(usize, u16) -> Vec4,
    ) -> Predictions {
        let GateGeometry { corner, features: [f0, f1, f2, f3, f4], normal, sides } =
            GateGeometry::new(gates, at);
        let kinds = [gates[0].kind(), gates[1].kind(), gates[2].kind(), gates[3].kind()];
        let row = |half: usize| {
            let at = |lane: usize| models.gates[kinds[lane]][half];
            Mat4::from_cols(at(0), at(1), at(2), at(3)).transpose()
        };
        let Mat4 { x_axis: w0, y_axis: w1, z_axis: w2, w_axis: w3 } = row(0);
        let Mat4 { x_axis: w4, y_axis: along, z_axis: across, .. } = row(1);
        let more = f0.each(|x| x * w0)
            + f1.each(|x| x * w1)
            + (f3.each(|x| x * w3) + f4.each(|x| x * w4))
            + f2.each(|x| x * w2);
        let floor = Vec4::splat(FLOOR);
        let along = along * sides * self.now[0] + floor;
        let across = (across * sides * self.now[1] + floor).min(along);
        Predictions::across(corner + more, normal, [along, across])
    }

    /// Updates the scales of the chosen lanes by how far their vertices were from the predictions.
    #[inline(always)]
    pub(super) fn update(&mut self, predictions: &Predictions, places: Vec3x4, which: BVec4A) {
        let way = places - predictions.mean;
        let height = way.dot(predictions.normal);
        let across = height * height * predictions.inverse;
        let squares = [0.5 * (way.dot(way) - across), across];
        let next = self.next;
        for k in 0..2 {
            let beyond = (squares[k] + Vec4::splat(FLOOR)) / predictions.expected[k] - Vec4::ONE;
            let beyond = beyond.min(Vec4::splat(3.0));
            let value = next[k] + next[k] * beyond * GAIN;
            let value = value.max(Vec4::splat(0.05)).min(Vec4::splat(20.0));
            self.now[k] = Vec4::select(which, next[k], self.now[k]);
            self.next[k] = Vec4::select(which, value, next[k]);
        }
    }
}

impl Predictions {
    /// Conditions each axis on those before. The covariance is `along` − (`along` − `across`) n nᵗ.
    #[inline(always)]
    fn across(mean: Vec3x4, normal: Vec3x4, [along, across]: [Vec4; 2]) -> Self {
        let squared = normal.dot(normal);
        let is_plane = squared.cmpgt(Vec4::ZERO);
        let inverse = Vec4::select(is_plane, Vec4::ONE / squared, Vec4::ZERO);
        let last = LastAxis::of(normal);
        let [u, v, w] = normal.turned(&last);
        let (uu, vv, ww) = (u * u * inverse, v * v * inverse, w * w * inverse);
        let thin = Vec4::select(is_plane, Vec4::ONE - across / along, Vec4::ZERO);
        let rest = Vec4::ONE - thin * uu;
        let by_rest = Vec4::ONE / rest;
        let by_last = Vec4::ONE / (across + (along - across) * ww);
        let second = (Vec4::ZERO - thin) * u * v * inverse * by_rest;
        let third = (across - along) * by_last * inverse * w;
        let variances = [
            along * rest,
            along * (Vec4::ONE - thin * (uu + vv)) * by_rest,
            along * across * by_last,
        ];
        Self {
            mean,
            turns: mean.turned(&last).map(inside),
            second,
            third: [third * u, third * v],
            variances: variances.map(coded),
            last,
            normal,
            inverse,
            expected: [along, across],
        }
    }

    /// Replaces the prediction of a lane whose gate is a corner of a separate face: it is predicted
    /// from earlier vertices, with equal spread in all directions.
    #[cold]
    pub(super) fn start(
        &mut self,
        lane: usize,
        (vertex, gate): (u16, &Gate),
        models: &Models,
        at: impl Fn(u16) -> Vec4,
    ) {
        let (mean, variance) = match gate.faces_b {
            0 => (at(vertex.saturating_sub(1)), APART * models.start),
            corner => (at(vertex.saturating_sub(u16::from(corner))), models.start),
        };
        let variance = coded(Vec4::splat(variance))[lane];
        for turn in 0..3 {
            self.turns[turn][lane] = mean[turn];
            self.variances[turn][lane] = variance;
        }
        self.second[lane] = 0.0;
        self.third[0][lane] = 0.0;
        self.third[1][lane] = 0.0;
        self.last.set_z(lane);
    }

    /// Returns how the residuals of an axis are coded, given its number in coding order.
    #[inline(always)]
    pub(super) fn widths(&self, turn: usize) -> [Width; LANES] {
        // Exponent and first mantissa bit count half octaves of the variance.
        const FIRST: usize = (LEAST_VARIANCE.to_bits() >> 22) as usize;
        let [a, b, c, d] = self.variances[turn].to_array().map(f32::to_bits);
        let width = |bits: u32| WIDTHS[((bits >> 22) as usize).wrapping_sub(FIRST) % WIDTHS.len()];
        [width(a), width(b), width(c), width(d)]
    }

    /// Returns the cells, given how far they are from the nearest ones, in coding order; and the
    /// coordinates in that order.
    #[inline(always)]
    pub(super) fn decode(&self, residuals: [Vec4; 3]) -> (Vec3x4, [Vec4; 3]) {
        let [first, second, third] = residuals;
        let first = nearest(self.turns[0]) + first;
        let off_u = first - self.turns[0];
        let second = nearest(self.turns[1] + self.second * off_u) + second;
        let off_v = second - self.turns[1];
        let third =
            nearest(self.turns[2] + (self.third[0] * off_u + self.third[1] * off_v)) + third;
        let turns = [first, second, third];
        (Vec3x4::turned_back(turns, &self.last), turns)
    }

    /// Returns how far cells are from the nearest ones, in coding order.
    pub(super) fn encode(&self, places: Vec3x4) -> [Vec4; 3] {
        let [first, second, third] = places.turned(&self.last);
        let (off_u, off_v) = (first - self.turns[0], second - self.turns[1]);
        [
            first - nearest(self.turns[0]),
            second - nearest(self.turns[1] + self.second * off_u),
            third - nearest(self.turns[2] + (self.third[0] * off_u + self.third[1] * off_v)),
        ]
    }
}

/// Clamps a prediction to the range of cells.
#[inline(always)]
fn inside(mean: Vec4) -> Vec4 {
    mean.max(Vec4::ZERO).min(Vec4::splat(MAX_CELLS as f32))
}

/// Clamps variances to those that have a class.
#[inline(always)]
fn coded(variance: Vec4) -> Vec4 {
    variance.max(Vec4::splat(LEAST_VARIANCE)).min(Vec4::splat(GREATEST_VARIANCE))
}

const LEAST_VARIANCE: f32 = 0.0625;
/// Half an octave below the end of the last class.
const GREATEST_VARIANCE: f32 = LEAST_VARIANCE * (1u64 << (WIDEST / 2)) as f32 * 1.5;

const WIDEST: usize = CLASSES + 4 * 15 - 1;
/// How a residual is coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Width {
    pub(super) class: usize,
    /// Number of bits below the symbol.
    pub(super) low_bits: u8,
}

/// Width of each half octave.
const WIDTHS: [Width; 128] = {
    let mut widths = [Width { class: 0, low_bits: 0 }; 128];
    let mut octaves = 0;
    while octaves <= WIDEST {
        let low_bits = (octaves / 4).saturating_sub(CLASSES / 4 - 1);
        widths[octaves] = Width { class: octaves - 4 * low_bits, low_bits: low_bits as u8 };
        octaves += 1;
    }
    widths
};

/// Returns the cells nearest to coordinates.
#[inline(always)]
fn nearest(x: Vec4) -> Vec4 {
    // At this magnitude floats are integers.
    const WHOLE: f32 = 1.5 * (1 << 23) as f32;
    inside(x) + Vec4::splat(WHOLE) - Vec4::splat(WHOLE)
}
