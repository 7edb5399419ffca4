//! Options for what levels are given when all contractions are done.

use clap::Args;

/// Options for what levels are given when all contractions are done.
#[derive(Args)]
pub struct FinishArgs {
    /// Fit the vertices of a level to the original once more, all together
    ///
    /// Distances of scans are some 7% less in the mean; models with sharp edges or many parts may
    /// gain nothing, and single places may be farther off. A run to a number of faces takes up to half as long again.
    /// Volumes, boundaries, seams and locked vertices stay. For lindstrom-turk; a run within
    /// --error does without.
    #[arg(long)]
    pub polish: bool,
    /// Restore the exact volume of closed parts
    ///
    /// Vertices move along their normals, by at most 0.5% of the diagonal and mostly by their last
    /// digits, until the closed parts of every mesh have their original volume in the precision
    /// that is written.
    #[arg(long, help_heading = "Constraints")]
    pub exact_volume: bool,
}
