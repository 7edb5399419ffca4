//! Distributions of residuals, and the best one for given counts.

use super::super::models::{CLASSES, ESCAPE, MAX_RESIDUAL, parts};

/// Student's distribution: its width in quarter octaves above a quarter, and a code of its degrees
/// of freedom.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ResidualShape {
    pub(super) width: u8,
    pub(super) freedom: u8,
}

/// Bits of a width and of the degrees of freedom.
pub(super) const WIDTH_BITS: u32 = 6;
pub(super) const FREEDOM_BITS: u32 = 3;

impl ResidualShape {
    /// Greatest width: low bits are at most 12.
    const WIDEST: u8 = (1 << WIDTH_BITS) - 1;
    const FREEST: u8 = (1 << FREEDOM_BITS) - 1;

    /// Returns the class of a width, and the number of bits that are coded without a model.
    pub(super) fn class(self) -> (usize, u8) {
        let low_bits = (self.width / 4).saturating_sub(CLASSES as u8 / 4 - 1);
        (usize::from(self.width - 4 * low_bits), low_bits)
    }

    /// Returns the code of its shape within the class.
    pub(super) fn code(self) -> u8 {
        self.freedom << 5 | 16
    }
}

/// Returns the shape that codes residuals in the fewest bits, and their number: descends from a
/// usual one.
pub(super) fn fit_shape(residuals: &[i32]) -> (ResidualShape, f64) {
    let mut counts: Vec<(i32, u32)> = Vec::new();
    let mut sorted = residuals.to_vec();
    sorted.sort_unstable();
    for residual in sorted {
        match counts.last_mut() {
            Some((last, count)) if *last == residual => *count += 1,
            _ => counts.push((residual, 1)),
        }
    }
    let middle =
        counts.iter().map(|&(r, count)| f64::from(count) * (f64::from(r).abs() + 0.1).log2());
    let octaves = middle.sum::<f64>() / residuals.len() as f64 + 2.0;
    let width = (4.0 * octaves).round().clamp(0.0, f64::from(ResidualShape::WIDEST)) as i32;
    let cost = |[width, freedom]: [i32; 2]| {
        let is_valid = (0..=i32::from(ResidualShape::WIDEST)).contains(&width)
            && (0..=i32::from(ResidualShape::FREEST)).contains(&freedom);
        match is_valid {
            true => histogram_cost(
                ResidualShape { width: width as u8, freedom: freedom as u8 },
                &counts,
            ),
            false => f64::INFINITY,
        }
    };
    let mut best = [width, 2];
    let mut least = cost(best);
    loop {
        let [w, f] = best;
        let around = [
            [w - 1, f],
            [w + 1, f],
            [w, f - 1],
            [w, f + 1],
            [w - 1, f - 1],
            [w + 1, f + 1],
            [w - 3, f],
            [w + 3, f],
        ];
        let costs = around.map(|to| (cost(to), to));
        let (lower, to) =
            costs.into_iter().fold((f64::INFINITY, best), |a, b| if b.0 < a.0 { b } else { a });
        if lower >= least {
            return (ResidualShape { width: best[0] as u8, freedom: best[1] as u8 }, least);
        }
        (least, best) = (lower, to);
    }
}

/// Returns the bits that a shape takes for residuals, given how many there are of each.
fn histogram_cost(shape: ResidualShape, counts: &[(i32, u32)]) -> f64 {
    let (class, low_bits) = shape.class();
    let parts = parts(class, shape.code());
    let all: f64 = parts.iter().sum();
    let bits = |part: f64| -(part / all).max(1.0 / 2048.0).log2();
    let cost = |&(residual, count): &(i32, u32)| {
        let far = (residual + (1 << low_bits >> 1)) >> low_bits;
        let known = (far.abs() <= MAX_RESIDUAL).then(|| parts[(far + MAX_RESIDUAL) as usize]);
        let symbol = match known.filter(|part| part / all * 2048.0 >= 0.5) {
            Some(part) => bits(part),
            None => {
                bits(parts[ESCAPE]) + f64::from(6 + u32::BITS - far.unsigned_abs().leading_zeros())
            }
        };
        f64::from(count) * (symbol + f64::from(low_bits))
    };
    counts.iter().map(cost).sum()
}
