//! Numbers of vertices that locks and ties hold.

/// Numbers of input vertices that are locked, protected or tied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Held {
    /// Number of vertices that stay in place, by their own lock or as part of a locked boundary.
    pub locked: usize,
    /// Number of protected vertices, which cost more to move, without those that are locked.
    pub protected: usize,
    /// Number of vertices that move together with others, whether locked or not.
    pub tied: usize,
}

impl Held {
    /// Adds the counts of another mesh that the scene shows `copies` times.
    pub fn add(&mut self, other: &Self, copies: usize) {
        self.locked += copies * other.locked;
        self.protected += copies * other.protected;
        self.tied += copies * other.tied;
    }
}
