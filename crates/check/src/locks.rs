//! Vertex locks for simplification, for places where components meet and where the surface ends.

use std::ops::ControlFlow;

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, Lock, Locks, Mesh, Side, Twin, VertexId};
use robust::{Coord3D, orient3d};

use crate::check::{CheckOptions, check};
use crate::finding::{Finding, Intersection, IntersectionKind, Kind};
use crate::kinds::Kinds;
use crate::objects::ObjectsBy;
use crate::unique_positions::UniquePositions;

/// Options for choosing vertex locks; see [`locks`](locks()).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct LockOptions {
    /// Treatment of the vertices where components meet, even components of one object, which could
    /// otherwise drift apart; `None` leaves them free.
    pub contacts: Option<ContactPolicy>,
    /// Lock applied to the vertices of boundary edges; [`Lock::Free`] leaves them free.
    pub boundary: Lock,
}

/// Treatment of the vertices at contacts, where components meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum ContactPolicy {
    /// Vertices at one position are tied, and those where components cross, overlap or touch are
    /// protected.
    #[default]
    Tie,
    /// All of them are protected, so that they are contracted late. Vertices at one position may
    /// separate.
    Protect,
    /// All of them are locked: no vertex of a contact is a candidate for contraction [CC05].
    Exclude,
}

impl ContactPolicy {
    /// All treatments of contacts, the default first.
    pub const ALL: [Self; 3] = [Self::Tie, Self::Protect, Self::Exclude];

    /// Returns the name of the policy on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tie => "tie",
            Self::Protect => "protect",
            Self::Exclude => "exclude",
        }
    }

    /// Returns the lock on a vertex of a contact that is not tied.
    fn lock(self) -> Lock {
        match self {
            Self::Tie | Self::Protect => Lock::Protected,
            Self::Exclude => Lock::Locked,
        }
    }
}

meshlod_mesh::by_name!(ContactPolicy, "policies for contacts");

/// Reason why a vertex is restricted during simplification.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LockReason {
    /// A face at the vertex passes through a face of another component.
    Crossing,
    /// A face at the vertex overlaps a coplanar face of another component.
    Overlap,
    /// The vertex or a face at it touches another component elsewhere than at its vertices.
    Touching,
    /// Faces of two objects share the vertex.
    SharedVertex,
    /// Other vertices are at the same position.
    SharedPosition,
    /// The vertex is on a boundary edge; it gets the lock [`LockOptions::boundary`].
    Boundary,
}

impl LockReason {
    /// All reasons to hold a vertex, strongest first.
    pub const ALL: [Self; 6] = [
        Self::Crossing,
        Self::Overlap,
        Self::Touching,
        Self::SharedVertex,
        Self::SharedPosition,
        Self::Boundary,
    ];

    /// Returns the name of the reason as used in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Crossing => "crossing",
            Self::Overlap => "overlap",
            Self::Touching => "touching",
            Self::SharedVertex => "shared-vertex",
            Self::SharedPosition => "shared-place",
            Self::Boundary => "boundary",
        }
    }
}

/// Locks of the vertices of a mesh, with the reason for each lock.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexLocks {
    /// Locks to pass to the simplifier.
    pub locks: Locks,
    /// Strongest reason for the lock of each vertex; `None` if the vertex is free.
    pub reasons: Vec<Option<LockReason>>,
}

impl VertexLocks {
    /// Creates locks for the given number of vertices that leave all of them free.
    pub fn free(vertices: usize) -> Self {
        let locks = Locks { of_vertex: vec![Lock::Free; vertices], ties: Vec::new() };
        Self { locks, reasons: vec![None; vertices] }
    }

    /// Returns the number of vertices that are held mainly for this reason.
    pub fn count(&self, reason: LockReason) -> usize {
        self.reasons.iter().filter(|of| **of == Some(reason)).count()
    }

    /// Raises the lock of a vertex to at least `lock`, and keeps the stronger of its two reasons.
    pub fn hold(&mut self, vertex: VertexId, lock: Lock, reason: Option<LockReason>) {
        let of = &mut self.locks.of_vertex[vertex.index()];
        *of = lock.max(*of);
        let known = &mut self.reasons[vertex.index()];
        *known = [*known, reason].into_iter().flatten().min();
    }

    /// Gives all vertices of a tie the strictest lock among them, and drops duplicate ties and ties
    /// of locked vertices.
    pub fn resolve_ties(&mut self) {
        let of_vertex = &mut self.locks.of_vertex;
        self.locks.ties.retain(|tie| {
            let worst = tie.iter().map(|v| of_vertex[v.index()]).max().unwrap_or_default();
            tie.iter().for_each(|v| of_vertex[v.index()] = worst);
            worst != Lock::Locked
        });
        self.locks.ties.sort_unstable();
        self.locks.ties.dedup();
    }
}

