//! Options that `flock` and `view --flock` share.

use clap::Args;
use meshlod::flock::select::PolicyName;
use meshlod_school::scene::ScenarioName;

use crate::flock::names;
use crate::options::parse;

/// Options of a school: its members, its camera and the choice of their levels.
#[derive(Args)]
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
    /// Scene and path of the camera
    ///
    /// ring circles a school, inside swims in it, far keeps away from it; obstacles and terrain
    /// follow it past solids and over hills.
    #[arg(long, value_name = "NAME", default_value = "ring")]
    pub camera: ScenarioName,
    /// Policy that chooses the levels
    #[arg(long, value_name = "NAME", default_value = "ours",
        help = names::policies())]
    pub policy: PolicyName,
}
