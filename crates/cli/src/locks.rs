//! Options that keep vertices and objects in place.

use std::path::{Path, PathBuf};

use clap::Args;
use meshlod::check::LockOptions;
use meshlod::mesh::{Lock, Locks};
use meshlod::{Options, Report, Scene, join_locks, scene_locks, world_bounds};
use serde_json::{Value, json};

use crate::args::ReadArgs;
use crate::check::lock_file::{self, FileRows};
use crate::failure::Failure;
use crate::parse::{self, Bound};
use crate::session::Session;

/// Options that keep vertices and objects in place.
#[derive(Args)]
pub struct LockArgs {
    /// Lock every vertex of a boundary edge in place
    #[arg(long)]
    lock_boundary: bool,
    /// Keep objects together where they meet: coincident vertices move together, and vertices where
    /// objects cross or merely touch are contracted late
    #[arg(long)]
    lock_contacts: bool,
    /// Apply the vertex locks in a file written by check --locks
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["lock_contacts", "fuse"])]
    locks: Option<PathBuf>,
    /// Keep every connected component whose bounding box has a diagonal of at least SIZE: a length
    /// in model units, or 5% of the model's diagonal. Smaller ones may be removed as a whole, at an
    /// error of their size, which --error limits [default: all are kept, as with no SIZE]
    #[arg(long, value_name = "SIZE", num_args = 0..=1, default_missing_value = "0",
        require_equals = true, value_parser = parse::bound, allow_negative_numbers = true)]
    keep_objects: Option<Bound>,
}

/// A scene, with the path and the reading options it came from.
pub struct InputScene<'o> {
    pub scene: &'o Scene,
    pub path: &'o Path,
    pub reading: &'o ReadArgs,
}

impl LockArgs {
    /// Adds the locks of a scene to simplification options.
    pub fn apply(
        &self,
        options: Options,
        input: &InputScene<'_>,
        session: &Session,
    ) -> Result<Options, Failure> {
        let size = |size: Bound| size.length(world_bounds(input.scene).diagonal());
        Ok(Options {
            lock_boundary: self.lock_boundary,
            locks: self.locks(input, session)?,
            vanish_below: self.keep_objects.map(size),
            ..options
        })
    }

    fn locks(&self, input: &InputScene<'_>, session: &Session) -> Result<Locks, Failure> {
        let of_meshes = match &self.locks {
            Some(path) => {
                let rows = FileRows::of(input.path, input.scene, input.reading.options().weld)?;
                lock_file::read(path, input.scene, &rows)?
            }
            None if self.lock_contacts => {
                session.progress.stage("looking for contacts");
                let contacts = LockOptions { contacts: true, boundary: Lock::Free };
                let lockings = scene_locks(input.scene, &contacts);
                lockings.into_iter().map(|locking| locking.locks).collect()
            }
            None => return Ok(Locks::default()),
        };
        join_locks(input.scene, &of_meshes).map_err(Failure::new)
    }
}

/// Returns the numbers of locked, protected and tied vertices as JSON.
pub fn to_json(report: &Report) -> Value {
    let held = &report.held;
    json!({ "locked": held.locked, "protected": held.protected, "tied": held.tied })
}
