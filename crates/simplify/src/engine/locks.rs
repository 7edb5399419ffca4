//! Application of vertex locks to a surface, as vertex flags and ties.

use meshlod_mesh::{Connectivity, Lock, Locks, Mesh, VertexId};

use crate::options::{Options, SimplifyError};
use crate::surface::ties::{MOST_MEMBERS, Ties};
use crate::surface::{Flags, Surface};

/// Numbers of input vertices that are locked, protected or tied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Held {
    /// Number of vertices that stay in place, by their own lock or as part of a locked boundary.
    pub locked: usize,
    /// Number of protected vertices, which cost more to move, without those that are locked.
    pub protected: usize,
    /// Number of vertices that move together with others, whether locked or not.
    pub tied: usize,
}

impl Held {
    /// Adds the counts of another mesh that the scene shows `copies` times.
    pub fn add(&mut self, other: &Self, copies: usize) {
        self.locked += copies * other.locked;
        self.protected += copies * other.protected;
        self.tied += copies * other.tied;
    }
}

/// Factor on the distance that a protected vertex moves. Pixels over 24 views that show what the
/// original hides, with `qem`: fish-clown.obj with its crossings protected, at 25 and 10 %, and
/// fused with its lines protected; suzanne.obj at 50 %:
///
/// | factor | 25 % | 10 % | fused 25 % | fused 10 % | suzanne |
/// |---|--:|--:|--:|--:|--:|
/// | 1 | 12,158 | 49,399 | 2,529 | 22,116 | 10,206 |
/// | 2 | 7,468 | 25,541 | 1,692 | 14,629 | 391 |
/// | 3 | 6,546 | 23,601 | 1,856 | 11,509 | 143 |
/// | 5 | 6,294 | 96,156 | | | 376 |
///
/// From 5 on everything unprotected is contracted first, whatever the cost.
pub(crate) const PROTECTION: f64 = 2.0;

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
