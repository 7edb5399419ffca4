//! Options that keep vertices in place.

use std::path::{Path, PathBuf};

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use meshlod::check::ContactPolicy;
use meshlod::{Scene, VertexLocking};

use crate::check::lock_file::{self, FileRows};
use crate::options::args::ReadArgs;
use crate::session::failure::Failure;

/// Options that keep vertices in place.
#[derive(Args)]
#[command(next_help_heading = "Constraints")]
pub struct LockArgs {
    /// Lock every vertex of a boundary edge in place
    #[arg(long)]
    pub lock_boundary: bool,
    /// Keep objects together where they meet; without a policy by tie
    #[arg(long, value_name = "POLICY", num_args = 0..=1, require_equals = true,
        default_missing_value = "tie")]
    pub lock_contacts: Option<PolicyArg>,
    /// Apply the vertex locks in a file written by check --locks
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["lock_contacts", "fuse"])]
    pub locks: Option<PathBuf>,
}

/// Policy for contacts on the command line.
#[derive(Clone, Copy, Debug)]
pub struct PolicyArg(pub ContactPolicy);

impl ValueEnum for PolicyArg {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [PolicyArg; 3] = [
            PolicyArg(ContactPolicy::ALL[0]),
            PolicyArg(ContactPolicy::ALL[1]),
            PolicyArg(ContactPolicy::ALL[2]),
        ];
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let help = match self.0 {
            ContactPolicy::Tie => {
                "Coincident vertices move together, and vertices where objects cross or merely touch are contracted late"
            }
            ContactPolicy::Protect => {
                "All vertices at contacts are contracted late; coincident ones may separate"
            }
            ContactPolicy::Exclude => {
                "All vertices at contacts are locked, which is safest and leaves most faces there"
            }
        };
        Some(PossibleValue::new(self.0.name()).help(help))
    }
}

/// A scene, with the path and the reading options it came from.
pub struct InputScene<'o> {
    pub scene: &'o Scene,
    pub path: &'o Path,
    pub reading: &'o ReadArgs,
}

impl LockArgs {
    /// Returns the source of the locks of single vertices.
    pub fn locking(&self, input: &InputScene<'_>) -> Result<VertexLocking, Failure> {
        Ok(match (&self.locks, self.lock_contacts) {
            (Some(path), _) => {
                let rows = FileRows::of(input.path, input.scene, input.reading.options().weld)?;
                VertexLocking::Given(lock_file::read(path, input.scene, &rows)?)
            }
            (None, Some(PolicyArg(policy))) => VertexLocking::Contacts(policy),
            (None, None) => VertexLocking::None,
        })
    }
}
