//! Static extraction by the face list.

use super::Subtree;
use crate::frame::Length16;
use crate::level::Level;
use crate::model::Model;
use crate::query::Criterion;
use crate::query::{Query, QueryError};

/// Meshes out of a [`Model`] by its face list, one after the other in the same room.
#[derive(Clone, Debug)]
pub struct Extractor<'m> {
    pub(super) model: &'m Model,
    level: Level,
    /// What stands above each leaf, as the level numbers it.
    above: Vec<u32>,
    /// The updates made, as a walk down meets them.
    made: Vec<u32>,
    stack: Vec<Subtree>,
    /// By update: whether it is to be made.
    pub(super) chosen: Vec<bool>,
}

/// So many nodes are judged before any of them is gone down from: their loads overlap, where one by
/// one each would wait for memory before the next is known. Million faces a second on the dragon by
/// one tolerance, for 1, 4 and 16: 2.7k faces 13.8, 15.8, 17.4; 17.5k faces 8.9, 7.4, 17.6; 174k faces
/// 13.8, 9.5, 10.7, where order counts for more.
const AT_ONCE: usize = 16;

impl<'m> Extractor<'m> {
    pub(crate) fn new(model: &'m Model) -> Self {
        Self {
            model,
            level: Level::new(*model.implicit().frame()),
            above: vec![0; model.faces().leaves()],
            made: Vec::new(),
            stack: Vec::new(),
            chosen: Vec::new(),
        }
    }

    /// The mesh of one tolerance everywhere, in model units: the answer of [`Query::uniform`], but
    /// nothing is looked at but errors, which are monotone along every dependency.
    ///
    /// Each face is there from the error of the update that brings it down to zero.
    /// # Errors
    /// What is below 0 or no number.
    pub fn uniform(&mut self, tolerance: f64) -> Result<&Level, QueryError> {
        Query::uniform(tolerance).validate()?;
        let mt = self.model.implicit();
        let most = mt.frame().length(tolerance);
        // The greatest code that is within: codes are in the order of lengths.
        let within = Length16::up(most);
        let within = if within.get() > most { within.0.checked_sub(1) } else { Some(within.0) };
        Ok(self.write(|update, _| Some(mt.error(update).0) > within))
    }

    /// A cut that meets the query, found without looking at any neighbour.
    ///
    /// It is not the smallest: the notes say by how much.
    /// # Errors
    /// A query that is none, or that the model was not [saturated](Model::saturate) for.
    pub fn saturated(&mut self, query: &Query<'_>) -> Result<&Level, QueryError> {
        let mt = self.model.implicit();
        let criterion = Criterion::new(query, mt.frame())?;
        let balls = criterion.viewpoint().and_then(|eye| self.model.saturated_at(eye.slope));
        let balls = balls.ok_or(QueryError::NotSaturated)?;
        Ok(self.write(|update, node| {
            mt.is_fused_with_parent(update) || criterion.refines(&balls.ball(mt, update, node))
        }))
    }

    /// The smallest cut that meets the query, by what updates need of each other.
    /// # Errors
    /// A query that is none.
    pub fn exact(&mut self, query: &Query<'_>) -> Result<&Level, QueryError> {
        let criterion = Criterion::new(query, self.model.implicit().frame())?;
        self.choose_wanted(&criterion);
        self.model.dependencies().close(self.model.implicit(), &mut self.chosen);
        Ok(self.write_chosen())
    }

    /// What the wanted updates give alone, without what they need: how small a cut could be at best. It
    /// is there to measure rules by; faces of it may meet in edges of four or lie on each other.
    /// # Errors
    /// A query that is none.
    pub fn wanted(&mut self, query: &Query<'_>) -> Result<&Level, QueryError> {
        let criterion = Criterion::new(query, self.model.implicit().frame())?;
        self.choose_wanted(&criterion);
        Ok(self.write_chosen())
    }

    /// The mesh of the chosen updates, which must hold all above each of them.
    pub(super) fn write_chosen(&mut self) -> &Level {
        let chosen = std::mem::take(&mut self.chosen);
        self.write(|update, _| chosen[update as usize]);
        self.chosen = chosen;
        &self.level
    }

    /// Chooses what the need wants: the balls nest down the forest.
    fn choose_wanted(&mut self, criterion: &Criterion<'_>) {
        let mt = self.model.implicit();
        let mut chosen = std::mem::take(&mut self.chosen);
        chosen.clear();
        chosen.resize(mt.update_count(), false);
        let refines = |update, node| {
            mt.is_fused_with_parent(update) || criterion.refines(&mt.ball_at(update, node))
        };
        self.descend(refines, |below, is_wanted| {
            if is_wanted {
                chosen[below.start as usize] = true;
            }
        });
        self.chosen = chosen;
    }

    /// The mesh after the updates of which `is_made` says so. It is asked about an update and its node
    /// where those above are made.
    fn write(&mut self, is_made: impl FnMut(u32, u32) -> bool) -> &Level {
        let mt = self.model.implicit();
        let (mut level, mut above, mut made) = (
            std::mem::replace(&mut self.level, Level::new(*mt.frame())),
            std::mem::take(&mut self.above),
            std::mem::take(&mut self.made),
        );
        level.clear();
        made.clear();
        self.descend(is_made, |below, is_made| {
            if is_made {
                made.push(below.start);
                return;
            }
            let leaves = below.leaf as usize..(below.leaf + below.end - below.start + 1) as usize;
            above[leaves].fill(level.nodes.len() as u32);
            level.nodes.push(below.node);
            level.positions.push(mt.stored_position(below.node));
        });
        level.exact = mt.exact().clone();
        self.model.faces().write(&made, &above, &mut level.faces);
        (self.level, self.above, self.made) = (level, above, made);
        &self.level
    }

    /// Goes down from the roots as far as `is_made` lets it, and tells of every node on the way.
    fn descend(
        &mut self,
        mut is_made: impl FnMut(u32, u32) -> bool,
        mut visit: impl FnMut(Subtree, bool),
    ) {
        let Self { model, stack, .. } = self;
        let mt = model.implicit();
        let mut leaf = 0;
        for (node, [start, end]) in mt.roots() {
            stack.push(Subtree { node, start, end, leaf });
            leaf += end - start + 1;
            if stack.len() < AT_ONCE && node as usize + 1 < mt.root_count() {
                continue;
            }
            while !stack.is_empty() {
                let from = stack.len().saturating_sub(AT_ONCE);
                let count = stack.len() - from;
                let mut batch = [(Subtree::default(), false); AT_ONCE];
                for (slot, below) in batch.iter_mut().zip(stack.drain(from..)) {
                    *slot = (below, below.start < below.end && is_made(below.start, below.node));
                }
                for &(below, is_made) in &batch[..count] {
                    visit(below, is_made);
                    if is_made {
                        stack.extend(mt.below(below));
                    }
                }
            }
        }
    }
}
