//! Options for what simplification must keep, for every verb that simplifies.

use std::path::Path;

use clap::Args;
use meshlod::{Constraints, Mesh, Options, PlacedScene, Scene, Target, VertexLocking, place_scene};

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

/// A scene merged into one mesh, with the options to simplify it by.
pub struct FlatInput {
    pub mesh: Mesh,
    pub options: Options,
    pub fused: Option<FuseReport>,
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

    /// Merges a scene read from a path into one mesh, with the constraints added to the options.
    pub fn flatten(
        &self,
        (scene, fused): (Scene, Option<FuseReport>),
        (path, reading): (&Path, &ReadArgs),
        options: Options,
        session: &Session,
    ) -> Result<FlatInput, Failure> {
        let constraints = self.constraints(&InputScene { scene: &scene, path, reading })?;
        note_search(&constraints, session);
        let (mesh, options) = constraints.flatten(scene, options).map_err(Failure::new)?;
        Ok(FlatInput { mesh, options, fused })
    }

    /// Merges a scene read from a path into one mesh that has each of its meshes once, with the
    /// constraints added to the options.
    pub fn place(
        &self,
        scene: Scene,
        (path, reading): (&Path, &ReadArgs),
        options: Options,
        session: &Session,
    ) -> Result<PlacedScene, Failure> {
        let constraints = self.constraints(&InputScene { scene: &scene, path, reading })?;
        note_search(&constraints, session);
        place_scene(scene, &constraints, options).map_err(|error| Failure::at(path, error))
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
            vanish_below: self.topology.vanish_below()?,
            fuse: self.fuse.fuse,
            lock_boundary: self.locks.lock_boundary,
            locks: self.locks.locking(input)?,
        })
    }
}

impl FlatInput {
    /// Returns a target for the faces before fusing as a target for the mesh.
    pub fn target(&self, target: Target) -> Target {
        self.fused.as_ref().map_or(target, |fused| fused.target(target))
    }

    /// Returns the number of faces before fusing.
    pub fn input_faces(&self) -> usize {
        self.fused.as_ref().map_or(self.mesh.faces.len(), |fused| fused.input_faces)
    }
}

fn note_search(constraints: &Constraints, session: &Session) {
    if matches!(constraints.locks, VertexLocking::Contacts(_)) {
        session.progress.stage("looking for contacts");
    }
}
