//! Errors that never grow from an update to one that depends on it.

use crate::forest::Forest;
use crate::length16::Length16;

/// Errors of the updates of a forest, set in their order.
#[derive(Clone, Debug)]
pub(crate) struct MonotoneErrors {
    of_updates: Vec<Length16>,
    /// By node: the greatest error of the updates that depend on the one that contracts it.
    lower_bounds: Vec<Length16>,
}

impl MonotoneErrors {
    pub(crate) fn new(forest: &Forest) -> Self {
        Self {
            of_updates: Vec::with_capacity(forest.updates.len()),
            lower_bounds: vec![Length16::default(); forest.positions.len()],
        }
    }

    /// Returns the least error that the next update may have.
    pub(crate) fn least(&self, forest: &Forest) -> Length16 {
        let [a, b] = forest.updates[self.of_updates.len()].children;
        self.lower_bounds[a as usize].max(self.lower_bounds[b as usize])
    }

    /// Sets the error of the next update, and at least to what it must be.
    pub(crate) fn push(&mut self, forest: &Forest, error: Length16) {
        let u = self.of_updates.len();
        let error = error.max(self.least(forest));
        if forest.updates[u].fused_with_child {
            // Both updates of a face contraction are needed as a whole.
            self.of_updates[u - 1] = error;
        }
        self.of_updates.push(error);
        self.lower_bounds[forest.node(u)] = error;
        for &v in forest.ring(u) {
            let lower_bound = &mut self.lower_bounds[v as usize];
            *lower_bound = (*lower_bound).max(error);
        }
    }

    /// Returns the errors, one an update.
    pub(crate) fn finish(self) -> Vec<Length16> {
        self.of_updates
    }
}

impl Forest {
    /// Gives the updates other errors.
    pub(crate) fn set_errors(&mut self, errors: impl IntoIterator<Item = Length16>) {
        self.updates.iter_mut().zip(errors).for_each(|(update, error)| update.error = error);
    }
}
