//! A cut that follows queries at once, or one whose vertices move.

use std::time::Duration;

use meshlod::multires::{
    CutChange, Geomorph, HierarchyCut, Query, QueryError, UpdateLimits, VertexValues,
};

use super::CutModel;

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

    /// Returns true if vertices move to where a split or merge takes them.
    pub(super) fn moves(&self) -> bool {
        matches!(self, Self::Morph(_))
    }

    /// Appends the slots that the last update or advance has written.
    pub(super) fn touched_slots(&self, to: &mut Vec<u32>) {
        match self {
            Self::Cut(cut) => to.extend(cut.touched_slots()),
            Self::Morph(morph) => to.extend(morph.touched_slots()),
        }
    }

    /// Appends the nodes that the last update or advance has moved.
    pub(super) fn moved_nodes(&self, to: &mut Vec<u32>) {
        if let Self::Morph(morph) = self {
            to.extend(morph.moved());
        }
    }

    /// Sets `to` to what a node that has moved is now.
    pub(super) fn values(&self, node: u32, to: &mut VertexValues) {
        if let Self::Morph(morph) = self {
            morph.values(node, to);
        }
    }

    /// Returns the vertices of the triangle that a slot shows: wedges, or nodes without wedges.
    pub(super) fn vertices(&self, slot: u32) -> Option<[u32; 3]> {
        match self {
            Self::Cut(cut) => cut.wedges(slot).or_else(|| cut.triangle(slot)),
            Self::Morph(morph) => morph.wedges(slot).or_else(|| morph.triangle(slot)),
        }
    }

    pub(super) fn slots(&self) -> usize {
        match self {
            Self::Cut(cut) => cut.slots(),
            Self::Morph(morph) => morph.slots(),
        }
    }

    /// Returns the number of faces of the cut that is moved towards.
    pub(super) fn face_count(&self) -> usize {
        match self {
            Self::Cut(cut) => cut.face_count(),
            Self::Morph(morph) => morph.goal().face_count(),
        }
    }

    /// Returns the number of faces that are drawn.
    pub(super) fn shown_faces(&self) -> usize {
        match self {
            Self::Cut(cut) => cut.face_count(),
            Self::Morph(morph) => morph.face_count(),
        }
    }

    /// Returns the number of vertices of the cut that is moved towards.
    pub(super) fn vertex_count(&self) -> usize {
        match self {
            Self::Cut(cut) => cut.vertex_count(),
            Self::Morph(morph) => morph.goal().vertex_count(),
        }
    }
}
