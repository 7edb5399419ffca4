//! Extraction of single meshes by the face list.

use super::Subtree;
use crate::length16::Length16;
use crate::level::Level;
use crate::model::Model;
use crate::query::Criterion;
use crate::query::{Query, QueryError};
use crate::wedges::LevelWedges;

/// Extracts meshes from a [`Model`], answering each query from scratch but reusing its buffers.
#[derive(Clone, Debug)]
pub struct Extractor<'m> {
    pub(super) model: &'m Model,
    level: Level,
    /// Vertex of the level that shows each leaf, or set of attributes if the model has wedges.
    above: Vec<u32>,
    /// Vertex and wedge of each set of attributes of the level, if the model has wedges.
    wedges: Vec<[u32; 2]>,
    /// Updates to apply, in the order in which the descent meets them.
    made: Vec<u32>,
    stack: Vec<Subtree>,
    /// True for each update to apply.
    pub(super) chosen: Vec<bool>,
}

/// Number of nodes that are tested before any of them is descended from. Their memory loads
/// overlap, whereas one by one each would wait for the next. Million faces per second on the dragon
/// at one tolerance, for 1, 4 and 16: 2.7k faces 13.8, 15.8, 17.4; 17.5k faces 8.9, 7.4, 17.6; 174k
/// faces 13.8, 9.5, 10.7, where order counts for more.
const BATCH: usize = 16;

impl<'m> Extractor<'m> {
    pub(crate) fn new(model: &'m Model) -> Self {
        Self {
            model,
            level: Level::new(*model.implicit().frame()),
            above: vec![0; model.faces().leaves()],
            wedges: Vec::new(),
            made: Vec::new(),
            stack: Vec::new(),
            chosen: Vec::new(),
        }
    }

    /// Returns the mesh for one tolerance everywhere, in model units.
    ///
    /// It is the answer to [`Query::uniform`], found from the errors alone, since these are
    /// monotone along dependencies.
    ///
    /// A face is present at every tolerance below the error of the update that creates it.
    /// # Errors
    /// The tolerance is negative or NaN.
    pub fn uniform(&mut self, tolerance: f64) -> Result<&Level, QueryError> {
        Query::uniform(tolerance).validate()?;
        let mt = self.model.implicit();
        let most = mt.frame().local_length(tolerance);
        // The greatest code within the tolerance: codes are in the order of lengths. Nothing is within
        // a tolerance of 0.
        let within = Length16::up(most);
        let is_beyond = within.get() > most || most == 0.0;
        let within = if is_beyond { within.0.checked_sub(1) } else { Some(within.0) };
        Ok(self.write(|update, _| Some(mt.error(update).0) > within))
    }

    /// Returns a mesh that satisfies the query, judging each update by itself without visiting its
    /// neighbours.
    ///
    /// It is not the smallest one; docs/notes/multires.md has figures.
    /// # Errors
    /// The query is invalid, or the model has no nested balls for it: see [`Model::saturate`].
    pub fn saturated(&mut self, query: &Query<'_>) -> Result<&Level, QueryError> {
        let mt = self.model.implicit();
        let criterion = Criterion::new(query, mt.frame())?;
        let balls = criterion.viewpoint().and_then(|eye| self.model.saturated_at(eye.slope));
        let balls = balls.ok_or(QueryError::NotSaturated)?;
        Ok(self.write(|update, node| {
            mt.is_fused_with_parent(update) || criterion.requires(&balls.ball(mt, update, node))
        }))
    }

    /// Returns the smallest mesh that satisfies the query: the required updates and all that they
    /// depend on.
    /// # Errors
    /// The query is invalid.
    pub fn exact(&mut self, query: &Query<'_>) -> Result<&Level, QueryError> {
        let criterion = Criterion::new(query, self.model.implicit().frame())?;
        self.choose_required(&criterion);
        self.model.dependencies().close(self.model.implicit(), &mut self.chosen);
        Ok(self.write_chosen())
    }

    /// Returns the mesh of the required updates without their dependencies, a lower bound on the
    /// size of any answer.
    ///
    /// It serves to compare split rules: its faces may overlap, or meet four at an edge.
    /// # Errors
    /// The query is invalid.
    pub fn required(&mut self, query: &Query<'_>) -> Result<&Level, QueryError> {
        let criterion = Criterion::new(query, self.model.implicit().frame())?;
        self.choose_required(&criterion);
        Ok(self.write_chosen())
    }

    /// Writes the mesh of the chosen updates, which must be closed upwards.
    pub(super) fn write_chosen(&mut self) -> &Level {
        let chosen = std::mem::take(&mut self.chosen);
        self.write(|update, _| chosen[update as usize]);
        self.chosen = chosen;
        &self.level
    }

    /// Chooses the updates that the criterion requires, using that balls nest down the forest.
    fn choose_required(&mut self, criterion: &Criterion<'_>) {
        let mt = self.model.implicit();
        let mut chosen = std::mem::take(&mut self.chosen);
        chosen.clear();
        chosen.resize(mt.update_count(), false);
        let requires = |update, node| {
            mt.is_fused_with_parent(update) || criterion.requires(&mt.ball_at(update, node))
        };
        self.descend(requires, |below, is_wanted| {
            if is_wanted {
                chosen[below.start as usize] = true;
            }
        });
        self.chosen = chosen;
    }

    /// Writes the mesh after the updates that `is_made` accepts. It is called with an update and
    /// its node once the updates above are accepted.
    fn write(&mut self, is_made: impl FnMut(u32, u32) -> bool) -> &Level {
        let mt = self.model.implicit();
        let (mut level, mut above, mut made) = (
            std::mem::replace(&mut self.level, Level::new(*mt.frame())),
            std::mem::take(&mut self.above),
            std::mem::take(&mut self.made),
        );
        let (mut wedges, faces) = (std::mem::take(&mut self.wedges), self.model.faces());
        level.clear();
        made.clear();
        wedges.clear();
        self.descend(is_made, |below, is_made| {
            if is_made {
                made.push(below.start);
                return;
            }
            let vertex = level.nodes.len() as u32;
            if let Some(all) = mt.wedges() {
                for wedge in all.of(below.node) {
                    above[faces.below(wedge)].fill(wedges.len() as u32);
                    wedges.push([vertex, wedge]);
                }
            } else {
                let end = below.leaf + below.end - below.start + 1;
                above[below.leaf as usize..end as usize].fill(vertex);
            }
            level.nodes.push(below.node);
            level.positions.push(mt.stored_position(below.node));
        });
        level.exact = mt.exact().clone();
        faces.write(&made, &above, &mut level.faces);
        if let Some(all) = mt.wedges() {
            let at = |face: &[u32; 3], k: usize| face.map(|wedge| wedges[wedge as usize][k]);
            let corners = level.faces.iter().map(|face| at(face, 1)).collect();
            level.faces.iter_mut().for_each(|face| *face = at(face, 0));
            level.wedges = Some(LevelWedges { corners, all: all.clone() });
        }
        (self.level, self.above, self.made, self.wedges) = (level, above, made, wedges);
        &self.level
    }

    /// Descends from the roots as far as `is_made` accepts, and visits every node on the way.
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
            if stack.len() < BATCH && node as usize + 1 < mt.root_count() {
                continue;
            }
            while !stack.is_empty() {
                let from = stack.len().saturating_sub(BATCH);
                let count = stack.len() - from;
                let mut batch = [(Subtree::default(), false); BATCH];
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
