//! A cut that follows queries at once, or one whose vertices move.

use std::time::Duration;

use meshlod::multires::{
    CutChange, Geomorph, HierarchyCut, Query, QueryError, SlotMesh, UpdateLimits,
};

use super::model::CutModel;

/// Cut of a model, with or without motion.
pub(super) enum Followed<'m> {
    Cut(Box<HierarchyCut<'m>>),
    Morph(Box<Geomorph<'m>>),
}

impl<'m> Followed<'m> {
    /// Starts at the coarsest level. Height fields, and models that nothing certifies, do not move.
    pub(super) fn new(model: &'m CutModel, motion: Option<Duration>) -> Self {
        let morph = motion.zip(model.contractions());
        let morph = morph.and_then(|(duration, levels)| Geomorph::new(levels, duration).ok());
        morph.map_or_else(
            || Self::Cut(Box::new(model.levels().cut())),
            |morph| Self::Morph(Box::new(morph)),
        )
    }

    pub(super) fn update(
        &mut self,
        query: &Query<'_>,
        limits: &UpdateLimits,
    ) -> Result<CutChange, QueryError> {
        match self {
            Self::Cut(cut) => cut.update(query, limits),
            Self::Morph(morph) => morph.update(query, limits),
        }
    }

    /// Moves vertices by the time that has passed, and returns whether any is still moving.
    pub(super) fn advance(&mut self, elapsed: Duration) -> bool {
        match self {
            Self::Cut(_) => false,
            Self::Morph(morph) => morph.advance(elapsed),
        }
    }

    /// Returns the moving cut; `None` if the cut changes at once.
    pub(super) fn morph(&self) -> Option<&Geomorph<'m>> {
        match self {
            Self::Cut(_) => None,
            Self::Morph(morph) => Some(morph),
        }
    }

    /// Returns the mesh that is drawn.
    pub(super) fn shown(&self) -> &dyn SlotMesh {
        match self {
            Self::Cut(cut) => cut.slot_mesh(),
            Self::Morph(morph) => &**morph,
        }
    }

    /// Returns the answer to the last query, which the drawn mesh moves towards.
    pub(super) fn goal(&self) -> &dyn SlotMesh {
        match self {
            Self::Cut(cut) => cut.slot_mesh(),
            Self::Morph(morph) => morph.goal(),
        }
    }
}
