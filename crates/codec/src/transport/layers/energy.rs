//! Residuals of the values around, from which the size of the next one is predicted.

/// Sizes of residuals by entry.
#[derive(Clone, Debug)]
pub(super) struct Energy {
    sizes: Vec<f64>,
    sum: f64,
    count: u32,
}

/// Number of levels of [`Energy::level`].
pub(super) const LEVELS: usize = 8;

impl Energy {
    pub(super) fn new(entries: usize) -> Self {
        Self { sizes: vec![0.0; entries], sum: 0.0, count: 0 }
    }

    /// Starts a new sum.
    pub(super) fn clear(&mut self) {
        (self.sum, self.count) = (0.0, 0);
    }

    /// Adds a neighbour to the sum.
    pub(super) fn see(&mut self, entry: usize) {
        self.sum += self.sizes[entry];
        self.count += 1;
    }

    /// Returns the mean over the neighbours; 0 without neighbours.
    pub(super) fn around(&self) -> f64 {
        self.sum / f64::from(self.count.max(1))
    }

    /// Adds a residual of an entry.
    pub(super) fn add(&mut self, entry: usize, size: f64) {
        self.sizes[entry] += size;
    }

    /// Returns the level of a mean size.
    pub(super) fn level(size: f64) -> usize {
        const BOUNDS: [f64; LEVELS - 1] = [0.3, 1.0, 2.0, 4.0, 8.0, 16.0, 48.0];
        BOUNDS.iter().filter(|&&bound| size > bound).count()
    }
}
