//! Quantization of a forest for a file: the same cuts, with numbers of fewer bits.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::lattice::Lattice;
use super::normal_predictor::NormalPredictor;
use super::unflatten::unflatten;
use super::write::StoredErrors;
use crate::error_kind::ErrorKind;
use crate::forest::{Forest, MAX_LEVELS, NONE, used_leaves};
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
    pub(super) fn quantized(mut self, lattice: Lattice, errors: StoredErrors) -> Quantized {
        let kind = self.error_kind;
        let input = (errors == StoredErrors::Measured).then(|| self.input());
        let moved = self.snap_to(lattice);
        if let Some(input) = input {
            self.measure_against(input, moved.all.max(moved.restored));
        }
        // A bound must hold between the moved vertices and the exact input.
        let rounding = match (kind, errors) {
            (ErrorKind::Estimate, _) | (_, StoredErrors::Measured) => 0.0,
            _ => moved.all.max(moved.restored) + moved.restored,
        };
        self.round_balls(moved.all, rounding);
        let (levels, reversed) = rayon::join(|| self.levels_by_error(), || self.leading_siblings());
        for (update, level) in self.updates.iter_mut().zip(levels.into_iter().flatten()) {
            update.level = level;
        }
        let updates = self.updates.iter_mut().zip(reversed);
        updates.filter(|(_, is_reversed)| *is_reversed).for_each(|(update, _)| {
            update.children.reverse();
            update.wings.reverse();
        });
        Quantized { forest: self, max_displacement: moved.rounded }
    }

    /// Rounds balls and errors up to the codes of a file, given how far nodes were moved and what
    /// is to be added to errors.
    fn round_balls(&mut self, moved: f64, rounding: f64) {
        for u in 0..self.updates.len() {
            let update = &self.updates[u];
            let ball = self.ball(u);
            // Both the center of the ball and its contents may have moved.
            let own = ball.radius + 2.0 * moved;
            let below = update.children.iter().filter_map(|&child| self.update_of(child));
            let balls = below.map(|below| self.ball(below));
            let reach = balls.map(|below| below.center.distance(ball.center) + below.radius);
            let radius = Length16::up(reach.fold(own, f64::max) * SLACK);
            let error = error9(Length16::up(ball.error + rounding));
            let error = error16(error).unwrap_or(Length16::INFINITE);
            let radius = radius16(radius8(radius));
            (self.updates[u].radius, self.updates[u].error) = (radius, error);
            if self.updates[u].fused_with_child {
                (self.updates[u - 1].radius, self.updates[u - 1].error) = (radius, error);
            }
        }
    }

    /// Moves all nodes of faces to the lattice and returns the largest move. Exact positions take
    /// part unrounded where triangles are kept from losing their area.
    fn snap_to(&mut self, lattice: Lattice) -> Displacement {
        let before = |node: u32| Vec3::from(self.positions[node as usize]);
        let cell = |node: u32| lattice.round(before(node));
        let nodes = || 0..self.positions.len() as u32;
        let is_free = |node: u32| self.exact.get(node).is_none();
        let in_cells = |node: u32| match is_free(node) {
            true => cell(node).map(f64::from),
            false => (self.exact_stored(node) / lattice.cell()).into(),
        };
        let mut places: Vec<_> = nodes().into_par_iter().map(in_cells).collect();
        let unrounded = |node: u32| (before(node).as_dvec3() / lattice.cell()).into();
        unflatten(self, &mut places, unrounded, is_free, |nodes| {
            has_area(nodes.map(|node| self.exact_stored(node)))
        });
        let is_used = used_leaves(&self.faces, self.vertices);
        let mut moved = Displacement::default();
        for (node, place) in (0u32..).zip(places) {
            if is_used.get(node as usize) == Some(&false) {
                continue;
            }
            let before = Vec3::from(self.positions[node as usize]);
            let exact = self.exact.get(node).is_some().then(|| self.exact_stored(node));
            let at = if exact.is_none() { place.map(|x| x as i32) } else { lattice.round(before) };
            let (from, to) = (before.as_dvec3(), lattice.position(at));
            let far = from.distance(to.as_dvec3());
            moved.all = moved.all.max(far);
            match exact {
                None => moved.rounded = moved.rounded.max(far),
                Some(exact) => moved.restored = moved.restored.max(from.distance(exact)),
            }
            self.positions[node as usize] = to.into();
        }
        moved
    }

    /// Returns for each update whether swapping its children is free and makes the leading
    /// component of the vector between them positive. Its sign then costs almost nothing to encode.
    fn leading_siblings(&self) -> Vec<bool> {
        let parents = self.parents();
        let is_reversed = |u: usize| {
            let update = &self.updates[u];
            if !update.children_swappable || update.fused_with_child {
                return false;
            }
            let children = self.child_positions(u);
            let mut at = self.node(u);
            let predictor = NormalPredictor::from_ancestors(std::array::from_fn(|_| {
                let above = Some(parents[at]).filter(|&up| up != NONE)? as usize;
                at = self.node(above);
                Some(self.child_positions(above))
            }));
            predictor.is_lead_negative(children[1].as_dvec3() - children[0].as_dvec3())
        };
        (0..self.updates.len()).into_par_iter().map(is_reversed).collect()
    }

    /// Returns the positions of an update's children.
    fn child_positions(&self, update: usize) -> [Vec3; 2] {
        self.updates[update].children.map(|child| self.positions[child as usize].into())
    }

    /// Returns levels from the errors: the ranges of levels for different errors are stacked, with
    /// the greatest errors on top. Dependencies hold because an update never has a greater error
    /// than one it depends on. Returns `None` if this takes too many levels.
    fn levels_by_error(&self) -> Option<Vec<u16>> {
        let steps: Vec<u16> =
            self.updates.par_iter().map(|update| error9(update.error) as u16).collect();
        let mut heights: Vec<u16> = Vec::with_capacity(self.updates.len());
        let mut tops = [0u16; ERRORS];
        for (u, &step) in steps.iter().enumerate() {
            let below = self.ring(u).iter().chain(&self.updates[u].children);
            let below = below.filter_map(|&node| self.update_of(node));
            let below = below.filter(|&below| steps[below] == step);
            let height = 1 + below.map(|below| heights[below]).max().unwrap_or(0);
            let top = &mut tops[usize::from(step)];
            *top = height.max(*top);
            heights.push(height);
        }
        let mut all = 0;
        let bottoms = tops.map(|top| {
            all += usize::from(top);
            all - usize::from(top)
        });
        if all >= usize::from(MAX_LEVELS) {
            return None;
        }
        let level = |(height, step): (u16, u16)| bottoms[usize::from(step)] as u16 + height;
        Some(heights.into_iter().zip(steps).map(level).collect())
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
