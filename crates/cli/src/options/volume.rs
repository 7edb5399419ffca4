//! The option for levels of exactly the original volume.

use clap::Args;

/// Option for levels of exactly the original volume.
#[derive(Args)]
#[command(next_help_heading = "Constraints")]
pub struct ExactVolumeArgs {
    /// Restore the exact volume of closed parts
    ///
    /// Vertices move along their normals, by at most 0.5% of the diagonal and mostly by their last
    /// digits, until the closed parts of every mesh have their original volume in the precision
    /// that is written.
    #[arg(long)]
    pub exact_volume: bool,
}
