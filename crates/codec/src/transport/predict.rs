//! Where a vertex is expected, and how far from there.
//!
//! A parallelogram [TG98], corrected by what else is known around; more surely across the surface than along it. Sums, products and
//! quotients of `f32` in one order: the same on every machine.

use glam::{Vec3A, Vec3Swizzles};

use super::gate::Gate;
use super::models::{CLASSES, Models};

/// A place or a way, in cells.
pub(super) type Cells = Vec3A;

/// Coordinates are below this.
pub(super) const SPAN: i32 = 1 << 21;

pub(super) const FEATURES: usize = 5;
/// Gates are of so many kinds.
pub(super) const GATES: usize = 5 * 4;

impl Gate {
    /// By how many faces the ends of the edge have by now.
    #[inline(always)]
    pub(super) fn kind(&self) -> usize {
        let a = usize::from(self.faces_a.clamp(1, 5)) - 1;
        let b = usize::from(self.faces_b.clamp(1, 4)) - 1;
        4 * a + b
    }
}

/// Where the vertices of a gate are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    a: Cells,
    b: Cells,
    apex: Cells,
    older: Cells,
    before: Cells,
    behind: Cells,
}

impl Around {
    #[inline(always)]
    pub(super) fn new(gate: &Gate, at: impl Fn(u16) -> Cells) -> Self {
        Self {
            a: at(gate.a),
            b: at(gate.b),
            apex: at(gate.apex),
            older: at(gate.older),
            before: at(gate.before),
            behind: at(gate.behind),
        }
    }

    /// The fourth corner of the parallelogram, and what may be added to it. In a regular mesh all but the first two are nothing.
    #[inline(always)]
    pub(super) fn features(&self) -> (Cells, [Cells; FEATURES]) {
        let Self { a, b, apex, older, before, behind } = *self;
        let corner = a + b - apex;
        let features = [
            corner - apex,
            a - b,
            // By how much the parallelogram before has missed.
            b - (a + apex) + older,
            behind - (b + b) + apex,
            before - (a + a) + apex,
        ];
        (corner, features)
    }
}

/// How the surface lies at an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Across the surface, of any length.
    pub(super) normal: Cells,
    /// One by its squared length, or 0.
    pub(super) inverse: f32,
    /// The squared sides of the face behind the edge.
    pub(super) sides: f32,
}

impl Frame {
    #[inline(always)]
    pub(super) fn at(around: &Around) -> Self {
        let Around { a, b, apex, older, .. } = *around;
        let (edge, spoke, last) = (b - a, apex - a, older - a);
        let rim = apex - b;
        let normal = cross(edge, spoke) + cross(spoke, last);
        let squared = dot(normal, normal);
        let sides = edge * edge + spoke * spoke + rim * rim;
        Self {
            normal,
            inverse: if squared > 0.0 { 1.0 / squared } else { 0.0 },
            sides: sum(sides) + 1.0,
        }
    }

    /// The squares of what is along the surface, the mean of two axes, and across it.
    #[inline(always)]
    pub(super) fn squares(&self, way: Cells) -> [f32; 2] {
        let along_normal = dot(way, self.normal);
        let across = along_normal * along_normal * self.inverse;
        [0.5 * (dot(way, way) - across), across]
    }
}

/// How much wider than the models say distances have been lately, and will be told by from the next vertex on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trend {
    now: [f32; 2],
    next: [f32; 2],
}

impl Trend {
    pub(super) fn new() -> Self {
        Self { now: [1.0; 2], next: [1.0; 2] }
    }
}

/// What places are rounded by, a variance. Of .1 to .3, .15 takes the least.
pub(super) const FLOOR: f32 = 0.15;
/// How much a vertex counts for the trend: .08 and .125 take as much, .18 and .06 some thousandths more.
const GAIN: f32 = 0.1;

/// How much further pieces of a block are apart than corners of a face, in squares.
const APART: f32 = 64.0;

/// Where a vertex is expected, as a normal distribution that is taken axis by axis, each given those before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guess {
    mean: Cells,
    /// The one closest to the normal last: by then it is nearly certain.
    axes: [usize; 3],
    variances: [f32; 3],
    /// What the second axis takes of the first; the third of both.
    second: f32,
    third: [f32; 2],
    frame: Frame,
    /// Along and across.
    expected: [f32; 2],
}

impl Guess {
    /// Around a place, as far in all directions.
    pub(super) fn around(mean: Cells, variance: f32) -> Self {
        Self {
            mean,
            axes: [0, 1, 2],
            variances: [variance; 3],
            second: 0.0,
            third: [0.0; 2],
            frame: Frame { normal: Cells::ZERO, inverse: 0.0, sides: 1.0 },
            expected: [variance; 2],
        }
    }

    /// A corner of a face that stands alone, after others of the block.
    pub(super) fn start(
        vertex: u16,
        gate: &Gate,
        models: &Models,
        at: impl Fn(u16) -> Cells,
    ) -> Self {
        match gate.faces_b {
            0 => Self::around(at(vertex - 1), APART * models.start),
            corner => Self::around(at(vertex - u16::from(corner)), models.start),
        }
    }

