//! The mesh under check, with derived data that several checks share.

use std::borrow::Cow;
use std::cell::OnceCell;

use meshlod_mesh::{Connectivity, FaceId, Mesh, VertexId};

use super::CheckOptions;
use crate::intersect::{IntersectingPairs, SearchInput};
use crate::objects::Objects;
use crate::unique_positions::UniquePositions;

/// A mesh under check, with derived data that is computed when first needed.
pub struct Subject<'a> {
    pub mesh: &'a Mesh,
    options: &'a CheckOptions,
    /// Faces of the mesh; invalid ones are replaced by [`EXCLUDED`], so that face ids stay the
    /// same.
    pub faces: Cow<'a, [[VertexId; 3]]>,
    /// True if no face had to be excluded as invalid.
    pub all_valid: bool,
    connectivity: OnceCell<Connectivity>,
    unique: OnceCell<UniquePositions>,
    used: OnceCell<Vec<bool>>,
    objects: OnceCell<Objects>,
    intersecting_pairs: OnceCell<IntersectingPairs>,
}

/// Stand-in for an excluded face: it repeats a vertex, so that [`Connectivity`] skips it, and no
/// mesh has that vertex.
pub const EXCLUDED: [VertexId; 3] = [VertexId(u32::MAX); 3];

impl<'a> Subject<'a> {
    pub fn of(mesh: &'a Mesh, options: &'a CheckOptions) -> Self {
        let faces = valid_faces(mesh);
        Self {
            mesh,
            options,
            all_valid: matches!(faces, Cow::Borrowed(_)),
            faces,
            connectivity: OnceCell::new(),
            unique: OnceCell::new(),
            used: OnceCell::new(),
            objects: OnceCell::new(),
            intersecting_pairs: OnceCell::new(),
        }
    }

    pub fn connectivity(&self) -> &Connectivity {
        self.connectivity.get_or_init(|| Connectivity::new(&self.faces, self.mesh.positions.len()))
    }

    pub fn unique_positions(&self) -> &UniquePositions {
        self.unique.get_or_init(|| UniquePositions::of(&self.mesh.positions))
    }

    pub fn objects(&self) -> &Objects {
        self.objects.get_or_init(|| Objects::of(self.mesh, self.options.objects))
    }

    pub fn intersecting_pairs(&self) -> &IntersectingPairs {
        self.intersecting_pairs.get_or_init(|| {
            let input = SearchInput {
                positions: &self.mesh.positions,
                faces: &self.faces,
                connectivity: self.connectivity(),
                unique: self.unique_positions(),
                objects: self.objects(),
            };
            IntersectingPairs::of(&input, self.options.broad_phase)
        })
    }

    /// Returns a flag per vertex, true if any face uses the vertex, even an excluded face.
    pub fn used(&self) -> &[bool] {
        self.used.get_or_init(|| {
            let mut used = vec![false; self.mesh.positions.len()];
            for v in self.mesh.faces.iter().flatten() {
                if let Some(used) = used.get_mut(v.index()) {
                    *used = true;
                }
            }
            used
        })
    }

    /// Iterates over the valid faces with their ids.
    pub fn valid_faces(&self) -> impl Iterator<Item = (FaceId, [VertexId; 3])> + '_ {
        let faces = self.faces.iter().enumerate();
        faces.filter(|(_, face)| **face != EXCLUDED).map(|(f, &face)| (FaceId(f as u32), face))
    }
}

/// Returns the faces of a mesh, with those that have a missing or non-finite vertex replaced by
/// [`EXCLUDED`].
fn valid_faces(mesh: &Mesh) -> Cow<'_, [[VertexId; 3]]> {
    let count = mesh.positions.len();
    let finite = |v: &[f64; 3]| v.iter().all(|x| x.is_finite());
    let all_finite = mesh.positions.iter().all(finite);
    if all_finite && mesh.faces.iter().flatten().all(|v| v.index() < count) {
        return Cow::Borrowed(&mesh.faces);
    }
    let valid = |face: &[VertexId; 3]| {
        face.iter().all(|v| mesh.positions.get(v.index()).is_some_and(finite))
    };
    mesh.faces.iter().map(|face| if valid(face) { *face } else { EXCLUDED }).collect()
}
