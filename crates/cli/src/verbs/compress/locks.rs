//! Locks in a compressed file, in which every vertex is on a grid.

use meshlod::check::ContactPolicy;

use super::Compress;
use crate::options::locks::{LockArgs, PolicyArg};
use crate::session::failure::Failure;

impl Compress {
    /// Returns true if vertices at one place stay together, and refuses locks that no file keeps.
    pub(super) fn ties_contacts(&self) -> Result<bool, Failure> {
        let reason = "compress removes no face and changes no topology";
        self.constraints.topology.clone().keep(reason)?;
        let LockArgs { lock_boundary, lock_contacts, locks } = &self.constraints.locks;
        if let Some(PolicyArg(policy)) = lock_contacts
            && *policy != ContactPolicy::Tie
        {
            return Err(no_lock(&format!("--lock-contacts={}", policy.name())));
        }
        if *lock_boundary {
            return Err(no_lock("--lock-boundary"));
        }
        match locks {
            Some(_) => Err(no_lock("--locks")),
            None => Ok(lock_contacts.is_some()),
        }
    }
}

fn no_lock(option: &str) -> Failure {
    Failure::usage(format_args!(
        "{option}: no lock holds a vertex in a compressed file, which rounds all of them; \
         --lock-contacts keeps vertices at one place together"
    ))
}
