//! What a file keeps of a forest: the same cuts, in numbers that take less room.

use glam::{DVec3, Vec3};

use super::lattice::Lattice;
use super::slant::Slant;
use super::spread::spread;
use crate::bounds::ErrorKind;
use crate::forest::{BuildError, Forest, MOST_LEVELS, NONE};
use crate::frame::Length16;
use crate::implicit::{Implicit, Order};
use crate::need::SLACK;
use crate::short::{ERRORS, error9, error16, radius8, radius16};

/// A forest as a file keeps it.
pub(super) struct Kept {
    pub(super) forest: Forest,
    /// By how much a node was moved at most, in stored units.
    pub(super) moved: f64,
}

impl Forest {
    /// With places on the lattice, balls around that and errors in fewer steps, rounded up and nested
    /// again; with levels that tell little beside the error; with siblings in an order that tells little.
    /// # Errors
    /// More nodes than are numbered.
    pub(super) fn kept(&self, lattice: Lattice) -> Result<Kept, BuildError> {
        let mut this = self.clone();
        let moved = this.move_to(lattice)?;
        // A bound holds for where things are now, and where the input is that is kept to the bit.
        let restored = self.restored();
        let rounding = match self.error_kind {
            ErrorKind::Bound => moved.max(restored) + restored,
            ErrorKind::Estimate => 0.0,
        };
        // What changes no surface takes vertices away still: to have them all is to ask for no error.
        let least = if self.exact.is_empty() { 0 } else { 1 };
        for u in 0..this.updates.len() {
            let update = &this.updates[u];
            let ball = this.ball(u);
            // Its own place may have moved, and what is around.
            let own = ball.radius + 2.0 * moved;
            let below = update.children.iter().filter_map(|&child| this.update_of(child));
            let balls = below.map(|below| this.ball(below));
            let reach = balls.map(|below| below.center.distance(ball.center) + below.radius);
            let radius = Length16::up(reach.fold(own, f64::max) * SLACK);
            let error = error9(Length16::up(ball.error + rounding)).max(least);
            let error = error16(error).unwrap_or(Length16::INFINITE);
            let radius = radius16(radius8(radius));
            (this.updates[u].radius, this.updates[u].error) = (radius, error);
            if this.updates[u].glued {
                (this.updates[u - 1].radius, this.updates[u - 1].error) = (radius, error);
            }
        }
        this.turn_siblings();
        this.level_by_error();
        Ok(Kept { forest: this, moved })
    }

    /// Puts all nodes on the lattice, and says how far one was moved at most. Those that are kept to the
    /// bit are seen there; triangles have to have an area with them where they are.
    fn move_to(&mut self, lattice: Lattice) -> Result<f64, BuildError> {
        let order = Order::new(self);
        let mt = Implicit::in_order(self, &order)?;
        let before = |node: u32| Vec3::from(mt.place(node));
        let exact = |node: u32| mt.exact().of(node).map(|p| mt.frame().point(p.into()));
        let place = |node: u32| exact(node).unwrap_or_else(|| before(node).as_dvec3());
        let cell = |node: u32| lattice.round(before(node));
        let nodes = || 0..mt.node_count() as u32;
        let in_cells = |node: u32| match exact(node) {
            Some(place) => (place / lattice.cell()).into(),
            None => cell(node).map(f64::from),
        };
        let mut places: Vec<_> = nodes().map(in_cells).collect();
        let is_free = |node: u32| mt.exact().of(node).is_none();
        spread(&mt, &mut places, is_free, |nodes| has_area(nodes.map(place)));
        let mut moved = 0.0f64;
        for (node, place) in nodes().zip(places) {
            let at = if is_free(node) { place.map(|x| x as i32) } else { cell(node) };
            let (from, to) = (before(node).as_dvec3(), lattice.put(at));
            moved = moved.max(from.distance(to.as_dvec3()));
            self.positions[order.nodes[node as usize] as usize] = to.into();
        }
        Ok(moved)
    }

    /// How far those that are kept to the bit are from where they were measured, at most, in stored units.
    fn restored(&self) -> f64 {
        let apart = |leaf: u32| {
            let exact = self.frame.point(self.exact.of(leaf)?.into());
            Some(exact.distance(Vec3::from(self.positions[leaf as usize]).as_dvec3()))
        };
        (0..self.vertices as u32).filter_map(apart).fold(0.0, f64::max)
    }

    /// Lets the second of two siblings be the one that is further along, where that is free: then a
    /// sign less is to be told.
    fn turn_siblings(&mut self) {
        let parents = self.parents();
        for u in 0..self.updates.len() {
            let family = self.family(u);
            let mut at = self.node(u);
            let slant = Slant::of(std::array::from_fn(|_| {
                let above = Some(parents[at]).filter(|&up| up != NONE)? as usize;
                at = self.node(above);
                Some(self.family(above))
            }));
            let update = &mut self.updates[u];
            let apart = family[1].as_dvec3() - family[0].as_dvec3();
            if slant.is_backwards(apart) && update.either && !update.glued {
                update.children.reverse();
                update.wings.reverse();
            }
        }
    }

    /// Where the children of an update are.
    fn family(&self, update: usize) -> [Vec3; 2] {
        self.updates[update].children.map(|child| self.positions[child as usize].into())
    }

    /// Counts levels within each step of the error, and the steps one above the other: what needs
    /// something has no greater error. Leaves them as they are if that takes too many.
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
        if all >= usize::from(MOST_LEVELS) {
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

/// How many octaves there are.
pub(super) const OCTAVES: usize = 32;

/// The power of two that an error is in.
pub(super) fn octave(error: Length16) -> usize {
    (usize::from(error.0) * OCTAVES) >> u16::BITS
}
