//! An order of boxes and points along a curve that fills space.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::blocks::Corners;
use crate::box3::Box3;

/// Bits of a key per axis, and of a digit: three passes over a key. With two passes of 15 bits,
/// sorting a million takes 1.4 times as long.
const BITS: u32 = 10;
const CELLS: f32 = (1u32 << BITS) as f32;
/// Runs with one key at least this long are ordered again by themselves.
const CROWD: usize = 32;

/// The boxes, by their indices, so that those with near centres are near in the order.
///
/// Boxes in one cell are ordered again in the box of their own centres, so neither far-off boxes nor
/// crowds spoil the order; those with one centre stay in their order.
pub(crate) fn order(boxes: &[Box3]) -> Vec<u32> {
    order_by(boxes.len(), |item| boxes[item as usize].center())
}

/// Points, by their indices, so that those that are near are near in the order; those in one place stay
/// in their order.
///
/// Finite coordinates, in any unit. Cost: O(n), n = points; the keys are found on all threads.
pub fn curve_order(points: &[[f32; 3]]) -> Vec<u32> {
    order_by(points.len(), |item| points[item as usize].into())
}

fn order_by(count: usize, center: impl Fn(u32) -> Vec3 + Sync) -> Vec<u32> {
    let mut keyed: Vec<Keyed> = (0..count as u32).map(|item| Keyed { key: 0, item }).collect();
    sort(&mut keyed, &center, &mut Vec::new());
    keyed.into_iter().map(|keyed| keyed.item).collect()
}

#[derive(Clone, Copy)]
struct Keyed {
    key: u32,
    item: u32,
}

/// Keys to a thread at a time.
const AT_ONCE: usize = 1 << 14;

fn sort(run: &mut [Keyed], center: &(impl Fn(u32) -> Vec3 + Sync), scratch: &mut Vec<Keyed>) {
    let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let centers = run.iter().map(|keyed| center(keyed.item));
    let (lo, hi) = centers.fold(empty, |(lo, hi), p| (lo.min(p), hi.max(p)));
    let extent = (hi - lo).max_element();
    if extent <= 0.0 || extent.is_nan() {
        return;
    }
    let scale = CELLS / extent;
    run.par_iter_mut().with_min_len(AT_ONCE).for_each(|keyed| {
        let cell = (center(keyed.item) - lo) * scale;
        keyed.key = curve_key(cell.min(Vec3::splat(CELLS - 1.0)));
    });
    radix_sort(run, scratch);
    let whole = run.len();
    for crowd in run.chunk_by_mut(|a, b| a.key == b.key) {
        if crowd.len() >= CROWD && crowd.len() < whole {
            sort(crowd, center, scratch);
        }
    }
}

/// The place of a cell along Hilbert's curve through all cells.
///
/// Against the order of Morton keys, a block of eight boxes meets a fifth less of the others.
/// # References
/// [HRC08] algorithm 2, its steps in a table.
fn curve_key(cell: Vec3) -> u32 {
    let interleaved = spread(cell.x) << 2 | spread(cell.y) << 1 | spread(cell.z);
    let (mut key, mut state) = (0, 0);
    for level in (0..BITS / 2).rev() {
        let octants = interleaved >> (6 * level) & 63;
        let step = DOUBLE_STEPS[state][octants as usize];
        key = key << 6 | u32::from(step.rank);
        state = usize::from(step.state);
    }
    key
}

/// The bits of a coordinate, two zeros between them.
fn spread(coordinate: f32) -> u32 {
    let mut bits = coordinate as u32;
    bits = (bits | bits << 16) & 0x0300_00ff;
    bits = (bits | bits << 8) & 0x0300_f00f;
    bits = (bits | bits << 4) & 0x030c_30c3;
    (bits | bits << 2) & 0x0924_9249
}

/// What an octant is to the curve: when it comes there, and in which state the curve runs through it.
#[derive(Clone, Copy)]
struct Step {
    rank: u8,
    state: u8,
}

/// A state is the corner where the curve enters a cube, times three, and the axis along which it
/// leaves.
const STATES: usize = 24;
const STEPS: [[Step; 8]; STATES] = steps();

const fn steps() -> [[Step; 8]; STATES] {
    let mut steps = [[Step { rank: 0, state: 0 }; 8]; STATES];
    let mut state = 0;
    while state < STATES {
        let (entry, axis) = (state / 3, state % 3);
        let mut rank = 0;
        while rank < 8 {
            let octant = rotate(gray(rank), axis + 1) ^ entry;
            let next_entry = entry ^ rotate(first_corner(rank), axis + 1);
            let next_axis = (axis + first_axis(rank) + 1) % 3;
            steps[state][octant] =
                Step { rank: rank as u8, state: (3 * next_entry + next_axis) as u8 };
            rank += 1;
        }
        state += 1;
    }
    steps
}

