//! Extraction by recursion over triangles, each bisected while its vertex is in the cut.

use super::Rtin;
use super::grid::{Extent, Grid, GridPoint, RightTriangle, middle};
use crate::forest::NONE;
use crate::level::Level;
use crate::query::Criterion;
use crate::query::{Query, QueryError};

/// Extracts meshes from an [`Rtin`], answering each query from scratch but reusing its buffers.
///
/// Cost: linear in the result, whatever the size of the field, except for
/// [`RtinExtractor::at_most`].
#[derive(Clone, Debug)]
pub struct RtinExtractor<'m> {
    pub(super) model: &'m Rtin,
    level: Level,
    /// Index of each vertex in the level.
    numbers: Vec<u32>,
    /// True for the vertices in the cut.
    pub(super) chosen: Vec<bool>,
    /// All vertices marked in `chosen`.
    pub(super) all_chosen: Vec<u32>,
}

impl<'m> RtinExtractor<'m> {
    /// Creates an extractor, whose tables have an entry for each vertex of the model.
    pub fn new(model: &'m Rtin) -> Self {
        let count = model.vertices.len();
        Self {
            model,
            level: Level::new(model.frame),
            numbers: vec![NONE; count],
            chosen: vec![false; count],
            all_chosen: Vec::new(),
        }
    }

    /// Returns the smallest mesh that satisfies the query: the required vertices and all that they
    /// depend on.
    /// # Errors
    /// The query is invalid.
    pub fn exact(&mut self, query: &Query<'_>) -> Result<&Level, QueryError> {
        let criterion = Criterion::new(query, &self.model.frame)?;
        if criterion.is_uniform() {
            return self.saturated(query);
        }
        self.forget_chosen();
        let Self { model, chosen, all_chosen, .. } = self;
        // The nested balls give a larger cut, so the walk meets every required vertex.
        let mut chooser = Chooser { model, criterion: &criterion, chosen, all_chosen };
        model.grid.walk(&mut chooser);
        Ok(self.write_chosen())
    }

    /// Returns a mesh that satisfies the query, judging each vertex by itself.
    ///
    /// Since balls and errors nest, the required vertices already form a cut.
    ///
    /// It is not the smallest one; docs/notes/rtin.md has figures.
    /// # Errors
    /// The query is invalid.
    pub fn saturated(&mut self, query: &Query<'_>) -> Result<&Level, QueryError> {
        let criterion = Criterion::new(query, &self.model.frame)?;
        let model = self.model;
        Ok(self.write(|place, _| criterion.requires(&model.nested_ball(place))))
    }

    /// Writes the level of the chosen vertices, which must form a cut.
    pub(super) fn write_chosen(&mut self) -> &Level {
        let chosen = std::mem::take(&mut self.chosen);
        self.write(|_, index| chosen[index]);
        self.chosen = chosen;
        &self.level
    }

    /// Writes the level of the vertices that `is_in` accepts, plus those that are in every level.
    fn write(&mut self, is_in: impl FnMut(GridPoint, usize) -> bool) -> &Level {
        let Self { model, level, numbers, .. } = self;
        level.nodes.iter().for_each(|&node| numbers[node as usize] = NONE);
        level.clear();
        model.grid.walk(&mut Writer { model, level, numbers, is_in });
        level
    }

    pub(super) fn forget_chosen(&mut self) {
        let Self { chosen, all_chosen, .. } = self;
        all_chosen.drain(..).for_each(|index| chosen[index as usize] = false);
    }
}

/// Visitor of the triangles.
trait Visit {
    /// Returns the number of a vertex if it is in the cut; `apex` is one of its dependencies.
    fn number(&mut self, place: GridPoint, apex: GridPoint) -> Option<u32>;

    /// Receives a triangle of the level.
    fn show(&mut self, corners: [u32; 3]);
}

/// A triangle with the numbers of its corners.
#[derive(Clone, Copy)]
struct Numbered {
    triangle: RightTriangle,
    /// Numbers of the corners, the right angle first.
    numbers: [u32; 3],
}

