//! Fitting of the probability and prediction models to a mesh.

use super::border::Step;
use super::encode::Residual;
use super::gate::{CONTEXTS, Gate};
use super::models::{CLASSES, ModelCodes, SYMBOLS, StepTable, parts};
use super::predict::{CellVec, FEATURES, GATES};
use super::walk::BlockWalk;

/// Approximate number of vertices that weights are fitted to. Using all makes a file smaller by a
/// thousandth.
const SAMPLES: usize = 6000;
/// Contexts with fewer steps share a table: a table of their own would take more than it saves.
const FEWEST_STEPS: u32 = 40;

/// Vertex that the weights should predict well.
struct Sample {
    kind: usize,
    /// Unit normal of the surface, or zero.
    normal: CellVec,
    /// Sum of the squared sides of the known face on the gate, plus 1.
    sides: f64,
    /// The features, and last the vector to be predicted from them.
    rows: [CellVec; FEATURES + 1],
}

/// Fits all model parameters but the shapes.
pub(super) fn fit(walks: &[BlockWalk], cells: &[CellVec]) -> ModelCodes {
    let samples = samples(walks, cells);
    let (weights, spreads) = weights(&samples);
    ModelCodes {
        weights,
        spreads,
        start: start(walks, cells),
        shapes: [0; CLASSES],
        steps: steps(walks),
    }
}

fn samples(walks: &[BlockWalk], cells: &[CellVec]) -> Vec<Sample> {
    let gates: usize = walks.iter().map(|walk| walk.gates.len()).sum();
    let stride = gates.div_ceil(SAMPLES).max(1);
    let mut skip = 0;
    let mut samples = Vec::with_capacity(SAMPLES + 1);
    for walk in walks {
        let mut at = skip;
        while let Some(gate) = walk.gates.get(at) {
            if gate.faces_a > 0 {
                samples.push(Sample::of(gate, at, walk, cells));
            }
            at += stride;
        }
        skip = at - walk.gates.len();
    }
    samples
}

impl Sample {
    fn of(gate: &Gate, vertex: usize, walk: &BlockWalk, cells: &[CellVec]) -> Self {
        let at = |v: u16| cells[walk.vertices[usize::from(v)] as usize];
        let [a, b, apex] = [gate.a, gate.b, gate.apex].map(at);
        let [previous_apex, previous, next] =
            [gate.previous_apex, gate.previous, gate.next].map(at);
        let (edge, spoke, rim) = (b - a, apex - a, apex - b);
        let corner = b - spoke;
        // Features as in `predict`.
        let rows = [
            corner - apex,
            edge,
            corner - (a + a - previous_apex),
            next - b + rim,
            previous - a + spoke,
            at(vertex as u16) - corner,
        ];
        let normal = (edge.cross(spoke) + spoke.cross(previous_apex - a)).normalize_or_zero();
        let sides = edge.length_squared() + spoke.length_squared() + rim.length_squared();
        Self { kind: gate.kind(), normal, sides: f64::from(sides) + 1.0, rows }
    }

    /// Returns the squared prediction error along the surface and across it.
    fn missed(&self, weights: &[f64; FEATURES]) -> [f64; 2] {
        let mut missed = self.rows[FEATURES];
        for (row, &weight) in self.rows.iter().zip(weights) {
            missed -= *row * weight as f32;
        }
        let across = missed.dot(self.normal).powi(2);
        [0.5 * (missed.length_squared() - across), across].map(|square| f64::from(square.max(0.0)))
    }
}

/// Fits weights by iteratively reweighted least squares: large errors count less each round, since
/// bits grow with the logarithm of an error.
fn weights(samples: &[Sample]) -> ([[i8; FEATURES]; GATES], [[u8; 2]; GATES]) {
    const ROUNDS: usize = 3;
    let mut weights = [[0.0; FEATURES]; GATES];
    for _ in 0..ROUNDS {
        let typical = typical(samples, &weights);
        let mut sums = [[[0.0; FEATURES + 1]; FEATURES]; GATES];
        for sample in samples {
            let kind = sample.kind;
            let missed = sample.missed(&weights[kind]);
            let sides = sample.sides;
            let [along, across] =
                [0, 1].map(|k| 1.0 / (missed[k] + 2.0 * sides * typical[kind][k] + 0.25));
            let heights = sample.rows.map(|row| row.dot(sample.normal));
            for (i, sums) in sums[kind].iter_mut().enumerate() {
                for (j, sum) in sums.iter_mut().enumerate().skip(i) {
                    let up = f64::from(heights[i] * heights[j]);
                    let all = f64::from(sample.rows[i].dot(sample.rows[j]));
                    *sum += along * all + (across - along) * up;
                }
            }
        }
        weights =
            sums.map(|sums| solve(sums).map(|x| (x * 64.0).round().clamp(-127.0, 127.0) / 64.0));
    }
    let codes = weights.map(|weights| weights.map(|x| (x * 64.0) as i8));
    // Arithmetic mean / logarithmic mean, typically.
    const WIDER: [f64; 2] = [2.5, 3.0];
    let spreads = typical(samples, &weights).map(|typical| {
        [0, 1]
            .map(|k| (32.0 - 8.0 * (typical[k] * WIDER[k]).log2()).round().clamp(0.0, 255.0) as u8)
    });
    (codes, spreads)
}

