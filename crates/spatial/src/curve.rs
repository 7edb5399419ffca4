//! Sorting points along a space-filling (Hilbert) curve.

use glam::Vec3;
use rayon::prelude::*;

/// Bits of a key per axis and bits of a radix digit, so that a key takes three passes. Two passes
/// of 15 bits sort a million keys in 1.4 times the time.
const BITS: u32 = 10;
const CELLS: f32 = (1u32 << BITS) as f32;
/// Runs of equal keys at least this long are sorted again at a finer scale.
const CROWD: usize = 32;

/// Returns the indices of points in order along the Hilbert curve, so that points close in space
/// are close in the order.
///
/// Points in one cell are sorted again in the box of that cell's points, so neither far-off points
/// nor crowds spoil the order; coincident points keep their order. Coordinates are finite, in any
/// unit. Cost: O(n), n = points; keys are computed on all threads.
pub fn curve_order(points: &[[f32; 3]]) -> Vec<u32> {
    let mut keyed: Vec<Keyed> =
        (0..points.len() as u32).map(|item| Keyed { key: 0, item }).collect();
    sort(&mut keyed, points, &mut Vec::new());
    keyed.into_iter().map(|keyed| keyed.item).collect()
}

#[derive(Clone, Copy)]
struct Keyed {
    key: u32,
    item: u32,
}

/// Keys that a thread computes at a time.
const AT_ONCE: usize = 1 << 14;

fn sort(run: &mut [Keyed], points: &[[f32; 3]], scratch: &mut Vec<Keyed>) {
    let point = |keyed: &Keyed| Vec3::from(points[keyed.item as usize]);
    let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (lo, hi) = run.iter().map(point).fold(empty, |(lo, hi), p| (lo.min(p), hi.max(p)));
    let extent = (hi - lo).max_element();
    if extent <= 0.0 || extent.is_nan() {
        return;
    }
    let scale = CELLS / extent;
    run.par_iter_mut().with_min_len(AT_ONCE).for_each(|keyed| {
        let cell = (point(keyed) - lo) * scale;
        keyed.key = curve_key(cell.min(Vec3::splat(CELLS - 1.0)));
    });
    radix_sort(run, scratch);
    let whole = run.len();
    for crowd in run.chunk_by_mut(|a, b| a.key == b.key) {
        if crowd.len() >= CROWD && crowd.len() < whole {
            sort(crowd, points, scratch);
        }
    }
}

/// Returns the index of a cell along Hilbert's curve through all cells.
///
/// Compared with Morton keys, a block of eight boxes overlaps a fifth fewer of the others.
/// # References
/// [HRC08] algorithm 2, tabulated.
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

/// Spreads the bits of a coordinate, with two zeros between them.
fn spread(coordinate: f32) -> u32 {
    let mut bits = coordinate as u32;
    bits = (bits | bits << 16) & 0x0300_00ff;
    bits = (bits | bits << 8) & 0x0300_f00f;
    bits = (bits | bits << 4) & 0x030c_30c3;
    (bits | bits << 2) & 0x0924_9249
}

/// Rank of an octant along the curve, and the state in which the curve runs through it.
#[derive(Clone, Copy)]
struct Step {
    rank: u8,
    state: u8,
}

/// Number of states: three times the corner where the curve enters a cube, plus the axis along
/// which it leaves.
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

/// Two steps in one, indexed by an octant and the octant inside it, which halves the chain of
/// dependent look-ups.
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

/// Rotates three bits to the left.
const fn rotate(bits: usize, by: usize) -> usize {
    (bits << (by % 3) | bits >> (3 - by % 3)) & 7
}

const fn gray(rank: usize) -> usize {
    rank ^ rank >> 1
}

/// Returns the corner where the curve enters the `rank`th octant of a cube entered at corner 0.
const fn first_corner(rank: usize) -> usize {
    if rank == 0 { 0 } else { gray((rank - 1) / 2 * 2) }
}

/// Returns the axis along which the curve runs in the `rank`th octant.
const fn first_axis(rank: usize) -> usize {
    let odd = if rank == 0 { return 0 } else { rank - (rank + 1) % 2 };
    odd.trailing_ones() as usize % 3
}

/// Sorts by key, stably.
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
