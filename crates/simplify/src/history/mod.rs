//! Every contraction written down, so that each can be undone exactly.

pub(crate) mod exact_volume;
pub(crate) mod progressive;
pub(crate) mod volume;

use meshlod_mesh::{FaceId, WedgeId};

use crate::engine::candidates::CandidateId;
use crate::engine::policy::Observe;
use crate::surface::contracted::Contracted;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// One contraction. Its lists run to the starts of the next one's.
#[derive(Clone, Copy, Debug)]
pub struct Contraction {
    /// What became one.
    pub contracted: Contracted,
    /// Which of them stayed, by its place among them.
    pub kept: u8,
    /// Where the kept one was before, in model units.
    pub from: [f64; 3],
    /// Where it is after.
    pub to: [f64; 3],
    moved: u32,
    died: u32,
    blended: u32,
}

/// A face corner that went from a removed vertex to the kept one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moved {
    pub(crate) corner: CandidateId,
    /// Its wedge before; any where the surface has none.
    pub(crate) wedge: WedgeId,
}

/// All contractions of a run, an observer. About 140 bytes a contraction, more with attributes.
#[derive(Clone, Debug, Default)]
pub struct History {
    contractions: Vec<Contraction>,
    moved: Vec<Moved>,
    died: Vec<FaceId>,
    blended: Vec<WedgeId>,
    /// The values of the blended wedges before, all layers of one after the other.
    values: Vec<f32>,
}

/// What the contractions' lists run through.
pub(crate) struct Lists {
    pub(crate) moved: Vec<Moved>,
    pub(crate) died: Vec<FaceId>,
    pub(crate) blended: Vec<WedgeId>,
    pub(crate) values: Vec<f32>,
}

impl Contraction {
    /// Where its moved corners, its dead faces and its blended wedges start.
    pub(crate) fn starts(&self) -> [u32; 3] {
        [self.moved, self.died, self.blended]
    }
}

impl History {
    /// The contractions, first to last.
    pub fn contractions(&self) -> &[Contraction] {
        &self.contractions
    }

    /// The faces that went with each contraction, first to last.
    pub fn died(&self, index: usize) -> &[FaceId] {
        let end = self.contractions.get(index + 1).map_or(self.died.len(), |c| c.died as usize);
        &self.died[self.contractions[index].died as usize..end]
    }

    /// How many faces went in all.
    pub(crate) fn all_died(&self) -> usize {
        self.died.len()
    }

    pub(crate) fn into_lists(self) -> Lists {
        let Self { moved, died, blended, values, .. } = self;
        Lists { moved, died, blended, values }
    }
}

impl Observe for History {
    fn before(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        let kept = hood.contracted()[placed.kept];
        self.contractions.push(Contraction {
            contracted: *hood.contracted(),
            kept: placed.kept as u8,
            from: surface.position(kept).into(),
            to: placed.position.into(),
            moved: self.moved.len() as u32,
            died: self.died.len() as u32,
            blended: self.blended.len() as u32,
        });
        let moved = hood.spokes().iter().filter(|spoke| spoke.owner() != placed.kept);
        self.moved.extend(moved.map(|spoke| Moved {
            corner: CandidateId::side(spoke.face, spoke.corner()),
            wedge: surface.wedges.as_ref().map_or(WedgeId(0), |w| w.at(spoke.face, spoke.corner())),
        }));
        self.died.extend(hood.dying().iter().map(|dying| dying.face));
        if let Some(wedges) = &surface.wedges {
            for wedge in wedges.changing(hood, placed.kept) {
                self.blended.push(wedge);
                self.values.extend(wedges.values(wedge));
            }
        }
    }

    /// Written down as the contraction of an edge with all faces, after which nothing has moved.
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
            died: self.died.len() as u32,
            blended: self.blended.len() as u32,
        });
        self.died.extend_from_slice(faces);
    }
}
