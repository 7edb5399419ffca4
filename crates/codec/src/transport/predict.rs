//! Prediction of vertex positions and of the spread around them, for four blocks at a time.
//!
//! The prediction is a parallelogram [TG98] corrected by weighted features of its surroundings. It
//! is more certain across the surface than along it. Each number is one lane of four, so that the
//! processor works on four blocks at once. All operations are `f32` sums, products and quotients,
//! each rounded by itself: the results are the same on every machine, whichever blocks are side by
//! side.

use glam::{BVec4A, Mat4, Vec3A, Vec4};

use super::gate::Gate;
use super::lanes::{LANES, LastAxis, Vec3x4, least, most};
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
    /// Coordinates in coding order. The axis closest to the normal is last, and nearly certain by
    /// then.
    turns: [[f32; LANES]; 3],
    variances: [[f32; LANES]; 3],
    /// Dependence of the second axis on the first, and of the third on both.
    second: [f32; LANES],
    third: [[f32; LANES]; 2],
    last: [u8; LANES],
    normal: Vec3x4,
    /// 1 / squared length of the normal, or 0.
    inverse: Vec4,
    /// Variances along the surface and across it.
    expected: [Vec4; 2],
}

/// Prediction of one lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prediction {
    mean: [f32; 3],
    variances: [f32; 3],
    second: f32,
    third: [f32; 2],
    last: u8,
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
        let across = least(across * sides * self.now[1] + floor, along);
        Predictions::across(corner + more, normal, [along, across])
    }

    /// Updates the scales of the chosen lanes by how far their vertices were from the predictions.
    #[inline(always)]
    pub(super) fn update(
        &mut self,
        predictions: &Predictions,
        places: [Vec4; LANES],
        which: BVec4A,
    ) {
        let way = Vec3x4::new(places) - predictions.mean;
        let height = way.dot(predictions.normal);
        let across = height * height * predictions.inverse;
        let squares = [0.5 * (way.dot(way) - across), across];
        let next = self.next;
        for k in 0..2 {
            let beyond = (squares[k] + Vec4::splat(FLOOR)) / predictions.expected[k] - Vec4::ONE;
            let beyond = least(beyond, Vec4::splat(3.0));
            let value = next[k] + next[k] * beyond * GAIN;
            let value = least(most(value, Vec4::splat(0.05)), Vec4::splat(20.0));
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
        let axis = last.select(Vec4::ZERO, Vec4::ONE, Vec4::splat(2.0)).to_array();
        Self {
            mean,
            turns: mean.turned(&last).map(inside),
            variances: variances.map(Vec4::into),
            second: second.to_array(),
            third: [(third * u).to_array(), (third * v).to_array()],
            last: axis.map(|axis| axis as u8),
            normal,
            inverse,
            expected: [along, across],
        }
    }

    #[inline(always)]
    pub(super) fn of(&self, lane: usize) -> Prediction {
        let [u, v, w] = &self.turns;
        let [var_u, var_v, var_w] = &self.variances;
        Prediction {
            mean: [u[lane], v[lane], w[lane]],
            variances: [var_u[lane], var_v[lane], var_w[lane]],
            second: self.second[lane],
            third: [self.third[0][lane], self.third[1][lane]],
            last: self.last[lane],
        }
    }
}

/// Clamps a prediction to the range of cells.
#[inline(always)]
fn inside(mean: Vec4) -> [f32; LANES] {
    least(most(mean, Vec4::ZERO), Vec4::splat(MAX_CELLS as f32)).to_array()
}

impl Prediction {
    /// Predicts a corner of a separate face from earlier vertices, with equal spread in all
    /// directions.
    pub(super) fn start(
        vertex: u16,
        gate: &Gate,
        models: &Models,
        at: impl Fn(u16) -> Vec4,
    ) -> Self {
        let (mean, variance) = match gate.faces_b {
            0 => (at(vertex.saturating_sub(1)), APART * models.start),
            corner => (at(vertex.saturating_sub(u16::from(corner))), models.start),
        };
        Self {
            mean: [mean.x, mean.y, mean.z],
            variances: [variance; 3],
            second: 0.0,
            third: [0.0; 2],
            last: 2,
        }
    }

    /// Lets `cell` code the coordinates in order, given the turn, the nearest cell, and the class
    /// with its low bits. Returns the vertex.
    #[inline(always)]
    pub(super) fn take(&self, mut cell: impl FnMut(usize, i32, (usize, u32)) -> i32) -> Vec4 {
        let [u, v, w] = self.mean;
        let first = cell(0, nearest(u), class(self.variances[0])) as f32;
        let off_u = first - u;
        let second = nearest(v + self.second * off_u);
        let second = cell(1, second, class(self.variances[1])) as f32;
        let off_v = second - v;
        let third = nearest(w + (self.third[0] * off_u + self.third[1] * off_v));
        let third = cell(2, third, class(self.variances[2])) as f32;
        // A table, since a branch would be mispredicted wherever the surface turns.
        const TURNS: [[u8; 3]; 4] = [[2, 0, 1], [1, 2, 0], [0, 1, 2], [0, 1, 2]];
        let by_turn = [first, second, third, 0.0];
        let [x, y, z] = TURNS[usize::from(self.last % 4)];
        let by_turn = |turn: u8| by_turn[usize::from(turn % 4)];
        Vec4::new(by_turn(x), by_turn(y), by_turn(z), 0.0)
    }

    /// Returns the axis of each turn.
    pub(super) fn axes(&self) -> [usize; 3] {
        [[1, 2, 0], [2, 0, 1], [0, 1, 2]][usize::from(self.last)]
    }
}

/// Returns the class of a variance, and the number of low bits of a residual.
#[inline(always)]
fn class(variance: f32) -> (usize, u32) {
    // Exponent and first mantissa bit count half octaves of the variance.
    const FIRST: i32 = (0.0625f32.to_bits() >> 22) as i32;
    let octaves = ((variance.to_bits() >> 22) as i32 - FIRST).clamp(0, WIDEST as i32);
    let (class, low_bits) = WIDTHS[octaves as usize % WIDTHS.len()];
    (usize::from(class), u32::from(low_bits))
}

const WIDEST: usize = CLASSES + 4 * 15 - 1;
/// Class and low bits of each half octave.
const WIDTHS: [(u8, u8); 128] = {
    let mut widths = [(0, 0); 128];
    let mut octaves = 0;
    while octaves <= WIDEST {
        let low_bits = (octaves / 4).saturating_sub(CLASSES / 4 - 1);
        widths[octaves] = ((octaves - 4 * low_bits) as u8, low_bits as u8);
        octaves += 1;
    }
    widths
};

/// Returns the cell nearest to a coordinate.
#[inline(always)]
fn nearest(x: f32) -> i32 {
    // At this magnitude floats are integers.
    const WHOLE: f32 = 1.5 * (1 << 23) as f32;
    let x = if x > 0.0 { x } else { 0.0 };
    let x = if x < MAX_CELLS as f32 { x } else { MAX_CELLS as f32 };
    (x + WHOLE).to_bits() as i32 - WHOLE.to_bits() as i32
}
