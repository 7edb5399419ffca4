//! Options for what simplification must keep, for every verb that simplifies.

use std::path::Path;

use clap::Args;
use meshlod::{Constraints, Options, Scene, VertexLocking};

use crate::options::args::ReadArgs;
use crate::options::fuse::{FuseArgs, FuseReport};
use crate::options::locks::{InputScene, LockArgs};
use crate::options::topology::TopologyArgs;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;

/// Options for what simplification must keep.
#[derive(Args)]
pub struct ConstraintArgs {
    #[command(flatten)]
    pub fuse: FuseArgs,
    #[command(flatten)]
    pub locks: LockArgs,
    #[command(flatten)]
    pub topology: TopologyArgs,
}

impl ConstraintArgs {
    /// Adds the constraints to the options for the simplification of a scene.
    pub fn apply(
        &self,
        options: Options,
        input: &InputScene<'_>,
        session: &Session,
    ) -> Result<Options, Failure> {
        let constraints = self.constraints(input)?;
        note_search(&constraints, session);
        constraints.options(input.scene, options).map_err(Failure::new)
    }

    /// Reads a scene and fuses it if that is asked for.
    pub fn read_fused(
        &self,
        path: &Path,
        reading: &ReadArgs,
        session: &Session,
    ) -> Result<(Scene, Option<FuseReport>), Failure> {
        let mut scene = files::read_surface(path, reading, session)?;
        let fused = self.fuse.apply(&mut scene, session);
        Ok((scene, fused))
    }

    /// Returns true if vertices are to be held or objects to be fused.
    pub fn holds_or_fuses(&self) -> bool {
        let LockArgs { lock_boundary, lock_contacts, locks } = &self.locks;
        *lock_boundary || lock_contacts.is_some() || locks.is_some() || self.fuse.fuse
    }

    /// Returns the constraints on a scene that is already fused.
    pub fn constraints(&self, input: &InputScene<'_>) -> Result<Constraints, Failure> {
        Ok(Constraints {
            topology: self.topology.kind(),
            borders: self.topology.borders(),
            vanish_below: self.topology.vanish_below(input)?,
            fuse: self.fuse.fuse,
            lock_boundary: self.locks.lock_boundary,
            locks: self.locks.locking(input)?,
        })
    }
}

fn note_search(constraints: &Constraints, session: &Session) {
    if matches!(constraints.locks, VertexLocking::Contacts(_)) {
        session.progress.stage("looking for contacts");
    }
}
