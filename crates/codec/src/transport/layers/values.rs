//! Prediction of colours, weights and all other values from those of neighbours.

use super::adjacency::{next, previous};
use super::coder::Coder;
use super::energy::{Energy, LEVELS};
use super::entries::Entries;
use super::geometry::BlockGeometry;
use super::nearest;

/// Contexts of the residuals: nothing known or something, levels of the residuals around,
/// components, of which those from the third on share theirs.
pub(super) const VALUE_RESIDUALS: usize = 2 * LEVELS * COMPONENTS;
const COMPONENTS: usize = 4;
/// Contexts of the bits: whether the first neighbour's values are repeated, after a neighbour that
/// did so and after one that did not, and with it the second one's.
pub(super) const VALUE_BITS: usize = 4;

/// Codes the values of all entries.
pub(super) fn code_values(
    geometry: &BlockGeometry,
    entries: &Entries,
    (residual_context, bit_context, mode): (usize, usize, u8),
    coder: &mut impl Coder,
    numbers: &mut [i32],
    most: &[u32],
    source: Option<&[i32]>,
) {
    let width = most.len();
    let mut energy = Energy::new(entries.len());
    let mut was_copied = false;
    let mut predicted = vec![0.0; width];
    for entry in 0..entries.len() {
        energy.clear();
        let wanted = source.map(|source| &source[width * entry..][..width]);
        let neighbours = gather(geometry, entries, entry, mode, numbers, &mut predicted, &mut energy);
        let (known, rest) = numbers.split_at_mut(width * entry);
        let row = &mut rest[..width];
        let mut is_copied = false;
        if mode & COPIES != 0 {
            for (k, other) in neighbours.iter().flatten().enumerate() {
                let there = &known[width * other..][..width];
                let is = wanted.map(|wanted| wanted == there);
                if coder.bit(bit_context + 2 * k + usize::from(was_copied), is) {
                    row.copy_from_slice(there);
                    is_copied = true;
                    break;
                }
            }
        }
        was_copied = is_copied;
        if is_copied {
            continue;
        }
        let is_known = usize::from(neighbours[0].is_some());
        let mut magnitude = energy.around();
        for k in 0..width {
            let predicted = match neighbours[0] {
                Some(_) => nearest(predicted[k], most[k]),
                None if entry > 0 => known[width * (entry - 1) + k],
                None => (most[k] / 2) as i32,
            };
            let component = k.min(COMPONENTS - 1);
            let context = residual_context
                + (is_known * LEVELS + Energy::level(magnitude)) * COMPONENTS
                + component;
            let residual = coder.residual(context, wanted.map(|wanted| wanted[k] - predicted));
            row[k] = predicted.wrapping_add(residual);
            let size = f64::from(residual.unsigned_abs());
            energy.add(entry, size / width as f64);
            magnitude = 0.5 * (magnitude + size);
        }
    }
}

/// Modes: whether neighbours' values may be repeated, and whether faces predict by parallelograms.
pub(super) const COPIES: u8 = 1;
const PARALLELOGRAMS: u8 = 2;
pub(super) const VALUE_MODES: u8 = 4;

/// Predicts the values of an entry, and returns up to two different known neighbours.
fn gather(
    geometry: &BlockGeometry,
    entries: &Entries,
    entry: usize,
    mode: u8,
    numbers: &[i32],
    predicted: &mut [f64],
    energy: &mut Energy,
) -> [Option<usize>; 2] {
    let width = predicted.len();
    predicted.fill(0.0);
    let mut neighbours = [None; 2];
    let (mut count, mut corners) = (0.0, 0.0);
    let of = |entry: usize, k: usize| f64::from(numbers[width * entry + k]);
    for corner in entries.around(entry) {
        let ends = [next(corner), previous(corner)];
        let known = ends.map(|at| entries.before(at, entry));
        for other in known.into_iter().flatten() {
            energy.see(other);
            match neighbours {
                [None, _] => neighbours[0] = Some(other),
                [Some(first), None] if first != other => neighbours[1] = Some(other),
                _ => {}
            }
            if corners == 0.0 {
                (0..width).for_each(|k| predicted[k] += of(other, k));
                count += 1.0;
            }
        }
        if mode & PARALLELOGRAMS == 0 {
            continue;
        }
        if let [Some(a), Some(b)] = known
            && let Some(twin) = geometry.faces.twin(ends[0])
            && let Some(apex) = entries.before(previous(twin), entry)
        {
            if corners == 0.0 {
                predicted.fill(0.0);
            }
            corners += 1.0;
            (0..width).for_each(|k| predicted[k] += of(a, k) + of(b, k) - of(apex, k));
        }
    }
    let all = if corners > 0.0 { corners } else { f64::max(count, 1.0) };
    predicted.iter_mut().for_each(|x| *x /= all);
    neighbours
}