/// Returns the logarithmic mean of the squared errors, relative to the squared sides.
fn typical(samples: &[Sample], weights: &[[f64; FEATURES]; GATES]) -> [[f64; 2]; GATES] {
    let mut sums = [[0.0; 2]; GATES];
    let mut counts = [0.0; GATES];
    for sample in samples {
        let missed = sample.missed(&weights[sample.kind]);
        let sides = sample.sides;
        for (sum, missed) in sums[sample.kind].iter_mut().zip(missed) {
            *sum += (missed / sides + 1e-5).log2();
        }
        counts[sample.kind] += 1.0;
    }
    std::array::from_fn(|kind| sums[kind].map(|sum| (sum / f64::max(counts[kind], 1.0)).exp2()))
}

/// Solves a symmetric system by Gaussian elimination, with a small ridge on the diagonal.
fn solve(mut rows: [[f64; FEATURES + 1]; FEATURES]) -> [f64; FEATURES] {
    let more = 1e-4 * (0..FEATURES).map(|i| rows[i][i]).sum::<f64>() + 1e-9;
    let above = rows;
    for (i, row) in rows.iter_mut().enumerate() {
        row[i] += more;
        row[..i].iter_mut().zip(&above).for_each(|(x, above)| *x = above[i]);
    }
    for i in 0..FEATURES {
        let pivot = rows[i].map(|x| x / rows[i][i]);
        for row in &mut rows {
            let by = row[i];
            row.iter_mut().zip(pivot).for_each(|(x, p)| *x -= by * p);
        }
        rows[i] = pivot;
    }
    rows.map(|row| row[FEATURES])
}

/// Returns the code of the variance of second and third corners of separate faces.
fn start(walks: &[BlockWalk], cells: &[CellVec]) -> u8 {
    let (mut sum, mut count) = (0.0, 0.0);
    for walk in walks {
        let at = |v: usize| cells[walk.vertices[v] as usize];
        for corner in [1, 2] {
            let way = at(corner) - at(0);
            sum += f64::from(way.length_squared()) / 3.0;
            count += 1.0;
        }
    }
    (4.0 * (sum / f64::max(count, 1.0) + 0.1).log2()).round().clamp(0.0, 255.0) as u8
}

fn steps(walks: &[BlockWalk]) -> Vec<Option<[u8; Step::ALL.len()]>> {
    let mut counts = [[0; Step::ALL.len()]; CONTEXTS + 1];
    for &(context, step) in walks.iter().flat_map(|walk| &walk.steps) {
        counts[usize::from(context)][step as usize] += 1;
    }
    let (own, rest) = counts.split_at_mut(CONTEXTS);
    for counts in own.iter_mut().filter(|counts| counts.iter().sum::<u32>() < FEWEST_STEPS) {
        rest[0].iter_mut().zip(std::mem::take(counts)).for_each(|(all, count)| *all += count);
    }
    let codes =
        |counts: &[u32; 5]| counts.iter().any(|&c| c > 0).then(|| StepTable::codes(*counts));
    counts.iter().map(codes).collect()
}

/// Returns for each class the shape that codes its residuals in the fewest bits.
pub(super) fn shapes<'a>(residuals: impl Iterator<Item = &'a Residual>) -> [u8; CLASSES] {
    let mut counts = [[0u32; SYMBOLS]; CLASSES];
    for residual in residuals {
        counts[usize::from(residual.class)][residual.symbol().0] += 1;
    }
    std::array::from_fn(|class| shape(class, &counts[class]))
}

/// Descends from a usual shape to the best one nearby.
fn shape(class: usize, counts: &[u32; SYMBOLS]) -> u8 {
    let cost = |[freedom, width]: [i32; 2]| {
        if !(0..8).contains(&freedom) || !(0..32).contains(&width) {
            return f64::INFINITY;
        }
        let parts = parts(class, (freedom << 5 | width) as u8);
        let all: f64 = parts.iter().sum();
        let bits = |(&count, &part): (&u32, &f64)| {
            // A rarer symbol gets no place in the table and is escaped.
            let rare = if part / all < 0.5 / 2048.0 { 24.0 } else { -(part / all).log2() };
            f64::from(count) * rare
        };
        counts.iter().zip(&parts).filter(|(count, _)| **count > 0).map(bits).sum()
    };
    let mut best = [2, 14];
    let mut least = cost(best);
    loop {
        let [freedom, width] = best;
        let around = [[0, -1], [0, 1], [-1, 0], [1, 0], [-1, -1], [1, 1]];
        let around = around.map(|[f, w]| [freedom + f, width + w]);
        let (cost, to) = around
            .map(|to| (cost(to), to))
            .into_iter()
            .fold((f64::INFINITY, best), |a, b| if b.0 < a.0 { b } else { a });
        if cost >= least {
            return (freedom << 5 | width) as u8;
        }
        (least, best) = (cost, to);
    }
}