/// Two steps at once, by the octant and the octant in it: half as many to take, one after the other.
const DOUBLE_STEPS: [[Step; 64]; STATES] = double_steps();

const fn double_steps() -> [[Step; 64]; STATES] {
    let mut steps = [[Step { rank: 0, state: 0 }; 64]; STATES];
    let mut state = 0;
    while state < STATES {
        let mut octants = 0;
        while octants < 64 {
            let outer = STEPS[state][octants >> 3];
            let inner = STEPS[outer.state as usize][octants & 7];
            steps[state][octants] = Step { rank: outer.rank << 3 | inner.rank, state: inner.state };
            octants += 1;
        }
        state += 1;
    }
    steps
}

/// Three bits turned to the left.
const fn rotate(bits: usize, by: usize) -> usize {
    (bits << (by % 3) | bits >> (3 - by % 3)) & 7
}

const fn gray(rank: usize) -> usize {
    rank ^ rank >> 1
}

/// Where the curve enters the octant that is the `rank`th in a cube entered at corner 0.
const fn first_corner(rank: usize) -> usize {
    if rank == 0 { 0 } else { gray((rank - 1) / 2 * 2) }
}

/// The axis along which it runs in that octant.
const fn first_axis(rank: usize) -> usize {
    let odd = if rank == 0 { return 0 } else { rank - (rank + 1) % 2 };
    odd.trailing_ones() as usize % 3
}

/// Sorts by key; equal keys keep their order.
fn radix_sort(run: &mut [Keyed], scratch: &mut Vec<Keyed>) {
    if run.len() < 256 {
        run.sort_by_key(|keyed| keyed.key);
        return;
    }
    const DIGITS: usize = 1 << BITS;
    let digit = |keyed: Keyed, pass: u32| keyed.key as usize >> (pass * BITS) & (DIGITS - 1);
    let mut starts = [[0u32; DIGITS]; 3];
    for &keyed in run.iter() {
        for pass in 0..3 {
            starts[pass][digit(keyed, pass as u32)] += 1;
        }
    }
    scratch.clear();
    scratch.resize(run.len(), Keyed { key: 0, item: 0 });
    let mut pass = |pass: u32, from: &[Keyed], to: &mut [Keyed]| {
        let starts = &mut starts[pass as usize];
        let mut sum = 0;
        for start in starts.iter_mut() {
            sum += std::mem::replace(start, sum);
        }
        for &keyed in from {
            let slot = &mut starts[digit(keyed, pass)];
            to[*slot as usize] = keyed;
            *slot += 1;
        }
    };
    pass(0, run, scratch);
    pass(1, scratch, run);
    pass(2, run, scratch);
    run.copy_from_slice(scratch);
}

/// About where most of the boxes are, and how far they reach: coordinates that fit an `f32`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Middle {
    origin: DVec3,
    scale: f64,
}

/// The centre of a box; no box is too large for it.
fn middle([lo, hi]: Corners) -> DVec3 {
    lo * 0.5 + hi * 0.5
}

/// What is farther is as good as there: sums of such coordinates still fit an `f32`.
const FARTHEST: f64 = 1e30;

impl Middle {
    /// Boxes asked for the middle; far more than make a median steady.
    const SAMPLES: usize = 101;

    pub(crate) fn of(count: usize, corners: &impl Fn(u32) -> Corners) -> Self {
        if count == 0 {
            return Self { origin: DVec3::ZERO, scale: 1.0 };
        }
        let samples = Self::SAMPLES.min(count);
        let centers: Vec<DVec3> =
            (0..samples).map(|i| middle(corners((i * count / samples) as u32))).collect();
        let median = |axis: usize| {
            let mut along: Vec<f64> = centers.iter().map(|p| p[axis]).collect();
            along.sort_unstable_by(f64::total_cmp);
            along[samples / 2]
        };
        let origin = DVec3::new(median(0), median(1), median(2));
        let size = |p: DVec3| (p * 0.5 - origin * 0.5).abs().max_element();
        let mut far = centers.into_iter().map(size).fold(0.0, f64::max);
        if far == 0.0 {
            far = (0..count as u32).flat_map(corners).map(size).fold(0.0, f64::max);
        }
        let exponent = if far > 0.0 { -far.log2().floor() } else { 0.0 };
        // A power of two rounds nothing.
        Self { origin, scale: 2f64.powi(exponent.clamp(-1000.0, 1000.0) as i32) }
    }

    /// The box in `f32`, about the middle. Rounding keeps the order of numbers, so boxes that
    /// overlap still do.
    #[inline]
    pub(crate) fn rounded(&self, [lo, hi]: Corners) -> Box3 {
        Box3 { lo: self.local(lo).as_vec3(), hi: self.local(hi).as_vec3() }
    }

    #[inline]
    fn local(&self, p: DVec3) -> DVec3 {
        ((p - self.origin) * self.scale).clamp(DVec3::splat(-FARTHEST), DVec3::splat(FARTHEST))
    }
}
