//! Ways to simplify a mesh of many components, for comparison.

use anyhow::Result;
use meshlod::check::{ContactPolicy, LockOptions, fuse, locks};
use meshlod::mesh::{Labels, Lock, Locks, Mesh, VertexId, face_components};
use meshlod::simplify::{History, Options, Simplifier, Target};

use super::open::{lying_on, newly_open, open_sides, positions_after};
use crate::peer::simplify_with_border_lock;

/// A way to simplify a mesh of many components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// `qem` without locks.
    Plain(Values),
    /// Simplification by meshoptimizer with its border lock, using positions only.
    Peer,
    /// `qem` with locks where components meet.
    Locked(Values),
    /// `qem` with locks where components meet, after fusing components that intersect.
    Fused(Values),
}

/// Whether simplification keeps attributes and materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Values {
    /// Attributes and materials are kept.
    Kept,
    /// Attributes and materials are dropped.
    Dropped,
}

/// A simplified mesh with the figures about its size and open edges.
pub struct Level {
    /// The simplified mesh, with the components of the input as its objects.
    pub mesh: Mesh,
    /// True if the mesh has no more faces than requested.
    pub reached: bool,
    /// Number of edges that are open but were not in the input.
    pub newly_open: usize,
}

impl Way {
    /// All ways to simplify, in the order of the table.
    pub const ALL: [Self; 7] = [
        Self::Plain(Values::Kept),
        Self::Plain(Values::Dropped),
        Self::Peer,
        Self::Locked(Values::Kept),
        Self::Locked(Values::Dropped),
        Self::Fused(Values::Kept),
        Self::Fused(Values::Dropped),
    ];

    /// Returns whether attributes and materials are kept; meshoptimizer drops them.
    pub fn values(self) -> Values {
        match self {
            Self::Plain(values) | Self::Locked(values) | Self::Fused(values) => values,
            Self::Peer => Values::Dropped,
        }
    }

    /// Returns the name of this way in the table.
    pub fn name(self) -> String {
        let name = match self {
            Self::Plain(_) => "`qem`",
            Self::Peer => return "meshoptimizer".to_owned(),
            Self::Locked(_) => "locked",
            Self::Fused(_) => "fused and locked",
        };
        let bare = if self.values() == Values::Dropped { ", bare" } else { "" };
        format!("{name}{bare}")
    }

    /// Simplifies a mesh whose objects are its components to each of the target numbers of faces in
    /// turn, the largest first.
    pub fn levels(self, mesh: &Mesh, targets: &[usize]) -> Result<Vec<Level>> {
        match self {
            Self::Plain(values) => ours(mesh, values, Locks::default(), open_sides(mesh), targets),
            Self::Peer => Ok(targets.iter().map(|&faces| theirs(mesh, faces)).collect()),
            Self::Locked(values) => ours(mesh, values, contacts(mesh), open_sides(mesh), targets),
            Self::Fused(values) => {
                let known: Vec<_> = ends(&open_sides(mesh), &mesh.positions).collect();
                let (fused, _) = fuse(mesh, |_| true);
                let open = lying_on(open_sides(&fused), &fused, &known);
                ours(&fused, values, contacts(&fused), open, targets)
            }
        }
    }
}

/// Labels each connected component of a mesh as an object.
pub fn by_component(mut mesh: Mesh) -> Mesh {
    let (of_face, count) = face_components(&mesh.faces, mesh.positions.len());
    let names = (0..count).map(|component| component.to_string()).collect();
    mesh.objects = Some(Labels { names, of_face });
    mesh
}

fn contacts(mesh: &Mesh) -> Locks {
    locks(mesh, &LockOptions { contacts: Some(ContactPolicy::Tie), boundary: Lock::Free }).locks
}

/// Makes the levels in one run; the sides in `open` may stay open.
pub fn ours(
    mesh: &Mesh,
    values: Values,
    locks: Locks,
    open: Vec<[VertexId; 2]>,
    targets: &[usize],
) -> Result<Vec<Level>> {
    let mut mesh = mesh.clone();
    if values == Values::Dropped {
        mesh.attributes = None;
        mesh.materials = None;
    }
    let options = Options { locks, ..Options::default() };
    let mut simplifier = Simplifier::new(&mesh, &options)?;
    let mut history = History::default();
    let mut level = |&faces: &usize| {
        let report = simplifier.run(Target::Faces(faces), &mut history)?;
        let level = simplifier.level();
        let now = positions_after(&mesh, &history);
        let newly_open = newly_open(&level, ends(&open, &now));
        Ok(Level { mesh: level, reached: report.reached, newly_open })
    };
    targets.iter().map(&mut level).collect()
}

fn theirs(mesh: &Mesh, faces: usize) -> Level {
    let level = simplify_with_border_lock(mesh, faces);
    // Open borders are locked, so their vertices do not move.
    let newly_open = newly_open(&level, ends(&open_sides(mesh), &mesh.positions));
    Level { reached: level.faces.len() <= faces, mesh: level, newly_open }
}

fn ends(sides: &[[VertexId; 2]], positions: &[[f64; 3]]) -> impl Iterator<Item = [[f64; 3]; 2]> {
    sides.iter().map(|side| side.map(|v| positions[v.index()]))
}
