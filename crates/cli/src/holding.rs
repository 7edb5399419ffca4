//! What must stay: the options that say it, and what comes of them.

use clap::Args;
use meshlod::check::LockOptions;
use meshlod::mesh::{Lock, Locks};
use meshlod::{Options, Report, Scene, join_locks, scene_locks, world_bounds};
use serde_json::{Value, json};

use crate::amounts::{self, Bound};
use crate::failure::Failure;
use crate::session::Session;

/// What must stay.
#[derive(Args)]
pub struct Holding {
    /// Keep every vertex of a boundary edge where it is
    #[arg(long)]
    lock_boundary: bool,
    /// Keep objects together where they meet: what crosses stays, what touches moves together
    #[arg(long)]
    lock_contacts: bool,
    /// Objects at least this large are never removed, in model units or 5% of the diagonal; smaller
    /// ones go as a whole where that costs least. Without a size, as without the option: none goes
    #[arg(long, value_name = "SIZE", num_args = 0..=1, default_missing_value = "0",
        value_parser = amounts::bound, allow_negative_numbers = true)]
    keep_objects: Option<Bound>,
}

impl Holding {
    /// Puts what must stay of a scene into options.
    pub fn hold(
        &self,
        options: Options,
        scene: &Scene,
        session: &Session,
    ) -> Result<Options, Failure> {
        let size = |size: Bound| size.length(world_bounds(scene).diagonal());
        Ok(Options {
            lock_boundary: self.lock_boundary,
            locks: self.locks(scene, session)?,
            vanish_below: self.keep_objects.map(size),
            ..options
        })
    }

    fn locks(&self, scene: &Scene, session: &Session) -> Result<Locks, Failure> {
        if !self.lock_contacts {
            return Ok(Locks::default());
        }
        session.progress.stage("looking for contacts");
        let contacts = LockOptions { contacts: true, boundary: Lock::Free };
        let of_meshes = scene_locks(scene, &contacts).into_iter().map(|locking| locking.locks);
        join_locks(scene, &of_meshes.collect::<Vec<_>>()).map_err(Failure::new)
    }
}

/// How many vertices are held, by how.
pub fn to_json(report: &Report) -> Value {
    let held = &report.held;
    json!({ "locked": held.locked, "protected": held.protected, "tied": held.tied })
}
