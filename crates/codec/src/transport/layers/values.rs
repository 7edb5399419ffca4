//! Prediction of colours, weights and all other values from those of neighbours.

use super::adjacency::{next, previous};
use super::coder::Coder;
use super::energy::{Energy, LEVELS};
use super::job::{LayerJob, nearest};

/// Contexts of the residuals: nothing known or something, levels of the residuals around,
/// components, of which those from the third on share theirs.
pub(super) const VALUE_RESIDUALS: usize = 2 * LEVELS * COMPONENTS;
const COMPONENTS: usize = 4;
/// Contexts of the bits: whether the first neighbour's values are repeated, after a neighbour that
/// did so and after one that did not, and with it the second one's.
pub(super) const VALUE_BITS: usize = 4;

/// Modes: whether neighbours' values may be repeated, and whether faces predict by parallelograms.
const COPIES: u8 = 1;
const PARALLELOGRAMS: u8 = 2;
pub(super) const VALUE_MODES: u8 = 4;

/// Codes the values of all entries.
pub(super) fn code_values(job: &LayerJob, coder: &mut impl Coder, numbers: &mut [i32]) {
    let width = job.width();
    let mut around = ValueSurroundings::new(job);
    for entry in 0..job.entries.len() {
        around.gather(job, entry, numbers);
        match around.copied(job, entry, numbers, coder) {
            Some(other) => numbers.copy_within(width * other..width * (other + 1), width * entry),
            None => around.code_row(job, entry, numbers, coder),
        }
    }
}

/// Known values around an entry, and predictions from them.
struct ValueSurroundings {
    /// Mean of the predictions, for each number.
    predicted: Vec<f64>,
    /// The first neighbour, and the first other one.
    neighbours: [Option<usize>; 2],
    energy: Energy,
    /// True if the last entry repeated a neighbour.
    was_copied: bool,
}

impl ValueSurroundings {
    fn new(job: &LayerJob) -> Self {
        let energy = Energy::new(job.entries.len());
        let predicted = vec![0.0; job.width()];
        Self { predicted, neighbours: [None; 2], energy, was_copied: false }
    }

    /// Predicts the values of an entry, by the mean of its neighbours or that of parallelograms.
    fn gather(&mut self, job: &LayerJob, entry: usize, numbers: &[i32]) {
        let width = self.predicted.len();
        self.energy.clear();
        self.predicted.fill(0.0);
        self.neighbours = [None; 2];
        let (mut count, mut corners) = (0.0, 0.0);
        let of = |entry: usize, k: usize| f64::from(numbers[width * entry + k]);
        for corner in job.entries.around(entry) {
            let ends = [next(corner), previous(corner)];
            let before = ends.map(|at| job.entries.before(at, entry));
            for other in before.into_iter().flatten() {
                self.meet(other);
                if corners == 0.0 {
                    (0..width).for_each(|k| self.predicted[k] += of(other, k));
                    count += 1.0;
                }
            }
            if job.layer.mode & PARALLELOGRAMS != 0
                && let [Some(a), Some(b)] = before
                && let Some(twin) = job.geometry.faces.twin(ends[0])
                && let Some(apex) = job.entries.before(previous(twin), entry)
            {
                if corners == 0.0 {
                    self.predicted.fill(0.0);
                }
                corners += 1.0;
                (0..width).for_each(|k| self.predicted[k] += of(a, k) + of(b, k) - of(apex, k));
            }
        }
        let all = if corners > 0.0 { corners } else { f64::max(count, 1.0) };
        self.predicted.iter_mut().for_each(|x| *x /= all);
    }

    /// Notes a neighbour.
    fn meet(&mut self, other: usize) {
        self.energy.see(other);
        match self.neighbours {
            [None, _] => self.neighbours[0] = Some(other),
            [Some(first), None] if first != other => self.neighbours[1] = Some(other),
            _ => {}
        }
    }

    /// Codes whether an entry has the values of a neighbour, and returns that.
    fn copied(
        &mut self,
        job: &LayerJob,
        entry: usize,
        numbers: &[i32],
        coder: &mut impl Coder,
    ) -> Option<usize> {
        if job.layer.mode & COPIES == 0 {
            return None;
        }
        let width = job.width();
        let was_copied = usize::from(self.was_copied);
        let mut tried = self.neighbours.iter().flatten().copied().enumerate();
        let copied = tried.find(|&(k, other)| {
            let is = job.wanted(entry).map(|wanted| wanted == &numbers[width * other..][..width]);
            coder.bit(job.contexts.bits + 2 * k + was_copied, is)
        });
        self.was_copied = copied.is_some();
        copied.map(|(_, other)| other)
    }

    /// Codes the numbers of an entry.
    fn code_row(
        &mut self,
        job: &LayerJob,
        entry: usize,
        numbers: &mut [i32],
        coder: &mut impl Coder,
    ) {
        let width = job.width();
        let is_known = self.neighbours[0].is_some();
        let mut magnitude = self.energy.around();
        for k in 0..width {
            let most = job.layer.most[k];
            let predicted = match entry {
                _ if is_known => nearest(self.predicted[k], most),
                0 => (most / 2) as i32,
                _ => numbers[width * (entry - 1) + k],
            };
            let level = usize::from(is_known) * LEVELS + Energy::level(magnitude);
            let context = level * COMPONENTS + k.min(COMPONENTS - 1);
            let wanted = job.wanted(entry).map(|wanted| wanted[k] - predicted);
            let residual = coder.residual(job.contexts.residuals + context, wanted);
            numbers[width * entry + k] = predicted.wrapping_add(residual);
            let size = f64::from(residual.unsigned_abs());
            self.energy.add(entry, size / width as f64);
            magnitude = 0.5 * (magnitude + size);
        }
    }
}
