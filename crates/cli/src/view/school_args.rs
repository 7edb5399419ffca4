//! Options of `view --flock`.

use clap::Args;
use meshlod::flock::select::PolicyName;
use meshlod_school::scene::ScenarioName;

use crate::flock::names;
use crate::options::parse;

/// Options of the window of a school.
#[derive(Args)]
#[command(next_help_heading = "With --flock")]
#[group(requires = "flock")]
#[cfg_attr(not(feature = "view"), allow(dead_code))]
pub struct SchoolArgs {
    /// Number of members
    #[arg(long, value_name = "N", default_value_t = 150, value_parser = names::members,
        allow_negative_numbers = true)]
    pub members: usize,
    /// Number of schools that share the members
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = parse::positive,
        allow_negative_numbers = true)]
    pub schools: usize,
    /// Scene of the start, with its path of the camera: ring, inside, far, obstacles or terrain
    #[arg(long, value_name = "NAME", default_value = "ring")]
    pub camera: ScenarioName,
    /// Policy of the start
    #[arg(long, value_name = "NAME", default_value = "ours",
        help = names::policies())]
    pub policy: PolicyName,
}