    #[inline(always)]
    pub(super) fn at(
        gate: &Gate,
        models: &Models,
        trend: &Trend,
        at: impl Fn(u16) -> Cells,
    ) -> Self {
        let kind = gate.kind();
        let around = Around::new(gate, at);
        let (corner, [f0, f1, f2, f3, f4]) = around.features();
        let [w0, w1, w2, w3, w4] = models.weights[kind];
        let mean = corner + ((f0 * w0 + f1 * w1) + (f3 * w3 + f4 * w4) + f2 * w2);
        let frame = Frame::at(&around);
        let [along, across] = models.spreads[kind];
        let along = along * frame.sides * trend.now[0] + FLOOR;
        let across = least(across * frame.sides * trend.now[1] + FLOOR, along);
        Self::across(mean, frame, [along, across])
    }

    /// The covariance is `along` − (`along` − `across`) n nᵗ; each axis is conditioned on those before.
    #[inline(always)]
    fn across(mean: Cells, frame: Frame, [along, across]: [f32; 2]) -> Self {
        let axes = axes(frame.normal);
        let normal = frame.normal.to_array();
        let (u, v, w) = (normal[axes[0]], normal[axes[1]], normal[axes[2]]);
        let inverse = frame.inverse;
        let (uu, vv, ww) = (u * u * inverse, v * v * inverse, w * w * inverse);
        let thin = if inverse > 0.0 { 1.0 - across / along } else { 0.0 };
        let rest = 1.0 - thin * uu;
        let by_rest = 1.0 / rest;
        let by_last = 1.0 / (across + (along - across) * ww);
        let last = (across - along) * by_last * inverse * w;
        Self {
            mean,
            axes,
            variances: [
                along * rest,
                along * (1.0 - thin * (uu + vv)) * by_rest,
                along * across * by_last,
            ],
            second: -thin * u * v * inverse * by_rest,
            third: [last * u, last * v],
            frame,
            expected: [along, across],
        }
    }

    /// The axis that is told first, second and third.
    #[inline(always)]
    pub(super) fn axes(&self) -> [usize; 3] {
        self.axes
    }

    /// The closest cell to where the first axis is expected, and the class of the width with the bits below.
    #[inline(always)]
    pub(super) fn first(&self) -> (i32, (usize, u32)) {
        (nearest(self.mean[self.axes[0]]), class(self.variances[0]))
    }

    /// The second axis, by how far off the first one was.
    #[inline(always)]
    pub(super) fn second(&self, off: f32) -> (i32, (usize, u32)) {
        (nearest(self.mean[self.axes[1]] + self.second * off), class(self.variances[1]))
    }

    /// The third axis, by how far off the two others were.
    #[inline(always)]
    pub(super) fn third(&self, off: [f32; 2]) -> (i32, (usize, u32)) {
        let mean = self.mean[self.axes[2]] + (self.third[0] * off[0] + self.third[1] * off[1]);
        (nearest(mean), class(self.variances[2]))
    }

    /// How far from the mean a coordinate is.
    #[inline(always)]
    pub(super) fn off(&self, axis: usize, coordinate: i32) -> f32 {
        coordinate as f32 - self.mean[axis]
    }

    /// Tells the trend how far off it was.
    #[inline(always)]
    pub(super) fn tell(&self, place: Cells, trend: &mut Trend) {
        let squares = self.frame.squares(place - self.mean);
        let next = trend.next;
        trend.now = next;
        for k in 0..2 {
            let beyond = least((squares[k] + FLOOR) / self.expected[k] - 1.0, 3.0);
            let value = next[k] + next[k] * beyond * GAIN;
            trend.next[k] = least(most(value, 0.05), 20.0);
        }
    }
}

/// The two others in cyclic order, and the one of the greatest coordinate.
#[inline(always)]
fn axes(normal: Cells) -> [usize; 3] {
    const CYCLES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];
    let normal = normal.abs();
    let (x, y, z) = (normal.x, normal.y, normal.z);
    let last = if x > z { usize::from(y > x) } else { 2 - usize::from(y > z) };
    CYCLES[last]
}

/// The class of a variance, and how many bits of a distance are below.
#[inline(always)]
pub(super) fn class(variance: f32) -> (usize, u32) {
    // Exponent and first bit of the mantissa are half octaves of the variance.
    const FIRST: i32 = (0.0625f32.to_bits() >> 22) as i32;
    const WIDEST: i32 = CLASSES as i32 + 4 * 15 - 1;
    let octaves = ((variance.to_bits() >> 22) as i32 - FIRST).clamp(0, WIDEST) as u32;
    let low_bits = (octaves / 4).saturating_sub(CLASSES as u32 / 4 - 1);
    ((octaves - 4 * low_bits) as usize % CLASSES, low_bits)
}

/// The closest cell that there can be.
#[inline(always)]
fn nearest(x: f32) -> i32 {
    // Where floats are whole numbers.
    const WHOLE: f32 = 1.5 * (1 << 23) as f32;
    let inside = least(most(x, 0.0), SPAN as f32);
    (inside + WHOLE).to_bits() as i32 - WHOLE.to_bits() as i32
}

/// Without what `f32::min` does about numbers that are none.
#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn most(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn sum(a: Cells) -> f32 {
    a.x + a.y + a.z
}

#[inline(always)]
pub(super) fn dot(a: Cells, b: Cells) -> f32 {
    sum(a * b)
}

#[inline(always)]
fn cross(a: Cells, b: Cells) -> Cells {
    a.yzx() * b.zxy() - a.zxy() * b.yzx()
}
