//! What hangs together: a union-find.

/// Numbers joined into sets; a set goes by its least number.
#[derive(Default)]
pub(crate) struct Joined(Vec<u32>);

impl Joined {
    /// The numbers below `count`, each alone.
    pub(crate) fn new(count: usize) -> Self {
        let mut joined = Self::default();
        joined.reset(count);
        joined
    }

    /// Takes all apart, and has the numbers below `count`.
    pub(crate) fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.extend(0..count as u32);
    }

    /// Joins the sets of two numbers; false where they are one already.
    pub(crate) fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.least(a), self.least(b));
        self.0[a.max(b) as usize] = a.min(b);
        a != b
    }

    /// The least number of the set.
    pub(crate) fn least(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            // Halving the path keeps later walks short.
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }
}
