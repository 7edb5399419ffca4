//! Locks in a compressed file, in which every vertex is on a grid.

use meshlod::Scene;
use meshlod::check::ContactPolicy;

use super::{Compress, Kind, SchemeArg};
use crate::options::locks::{LockArgs, PolicyArg};
use crate::session::failure::Failure;

impl Compress {
    /// Chooses a scheme that rounds equal positions equally if contacts are tied, and refuses locks
    /// that no scheme keeps.
    pub(super) fn apply_locks(&mut self, kind: Kind) -> Result<(), Failure> {
        let reason = "compress removes no face and changes no topology";
        self.constraints.topology.keep(reason)?;
        let LockArgs { lock_boundary, lock_contacts, locks } = &self.constraints.locks;
        let is_tied = match lock_contacts {
            Some(PolicyArg(policy)) if *policy != ContactPolicy::Tie => {
                let policy = policy.name();
                return Err(no_lock(&format!("--lock-contacts={policy}")));
            }
            policy => policy.is_some(),
        };
        if *lock_boundary {
            return Err(no_lock("--lock-boundary"));
        }
        if locks.is_some() {
            return Err(no_lock("--locks"));
        }
        match (kind, self.scheme) {
            (Kind::Resident, None) if is_tied => self.scheme = Some(SchemeArg::Lattice),
            (_, Some(SchemeArg::Parts | SchemeArg::Blocks)) if is_tied => {
                return Err(Failure::usage(
                    "--lock-contacts needs one grid for all vertices: use --scheme lattice, or leave out --scheme",
                ));
            }
            _ => {}
        }
        Ok(())
    }

    /// Refuses contacts that a file keeps on grids of their own: those of several meshes in .glb.
    pub(super) fn check_scene(&self, kind: Kind, scene: &Scene) -> Result<(), Failure> {
        let is_tied = self.constraints.locks.lock_contacts.is_some();
        if is_tied && kind == Kind::Gltf && scene.instances().len() > 1 {
            return Err(Failure::usage(
                "--lock-contacts: the meshes of a .glb file have grids of their own; write .mlq or .mlz",
            ));
        }
        Ok(())
    }
}

fn no_lock(option: &str) -> Failure {
    Failure::usage(format_args!(
        "{option}: no lock holds a vertex in a compressed file, which rounds all of them; \
         --lock-contacts keeps vertices at one place together"
    ))
}