/// Finds the vertices to lock, protect or tie when a mesh is simplified; the mesh must have passed
/// [`Mesh::validate`].
///
/// By [`ContactPolicy::Tie`], vertices at one position are tied, whether of one component or of
/// two. Vertices that named objects share are protected, as are those of faces that pass through,
/// or overlap in a plane with, a face of another component, so that the contact line moves late and
/// little. A vertex that touches another component elsewhere is protected together with what it
/// touches. None of these is locked: if the target is tight, the rest of the mesh pays for locked
/// vertices, and more components then break through there than the locks prevent. The other
/// policies protect or lock all these vertices alike.
///
/// Cost: that of [`check`] for contacts if `contacts` is set; else linear.
/// # References
/// [CC05] section 3 for [`ContactPolicy::Exclude`]; differs: faces that meet are found exactly,
/// not by the cubes of an octree.
pub fn locks(mesh: &Mesh, options: &LockOptions) -> VertexLocks {
    let policy = options.contacts.unwrap_or_default();
    let mut hold = Hold { mesh, policy, locking: VertexLocks::free(mesh.positions.len()) };
    if options.contacts.is_some() {
        let unique = UniquePositions::of(&mesh.positions);
        hold.contacts(&unique);
        hold.shared_vertices();
        hold.shared_positions(&unique);
    }
    if options.boundary != Lock::Free {
        hold.boundary(options.boundary);
    }
    hold.locking.resolve_ties();
    hold.locking
}

/// Collects the locks.
struct Hold<'m> {
    mesh: &'m Mesh,
    policy: ContactPolicy,
    locking: VertexLocks,
}

impl Hold<'_> {
    fn hold(&mut self, vertex: VertexId, reason: LockReason, lock: Lock) {
        self.locking.hold(vertex, lock, Some(reason));
    }

    fn contacts(&mut self, unique: &UniquePositions) {
        let options = CheckOptions {
            kinds: Kinds::NONE.with(Kind::Contact),
            objects: ObjectsBy::Components,
            ..CheckOptions::default()
        };
        let mesh = self.mesh;
        let _ = check(mesh, &options, &mut |finding| {
            if let Finding::Contact { faces, intersection, .. } = finding {
                self.contact(*faces, intersection, unique);
            }
            ControlFlow::Continue(())
        });
    }

    fn contact(&mut self, faces: [FaceId; 2], found: &Intersection, unique: &UniquePositions) {
        let corners = faces.map(|face| self.mesh.faces[face.index()]);
        let [a, b] = corners.map(|face| face.map(|v| unique.representative(v)));
        let shared = a.iter().filter(|v| b.contains(v)).count();
        let reason = match found.kind {
            IntersectionKind::Crossing => LockReason::Crossing,
            IntersectionKind::Overlap if shared == 3 => return,
            IntersectionKind::Overlap => LockReason::Overlap,
            // Shared vertices are held as such.
            IntersectionKind::Point if shared == 1 => return,
            IntersectionKind::Segment if shared == 2 => return,
            IntersectionKind::Point | IntersectionKind::Segment => {
                self.touch(corners, DVec3::from(found.point));
                return;
            }
        };
        corners.into_iter().flatten().for_each(|v| self.hold(v, reason, self.policy.lock()));
    }

    /// Holds the corners with which each face touches the other; all three if its interior or an
    /// edge is touched.
    fn touch(&mut self, [a, b]: [[VertexId; 3]; 2], point: DVec3) {
        for (one, other) in [(a, b), (b, a)] {
            let at = |v: VertexId| DVec3::from(self.mesh.positions[v.index()]);
            let plane = other.map(at);
            let touching: Vec<_> = one.into_iter().filter(|&v| in_plane(&plane, at(v))).collect();
            let by_corners = match touching[..] {
                [] => false,
                [only] => at(only) == point,
                _ => true,
            };
            let held = if by_corners { &touching[..] } else { &one };
            held.iter().for_each(|&v| self.hold(v, LockReason::Touching, self.policy.lock()));
        }
    }

    /// Holds the vertices that faces of two named objects share.
    fn shared_vertices(&mut self) {
        let Some(objects) = &self.mesh.objects else { return };
        let mut of_vertex = vec![None; self.mesh.positions.len()];
        for (face, &object) in self.mesh.faces.iter().zip(&objects.of_face) {
            for &v in face {
                if *of_vertex[v.index()].get_or_insert(object) != object {
                    self.locking.hold(v, self.policy.lock(), Some(LockReason::SharedVertex));
                }
            }
        }
    }

    /// Ties the used vertices at each position that has more than one, or holds each by itself.
    fn shared_positions(&mut self, unique: &UniquePositions) {
        let used = self.mesh.used_vertices();
        let ties = unique.groups(|v| used[v.index()]);
        let is_tied = self.policy == ContactPolicy::Tie;
        // A tie decides the lock of its vertices.
        let lock = if is_tied { Lock::Free } else { self.policy.lock() };
        ties.iter().flatten().for_each(|&v| self.hold(v, LockReason::SharedPosition, lock));
        if is_tied {
            self.locking.locks.ties = ties;
        }
    }

    fn boundary(&mut self, lock: Lock) {
        let faces = &self.mesh.faces;
        let connectivity = Connectivity::new(faces, self.mesh.positions.len());
        for side in (0..faces.len()).flat_map(|f| (0..3).map(move |k| Side::new(FaceId::new(f), k)))
        {
            if connectivity.twin(side) == Twin::Boundary {
                side.ends(faces).into_iter().for_each(|v| self.hold(v, LockReason::Boundary, lock));
            }
        }
    }
}

/// Returns true if a point is exactly in the plane of a triangle.
fn in_plane(&[a, b, c]: &[DVec3; 3], p: DVec3) -> bool {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    orient3d(coord(a), coord(b), coord(c), coord(p)) == 0.0
}

#[cfg(test)]
mod tests;
