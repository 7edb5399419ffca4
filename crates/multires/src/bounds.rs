//! What the errors of a model promise.

/// What is known of an update's error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorKind {
    /// The simplification's own estimate: most triangles are within it, some are not.
    #[default]
    Estimate,
    /// A proven bound: no triangle is further off.
    Bound,
}
