//! Recording of all contractions of a simplification, so that each can be undone exactly.

pub(crate) mod exact_volume;
pub(crate) mod progressive;
pub(crate) mod volume;

use meshlod_mesh::{FaceId, WedgeId};

use crate::engine::policy::Observe;
use crate::surface::candidate_states::CandidateId;
use crate::surface::contracted::Contracted;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// A recorded edge contraction, or the removal of a connected component.
#[derive(Clone, Copy, Debug)]
pub struct Contraction {
    /// The vertices that were merged.
    pub contracted: Contracted,
    /// Index, among the contracted vertices, of the one that remained.
    pub kept: u8,
    /// Position of the remaining vertex before the contraction, in model units.
    pub from: [f64; 3],
    /// Position of the remaining vertex after the contraction, in model units.
    pub to: [f64; 3],
    moved: u32,
    removed_faces: u32,
    blended: u32,
}

/// A face corner that moved from a removed vertex to the one that remained.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moved {
    pub(crate) corner: CandidateId,
    /// Wedge at the corner before the contraction; arbitrary if the surface has no attributes.
    pub(crate) wedge: WedgeId,
}

/// History of a simplification run, recorded as an observer. It takes about 140 bytes per
/// contraction, more with attributes.
#[derive(Clone, Debug, Default)]
pub struct History {
    contractions: Vec<Contraction>,
    moved: Vec<Moved>,
    removed_faces: Vec<FaceId>,
    blended: Vec<WedgeId>,
    /// Values of the blended wedges before, all layers of a wedge in sequence.
    values: Vec<f32>,
}

/// Data of all contractions in common lists, into which each contraction has start indices.
pub(crate) struct Lists {
    pub(crate) moved: Vec<Moved>,
    pub(crate) removed_faces: Vec<FaceId>,
    pub(crate) blended: Vec<WedgeId>,
    pub(crate) values: Vec<f32>,
}

impl Contraction {
    /// Returns the start indices of the contraction's moved corners, removed faces and blended
    /// wedges; each list ends where the next contraction's starts.
    pub(crate) fn starts(&self) -> [u32; 3] {
        [self.moved, self.removed_faces, self.blended]
    }
}

impl History {
    /// Returns the recorded contractions in the order in which they were made.
    pub fn contractions(&self) -> &[Contraction] {
        &self.contractions
    }

    /// Returns the faces that the contraction with this index removed.
    pub fn removed_faces(&self, index: usize) -> &[FaceId] {
        let end = self
            .contractions
            .get(index + 1)
            .map_or(self.removed_faces.len(), |c| c.removed_faces as usize);
        &self.removed_faces[self.contractions[index].removed_faces as usize..end]
    }

    /// Returns the number of faces removed by all contractions.
    pub(crate) fn removed_face_count(&self) -> usize {
        self.removed_faces.len()
    }

    pub(crate) fn into_lists(self) -> Lists {
        let Self { moved, removed_faces, blended, values, .. } = self;
        Lists { moved, removed_faces, blended, values }
    }
}

impl Observe for History {
    fn before(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let kept = neighbourhood.contracted()[placed.kept];
        self.contractions.push(Contraction {
            contracted: *neighbourhood.contracted(),
            kept: placed.kept as u8,
            from: surface.position(kept).into(),
            to: placed.position.into(),
            moved: self.moved.len() as u32,
            removed_faces: self.removed_faces.len() as u32,
            blended: self.blended.len() as u32,
        });
        let moved = neighbourhood.spokes().iter().filter(|spoke| spoke.owner() != placed.kept);
        self.moved.extend(moved.map(|spoke| Moved {
            corner: CandidateId::side(spoke.face, spoke.corner()),
            wedge: surface.wedges.as_ref().map_or(WedgeId(0), |w| w.at(spoke.face, spoke.corner())),
        }));
        self.removed_faces.extend(neighbourhood.removed_faces().iter().map(|removed| removed.face));
        if let Some(wedges) = &surface.wedges {
            for wedge in wedges.changing(neighbourhood, placed.kept) {
                self.blended.push(wedge);
                self.values.extend(wedges.values(wedge));
            }
        }
    }

    /// Records the removal as the contraction of an edge in which all faces disappear and nothing
    /// moves.
    fn vanish(&mut self, surface: &Surface, faces: &[FaceId]) {
        let Some(&first) = faces.first() else { return };
        let [v0, v1, _] = surface.face(first);
        let place = surface.position(v0).into();
        self.contractions.push(Contraction {
            contracted: Contracted::edge([v0, v1]),
            kept: 0,
            from: place,
            to: place,
            moved: self.moved.len() as u32,
            removed_faces: self.removed_faces.len() as u32,
            blended: self.blended.len() as u32,
        });
        self.removed_faces.extend_from_slice(faces);
    }
}
