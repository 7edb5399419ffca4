//! Options that keep vertices in place.

use std::path::{Path, PathBuf};

use clap::Args;
use meshlod::check::LockOptions;
use meshlod::mesh::{Lock, Locks};
use meshlod::{Options, Report, Scene, join_locks, scene_locks};
use serde_json::{Value, json};

use crate::args::ReadArgs;
use crate::check::lock_file::{self, FileRows};
use crate::failure::Failure;
use crate::session::Session;

/// Options that keep vertices in place.
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
        Ok(Options {
            lock_boundary: self.lock_boundary,
            locks: self.locks(input, session)?,
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
