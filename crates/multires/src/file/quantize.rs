//! Quantization of a forest for a file: the same cuts, with numbers of fewer bits.

use glam::{DVec3, Vec3};

use super::lattice::Lattice;
use super::normal_predictor::NormalPredictor;
use super::unflatten::unflatten;
use super::write::StoredErrors;
use crate::error_kind::ErrorKind;
use crate::forest::{BuildError, Forest, MAX_LEVELS, NONE};
use crate::implicit::{Implicit, Order};
use crate::length16::Length16;
use crate::pack::{ERRORS, error9, error16, radius8, radius16};
use crate::query::SLACK;

/// Forest with quantized positions, balls, errors and levels.
pub(super) struct Quantized {
    pub(super) forest: Forest,
    /// Largest distance that a node without an exact position was moved, in stored units.
    pub(super) max_displacement: f64,
}

/// Largest distances that nodes were moved, in stored units.
#[derive(Clone, Copy, Debug, Default)]
struct Displacement {
    all: f64,
    /// Among nodes without an exact position.
    rounded: f64,
    /// Among nodes with one: from the recorded position to the exact one.
    restored: f64,
}

impl Forest {
    /// Quantizes the forest for a file.
    ///
    /// Positions are moved to the lattice. Balls and errors are rounded up to shorter codes and
    /// nested again. Levels are renumbered, and siblings ordered, so that they compress well.
    /// # Errors
    /// Too many nodes.
    pub(super) fn quantized(
        &self,
        lattice: Lattice,
        errors: StoredErrors,
    ) -> Result<Quantized, BuildError> {
        let mut this = self.clone();
        let moved = this.snap_to(lattice)?;
        if errors == StoredErrors::Measured {
            this.measure_against(&self.input(), moved.all.max(moved.restored));
        }
        // A bound must hold between the moved vertices and the exact input.
        let rounding = match (self.error_kind, errors) {
            (ErrorKind::Estimate, _) | (_, StoredErrors::Measured) => 0.0,
            _ => moved.all.max(moved.restored) + moved.restored,
        };
        for u in 0..this.updates.len() {
            let update = &this.updates[u];
            let ball = this.ball(u);
            // Both the center of the ball and its contents may have moved.
            let own = ball.radius + 2.0 * moved.all;
            let below = update.children.iter().filter_map(|&child| this.update_of(child));
            let balls = below.map(|below| this.ball(below));
            let reach = balls.map(|below| below.center.distance(ball.center) + below.radius);
            let radius = Length16::up(reach.fold(own, f64::max) * SLACK);
            let error = error9(Length16::up(ball.error + rounding));
            let error = error16(error).unwrap_or(Length16::INFINITE);
            let radius = radius16(radius8(radius));
            (this.updates[u].radius, this.updates[u].error) = (radius, error);
            if this.updates[u].fused_with_child {
                (this.updates[u - 1].radius, this.updates[u - 1].error) = (radius, error);
            }
        }
        this.orient_siblings();
        this.level_by_error();
        Ok(Quantized { forest: this, max_displacement: moved.rounded })
    }

    /// Moves all nodes to the lattice and returns the largest move. Exact positions take part
    /// unrounded where triangles are kept from losing their area.
    fn snap_to(&mut self, lattice: Lattice) -> Result<Displacement, BuildError> {
        let order = Order::new(self);
        let mt = Implicit::in_order(self, &order)?;
        let before = |node: u32| Vec3::from(mt.stored_position(node));
        let cell = |node: u32| lattice.round(before(node));
        let nodes = || 0..mt.node_count() as u32;
        let is_free = |node: u32| mt.exact().get(node).is_none();
        let in_cells = |node: u32| match is_free(node) {
            true => cell(node).map(f64::from),
            false => (mt.exact_stored(node) / lattice.cell()).into(),
        };
        let mut places: Vec<_> = nodes().map(in_cells).collect();
        let unrounded = |node: u32| (before(node).as_dvec3() / lattice.cell()).into();
        unflatten(&mt, &mut places, unrounded, is_free, |nodes| {
            has_area(nodes.map(|node| mt.exact_stored(node)))
        });
        let mut moved = Displacement::default();
        for (node, place) in nodes().zip(places) {
            let at = if is_free(node) { place.map(|x| x as i32) } else { cell(node) };
            let (from, to) = (before(node).as_dvec3(), lattice.position(at));
            let far = from.distance(to.as_dvec3());
            moved.all = moved.all.max(far);
            if is_free(node) {
                moved.rounded = moved.rounded.max(far);
            } else {
                moved.restored = moved.restored.max(from.distance(mt.exact_stored(node)));
            }
            self.positions[order.nodes[node as usize] as usize] = to.into();
        }
        Ok(moved)
    }

    /// Swaps siblings where that is free, so that the leading component of the vector between them
    /// is not negative. Its sign then costs almost nothing to encode.
    fn orient_siblings(&mut self) {
        let parents = self.parents();
        for u in 0..self.updates.len() {
            let children = self.child_positions(u);
            let mut at = self.node(u);
            let predictor = NormalPredictor::from_ancestors(std::array::from_fn(|_| {
                let above = Some(parents[at]).filter(|&up| up != NONE)? as usize;
                at = self.node(above);
                Some(self.child_positions(above))
            }));
            let update = &mut self.updates[u];
            let difference = children[1].as_dvec3() - children[0].as_dvec3();
            if predictor.is_lead_negative(difference)
                && update.children_swappable
                && !update.fused_with_child
            {
                update.children.reverse();
                update.wings.reverse();
            }
        }
    }

    /// Returns the positions of an update's children.
    fn child_positions(&self, update: usize) -> [Vec3; 2] {
        self.updates[update].children.map(|child| self.positions[child as usize].into())
    }

    /// Renumbers levels from the errors: the ranges of levels for different errors are stacked,
    /// with the greatest errors on top. Dependencies hold because an update never has a greater
    /// error than one it depends on. If this takes too many levels, they stay unchanged.
    fn level_by_error(&mut self) {
        let step = |update: usize| error9(self.updates[update].error) as usize;
        let mut heights: Vec<u16> = Vec::with_capacity(self.updates.len());
        let mut tops = [0u16; ERRORS];
        for u in 0..self.updates.len() {
            let below = self.ring(u).iter().chain(&self.updates[u].children);
            let below = below.filter_map(|&node| self.update_of(node));
            let below = below.filter(|&below| step(below) == step(u));
            let height = 1 + below.map(|below| heights[below]).max().unwrap_or(0);
            tops[step(u)] = tops[step(u)].max(height);
            heights.push(height);
        }
        let mut all = 0;
        let bottoms = tops.map(|top| {
            all += usize::from(top);
            all - usize::from(top)
        });
        if all >= usize::from(MAX_LEVELS) {
            return;
        }
        for (u, height) in heights.into_iter().enumerate() {
            self.updates[u].level = bottoms[error9(self.updates[u].error) as usize] as u16 + height;
        }
    }
}

fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    (b - a).cross(c - a).length_squared() > 0.0
}

/// Number of powers of two that a [`Length16`] covers.
pub(super) const OCTAVES: usize = 32;

/// Returns the exponent of an error.
pub(super) fn octave(error: Length16) -> usize {
    (usize::from(error.0) * OCTAVES) >> u16::BITS
}
