//! Application of vertex locks to a surface, as vertex flags and ties.

use meshlod_mesh::{Connectivity, Lock, Locks, Mesh, VertexId};

use crate::held::Held;
use crate::options::{Options, SimplifyError};
use crate::surface::ties::{MOST_MEMBERS, Ties};
use crate::surface::{Flags, Surface};

/// Checks that vertex locks have the size of the mesh and that their ties are valid.
pub(crate) fn validate(locks: &Locks, mesh: &Mesh) -> Result<(), SimplifyError> {
    let (found, expected) = (locks.of_vertex.len(), mesh.positions.len());
    if found != 0 && found != expected {
        return Err(SimplifyError::LockCount { found, expected });
    }
    let mut seen = vec![false; if locks.ties.is_empty() { 0 } else { expected }];
    for (tie, members) in locks.ties.iter().enumerate() {
        for &vertex in members {
            match seen.get_mut(vertex.index()) {
                None => return Err(SimplifyError::BadTie { tie, vertex, count: expected }),
                Some(true) => return Err(SimplifyError::TiedTwice { tie, vertex }),
                Some(seen) => *seen = true,
            }
        }
        let place = |vertex: VertexId| mesh.positions[vertex.index()];
        let apart = members.iter().find(|&&vertex| place(vertex) != place(members[0]));
        if let Some(&vertex) = apart {
            return Err(SimplifyError::TornTie { tie, vertices: [members[0], vertex] });
        }
    }
    Ok(())
}

/// Flags locked and protected vertices of a surface, and stores its ties.
pub(crate) fn apply(options: &Options, connectivity: &Connectivity, surface: &mut Surface) -> Held {
    let Options { locks, lock_boundary, .. } = options;
    let mut held = Held::default();
    for v in (0..surface.vertex_count()).map(VertexId::new) {
        let on_boundary = *lock_boundary && connectivity.marks(v).boundary();
        let lock = locks.of(v);
        match if on_boundary { Lock::Locked } else { lock } {
            Lock::Free => {}
            Lock::Protected => {
                surface.flag(v, Flags::PROTECTED);
                held.protected += 1;
            }
            Lock::Locked => {
                surface.flag(v, Flags::PINNED.or(Flags::HELD));
                held.locked += 1;
            }
        }
    }
    let mut ties = Vec::new();
    for tie in locks.ties.iter().filter(|tie| tie.len() > 1) {
        let few = tie.len() <= MOST_MEMBERS;
        let flag = if few { Flags::TIED } else { Flags::PINNED }.or(Flags::HELD);
        tie.iter().for_each(|&v| surface.flag(v, flag));
        if few {
            held.tied += tie.len();
            ties.push(tie.clone());
        } else {
            held.locked += tie.len();
        }
    }
    surface.ties = Ties::new(ties);
    surface.protection = options.protection_of_cost();
    held
}
