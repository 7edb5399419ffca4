//! Meaning of the errors of a model.

/// Meaning of the errors stored with a model's updates: estimates, measured distances or proven
/// bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum ErrorKind {
    /// The errors are estimates by the simplification: most triangles are within them, some are
    /// not.
    #[default]
    Estimate,
    /// The errors are distances measured between each level and the input, both ways, at many points
    /// ([`Forest::measure_errors`](crate::Forest::measure_errors)).
    Measured,
    /// The errors are proven bounds: no triangle deviates by more.
    Bound,
}
