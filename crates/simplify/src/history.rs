//! Every contraction written down, so that each can be undone exactly.

use glam::DVec3;
use meshlod_mesh::{FaceId, Mesh, VertexId, WedgeId};

use crate::candidates::CandidateId;
use crate::contracted::Contracted;
use crate::level::level;
use crate::neighbourhood::Neighbourhood;
use crate::policy::Observe;
use crate::simplifier::Simplifier;
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
    pub(crate) vertex: VertexId,
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
            vertex: hood.contracted()[spoke.owner()],
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
}

/// A simplified mesh on its way back, one contraction at a time.
pub struct Rewind<'m> {
    mesh: &'m Mesh,
    surface: Surface,
    history: History,
}

impl<'m> Rewind<'m> {
    /// Starts from where the simplifier is; `None` where the history has not observed all its
    /// contractions.
    pub fn new(simplifier: Simplifier<'m>, history: History) -> Option<Self> {
        if simplifier.live_faces() + history.died.len() != simplifier.first_faces() {
            return None;
        }
        let (mesh, surface) = simplifier.into_surface();
        Some(Self { mesh, surface, history })
    }

    /// How many contractions are left to undo.
    pub fn remaining(&self) -> usize {
        self.history.contractions.len()
    }

    /// Undoes the last contraction; false when none is left.
    pub fn undo(&mut self) -> bool {
        let history = &mut self.history;
        let Some(last) = history.contractions.pop() else { return false };
        if let Some(wedges) = &mut self.surface.wedges {
            // Backwards: a wedge that was blended twice gets its first value last.
            for wedge in history.blended.drain(last.blended as usize..).rev() {
                let start = history.values.len() - wedges.width();
                wedges.restore(wedge, &history.values[start..]);
                history.values.truncate(start);
            }
        }
        let kept = last.contracted[last.kept as usize];
        self.surface.expand(
            (kept, DVec3::from(last.from)),
            &history.moved[last.moved as usize..],
            &history.died[last.died as usize..],
        );
        history.moved.truncate(last.moved as usize);
        history.died.truncate(last.died as usize);
        true
    }

    /// The mesh as it is now, as [`Simplifier::level`] gives it.
    pub fn level(&self) -> Mesh {
        level(self.mesh, &self.surface)
    }
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::sample;

    use super::*;
    use crate::{Method, Options, Target};

    /// Goes down in steps, comes back, and meets every level again to the bit.
    fn there_and_back(mesh: &Mesh, method: Method) {
        let mut history = History::default();
        let mut simplifier =
            Simplifier::new(mesh, &Options { method, ..Options::default() }).unwrap();
        let mut levels = vec![simplifier.level()];
        for ratio in [0.8, 0.5, 0.2, 0.05] {
            simplifier.run(Target::Ratio(ratio), &mut history).unwrap();
            levels.push(simplifier.level());
        }
        let mut rewind = Rewind::new(simplifier, history).unwrap();
        while let Some(level) = levels.pop() {
            while rewind.level().faces.len() < level.faces.len() {
                assert!(rewind.undo());
            }
            assert_eq!(rewind.level(), level);
        }
        assert_eq!(rewind.remaining(), 0);
    }

    #[test]
    fn undoing_gives_every_level_back_to_the_bit() {
        for method in Method::ALL {
            there_and_back(&sample::torus(400), method);
            there_and_back(&sample::terrain(400), method);
        }
    }

    #[test]
    fn undoing_gives_attributes_back_to_the_bit() {
        for method in Method::ALL {
            there_and_back(&sample::fish(500), method);
        }
    }
}