impl Grid {
    /// Bisects triangles while their vertex has a number, and shows the others.
    fn walk(&self, visit: &mut impl Visit) {
        for triangle in self.roots() {
            let numbers = triangle.corners().map(|p| self.number(p, p, visit).unwrap_or(NONE));
            self.halve(Numbered { triangle, numbers }, self.depth(), false, visit);
        }
    }

    /// Returns the number of a vertex, or a dummy outside the field, where triangles are bisected
    /// on.
    fn number(&self, place: GridPoint, apex: GridPoint, visit: &mut impl Visit) -> Option<u32> {
        if self.holds(place) { visit.number(place, apex) } else { Some(NONE) }
    }

    fn halve(&self, of: Numbered, depth: u32, is_inside: bool, visit: &mut impl Visit) {
        let Numbered { triangle, numbers: [apex, first, last] } = of;
        let is_inside = is_inside
            || match self.extent(&triangle) {
                Extent::Outside => return,
                Extent::Across => false,
                Extent::Inside => true,
            };
        if depth == 0 {
            return visit.show(of.numbers);
        }
        let at = middle(triangle.ends);
        let number = match is_inside {
            true => visit.number(at, triangle.apex),
            false => self.number(at, triangle.apex, visit),
        };
        let Some(number) = number else { return visit.show(of.numbers) };
        let numbers = [[number, apex, first], [number, last, apex]];
        for (triangle, numbers) in triangle.halves().into_iter().zip(numbers) {
            self.halve(Numbered { triangle, numbers }, depth - 1, is_inside, visit);
        }
    }
}

struct Writer<'a, F> {
    model: &'a Rtin,
    level: &'a mut Level,
    numbers: &'a mut [u32],
    is_in: F,
}

impl<F: FnMut(GridPoint, usize) -> bool> Visit for Writer<'_, F> {
    #[inline(always)]
    fn number(&mut self, place: GridPoint, _: GridPoint) -> Option<u32> {
        let Self { model, level, .. } = self;
        let index = model.grid.index(place);
        let number = self.numbers[index];
        if number != NONE {
            return Some(number);
        }
        let vertex = &model.vertices[index];
        if !vertex.is_forced() && !(self.is_in)(place, index) {
            return None;
        }
        let number = level.nodes.len() as u32;
        self.numbers[index] = number;
        level.nodes.push(index as u32);
        level.positions.push(model.placement.point(place, vertex.height.into()).as_vec3().into());
        Some(number)
    }

    #[inline]
    fn show(&mut self, corners: [u32; 3]) {
        self.level.faces.push(self.model.turned(corners));
    }
}

/// Visitor that collects the required vertices and their dependencies.
struct Chooser<'a, 'f> {
    model: &'a Rtin,
    criterion: &'a Criterion<'f>,
    chosen: &'a mut [bool],
    all_chosen: &'a mut Vec<u32>,
}

impl Chooser<'_, '_> {
    /// Returns true if a vertex is in the cut so far.
    #[inline]
    fn has(&self, index: usize) -> bool {
        self.chosen[index] || self.model.vertices[index].is_forced()
    }

    #[inline]
    fn add(&mut self, index: usize) {
        self.chosen[index] = true;
        self.all_chosen.push(index as u32);
    }

    /// Adds a vertex with its dependencies. Vertices of the coarsest level have theirs already.
    fn choose(&mut self, place: GridPoint) {
        let index = self.model.grid.index(place);
        if !self.has(index) {
            self.add(index);
            self.model.grid.parents(place).for_each(|parent| self.choose(parent));
        }
    }
}

impl Visit for Chooser<'_, '_> {
    /// The walk meets each vertex once with each of its dependencies.
    #[inline(always)]
    fn number(&mut self, place: GridPoint, apex: GridPoint) -> Option<u32> {
        let (model, criterion) = (self.model, self.criterion);
        let index = model.grid.index(place);
        if model.vertices[index].is_forced() {
            return Some(NONE);
        }
        if !self.chosen[index] {
            if !criterion.requires(&model.nested_ball(place)) {
                return None;
            }
            if !criterion.requires(&model.own_ball(place)) {
                return Some(NONE);
            }
            self.add(index);
        }
        if !self.has(model.grid.index(apex)) {
            self.choose(apex);
        }
        Some(NONE)
    }

    fn show(&mut self, _: [u32; 3]) {}
}
