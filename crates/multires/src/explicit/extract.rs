//! Static and dynamic extraction from the explicit MT, as published.

use std::collections::{BTreeSet, VecDeque};

use super::Explicit;
use crate::level::Level;
use crate::query::Criterion;
use crate::query::{Query, QueryError};
use crate::wedges::LevelWedges;

/// A mesh extracted from an [`Explicit`] model that follows a sequence of queries.
#[derive(Clone, Debug)]
pub struct ExplicitCut<'m> {
    mt: &'m Explicit,
    /// True for each applied update.
    applied: Vec<bool>,
    /// Triangles of the current mesh.
    present: BTreeSet<u32>,
}

impl Explicit {
    /// Returns the smallest mesh in which every triangle satisfies the query.
    /// # Errors
    /// The query is invalid.
    pub fn extract(&self, query: &Query<'_>) -> Result<Level, QueryError> {
        let mut cut = ExplicitCut::new(self);
        cut.refine(&Criterion::new(query, &self.frame)?);
        Ok(cut.level())
    }
}

#[cfg(test)]
impl Explicit {
    /// Returns the mesh in which exactly these nodes are split, if that is a cut.
    pub(crate) fn cut_of(&self, split: &BTreeSet<u32>) -> Option<Level> {
        let mut cut = ExplicitCut::new(self);
        let updates: Vec<u32> =
            split.iter().filter_map(|&node| self.splits[node as usize]).collect();
        updates.iter().for_each(|&update| cut.force(update));
        let made = cut.applied.iter().filter(|&&applied| applied).count();
        (made == updates.len()).then(|| cut.level())
    }
}

impl<'m> ExplicitCut<'m> {
    /// Creates a cut that starts as the base mesh, the coarsest level.
    pub fn new(mt: &'m Explicit) -> Self {
        let is_base = |&t: &u32| mt.triangles[t as usize].creator.is_none();
        // Triangles that are never created belong to the base; those never refined either are in
        // all levels.
        let present = (0..mt.triangles.len() as u32).filter(is_base).collect();
        Self { mt, applied: vec![false; mt.updates.len()], present }
    }

    /// Refines and coarsens the cut until it satisfies a query.
    /// # Errors
    /// The query is invalid.
    pub fn update(&mut self, query: &Query<'_>) -> Result<(), QueryError> {
        let criterion = Criterion::new(query, &self.mt.frame)?;
        self.refine(&criterion);
        self.coarsen(&criterion);
        Ok(())
    }

    /// Returns a copy of the current mesh.
    pub fn level(&self) -> Level {
        let faces = self.present.iter().map(|&t| self.mt.triangles[t as usize].nodes);
        let place = |node: u32| self.mt.positions[node as usize];
        let count = self.mt.positions.len();
        let mut level = Level::from_nodes(self.mt.frame, count, place, faces.collect());
        level.wedges = self.mt.wedges.as_ref().map(|all| LevelWedges {
            corners: self.present.iter().map(|&t| self.mt.corners[t as usize]).collect(),
            all: all.clone(),
        });
        level.with_exact(&self.mt.exact)
    }

    /// Applies a single update with all its dependencies.
    #[cfg(test)]
    pub(crate) fn force(&mut self, update: u32) {
        self.apply(update);
    }

    /// Static extraction: a breadth-first search over triangles, starting from the current ones.
    fn refine(&mut self, criterion: &Criterion<'_>) {
        let mut queue: VecDeque<u32> = self.present.iter().copied().collect();
        while let Some(triangle) = queue.pop_front() {
            if !self.present.contains(&triangle) || self.mt.is_valid(criterion, triangle) {
                continue;
            }
            if let Some(refiner) = self.mt.triangles[triangle as usize].refiner {
                queue.extend(self.apply(refiner));
            }
        }
    }

    /// Applies an update after its dependencies and returns the triangles they all create.
    fn apply(&mut self, update: u32) -> Vec<u32> {
        let mut made = Vec::new();
        let mut stack = vec![update];
        while let Some(&next) = stack.last() {
            let missing = |&&need: &&u32| !self.applied[need as usize];
            let update = &self.mt.updates[next as usize];
            if let Some(&first) = update.needs.iter().find(missing) {
                stack.push(first);
                continue;
            }
            stack.pop();
            if !std::mem::replace(&mut self.applied[next as usize], true) {
                for triangle in &update.coarse {
                    assert!(self.present.remove(triangle), "what it needs makes it");
                }
                self.present.extend(&update.fine);
                made.extend(&update.fine);
            }
        }
        made
    }

    /// Undoes every update that no other depends on and that the criterion does not require.
    fn coarsen(&mut self, criterion: &Criterion<'_>) {
        let mut leaves: Vec<u32> = (0..self.applied.len() as u32).collect();
        while let Some(leaf) = leaves.pop() {
            let update = &self.mt.updates[leaf as usize];
            let is_leaf = || update.fine.iter().all(|t| self.present.contains(t));
            if self.applied[leaf as usize]
                && is_leaf()
                && update.coarse.iter().all(|&t| self.mt.is_valid(criterion, t))
            {
                update.fine.iter().for_each(|t| assert!(self.present.remove(t)));
                self.present.extend(&update.coarse);
                self.applied[leaf as usize] = false;
                leaves.extend(&update.needs);
            }
        }
    }
}
