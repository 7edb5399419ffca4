//! What must stay when a mesh is coarsened: where components meet, and where the surface ends.

use std::ops::ControlFlow;

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, Lock, Locks, Mesh, Side, Twin, VertexId};
use robust::{Coord3D, orient3d};

use crate::check::{CheckOptions, check};
use crate::finding::{Finding, Kind, Touch, TouchKind};
use crate::kinds::Kinds;
use crate::objects::ObjectsBy;
use crate::places::Places;

/// What shall stay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LockOptions {
    /// Where components meet, of one object or of two: components are what moves apart.
    pub contacts: bool,
    /// What the vertices of boundary edges are; [`Lock::Free`] for nothing of their own.
    pub boundary: Lock,
}

/// Why a vertex is not free.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LockReason {
    /// A face at it passes through one of another component: protected.
    Crossing,
    /// A face at it lies in one plane with one of another component, over it: protected.
    Overlap,
    /// It, or a face at it, touches another component elsewhere than at its vertices: protected.
    Touching,
    /// Faces of two objects share it: protected.
    SharedVertex,
    /// It is at the place of other vertices: tied to them.
    SharedPlace,
    /// It is at a boundary edge: what [`LockOptions::boundary`] says.
    Boundary,
}

impl LockReason {
    /// Every reason, the stronger first.
    pub const ALL: [Self; 6] = [
        Self::Crossing,
        Self::Overlap,
        Self::Touching,
        Self::SharedVertex,
        Self::SharedPlace,
        Self::Boundary,
    ];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Crossing => "crossing",
            Self::Overlap => "overlap",
            Self::Touching => "touching",
            Self::SharedVertex => "shared-vertex",
            Self::SharedPlace => "shared-place",
            Self::Boundary => "boundary",
        }
    }
}

/// What must stay, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Locking {
    /// For the simplifier.
    pub locks: Locks,
    /// The strongest reason of every vertex that is not free.
    pub reasons: Vec<Option<LockReason>>,
}

impl Locking {
    /// So many vertices, all free.
    pub fn free(vertices: usize) -> Self {
        let locks = Locks { of_vertex: vec![Lock::Free; vertices], ties: Vec::new() };
        Self { locks, reasons: vec![None; vertices] }
    }

    /// How many vertices are not free for this reason before all others.
    pub fn count(&self, reason: LockReason) -> usize {
        self.reasons.iter().filter(|of| **of == Some(reason)).count()
    }

    /// Holds a vertex at least as much as this, and keeps the stronger reason.
    pub fn hold(&mut self, vertex: VertexId, lock: Lock, reason: Option<LockReason>) {
        let of = &mut self.locks.of_vertex[vertex.index()];
        *of = lock.max(*of);
        let known = &mut self.reasons[vertex.index()];
        *known = [*known, reason].into_iter().flatten().min();
    }

    /// Makes the vertices of a tie as little free as the least free of them, drops the ties of what
    /// is locked, and those that are there twice.
    pub fn settle_ties(&mut self) {
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

/// What must stay of a mesh that has passed [`Mesh::validate`].
///
/// Vertices at one place are tied, of two components or of one. Vertices that named objects share and
/// those of faces that pass through those of another component, or lie over them in one plane, are
/// protected, so that the line where they meet moves late and little; so is a vertex that touches
/// another component elsewhere, and what it touches. None of these is locked: where a target is tight,
/// what is locked is paid for by all else, and more comes through there than locks save.
///
/// Cost: that of [`check`] for what meets, with contacts; else linear.
pub fn locks(mesh: &Mesh, options: &LockOptions) -> Locking {
    let mut hold = Hold { mesh, locking: Locking::free(mesh.positions.len()) };
    if options.contacts {
        let places = Places::of(&mesh.positions);
        hold.contacts(&places);
        hold.shared_vertices();
        hold.shared_places(&places);
    }
    if options.boundary != Lock::Free {
        hold.boundary(options.boundary);
    }
    hold.locking.settle_ties();
    hold.locking
}

/// Locks as they are found.
struct Hold<'m> {
    mesh: &'m Mesh,
    locking: Locking,
}

impl Hold<'_> {
    fn hold(&mut self, vertex: VertexId, reason: LockReason, lock: Lock) {
        self.locking.hold(vertex, lock, Some(reason));
    }

    fn contacts(&mut self, places: &Places) {
        let options = CheckOptions {
            kinds: Kinds::NONE.with(Kind::Contact),
            objects: ObjectsBy::Components,
            ..CheckOptions::default()
        };
        let mesh = self.mesh;
        let _ = check(mesh, &options, &mut |finding| {
            if let Finding::Contact { faces, touch, .. } = finding {
                self.contact(*faces, touch, places);
            }
            ControlFlow::Continue(())
        });
    }

    fn contact(&mut self, faces: [FaceId; 2], touch: &Touch, places: &Places) {
        let corners = faces.map(|face| self.mesh.faces[face.index()]);
        let [a, b] = corners.map(|face| face.map(|v| places.first(v)));
        let shared = a.iter().filter(|v| b.contains(v)).count();
        let reason = match touch.kind {
            TouchKind::Crossing => LockReason::Crossing,
            TouchKind::Overlap if shared == 3 => return,
            TouchKind::Overlap => LockReason::Overlap,
            // What is shared at vertices, ties keep.
            TouchKind::Vertex if shared == 1 => return,
            TouchKind::Edge if shared == 2 => return,
            TouchKind::Vertex | TouchKind::Edge => {
                self.touch(corners, DVec3::from(touch.place));
                return;
            }
        };
        corners.into_iter().flatten().for_each(|v| self.hold(v, reason, Lock::Protected));
    }

    /// The corners of each face with which it touches the other; all three where it is the inside
    /// of a face or an edge that is touched.
    fn touch(&mut self, [a, b]: [[VertexId; 3]; 2], place: DVec3) {
        for (one, other) in [(a, b), (b, a)] {
            let at = |v: VertexId| DVec3::from(self.mesh.positions[v.index()]);
            let plane = other.map(at);
            let touching: Vec<_> = one.into_iter().filter(|&v| in_plane(&plane, at(v))).collect();
            let by_corners = match touching[..] {
                [] => false,
                [only] => at(only) == place,
                _ => true,
            };
            let held = if by_corners { &touching[..] } else { &one };
            held.iter().for_each(|&v| self.hold(v, LockReason::Touching, Lock::Protected));
        }
    }

    /// Protects the vertices that faces of two named objects use.
    fn shared_vertices(&mut self) {
        let Some(objects) = &self.mesh.objects else { return };
        let mut of_vertex = vec![None; self.mesh.positions.len()];
        for (face, &object) in self.mesh.faces.iter().zip(&objects.of_face) {
            for &v in face {
                if *of_vertex[v.index()].get_or_insert(object) != object {
                    self.locking.hold(v, Lock::Protected, Some(LockReason::SharedVertex));
                }
            }
        }
    }

    /// Ties the vertices at each place with more than one that faces use.
    fn shared_places(&mut self, places: &Places) {
        let used = self.mesh.used_vertices();
        let ties = places.shared(|v| used[v.index()]);
        for &v in ties.iter().flatten() {
            // As free as its tie will be.
            self.hold(v, LockReason::SharedPlace, Lock::Free);
        }
        self.locking.locks.ties = ties;
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

/// Whether a point is in the plane of a triangle, exactly.
fn in_plane(&[a, b, c]: &[DVec3; 3], p: DVec3) -> bool {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    orient3d(coord(a), coord(b), coord(c), coord(p)) == 0.0
}

#[cfg(test)]
mod tests;
