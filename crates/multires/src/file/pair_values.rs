//! Values of a wedge with one child at either node: their difference, and the offset of the parent
//! from a point between them.

use std::ops::Range;

use glam::DVec3;
use meshlod_mesh::LayerKind;

use super::fixed_order::dot;
use super::lineage::Lineage;
use super::octahedral_plane::Place;
use super::slope::Slopes;
use super::value_prediction::{DirectionColumns, LayerColumns};
use super::wedge_values::Values;
use crate::cut::StarFace;

/// The children of a wedge, one at each node, and the wedge between them.
pub(super) struct Pair {
    /// First child, parent, second child.
    pub(super) wedges: [u32; 3],
    /// Position of the parent between the children: 0 at the first, 1 at the second.
    part: f64,
    /// Way to the parent from that place.
    aside: DVec3,
}

/// Wedges by which the values of a pair are predicted, with their shares.
#[derive(Default)]
pub(super) struct PairShares {
    pub(super) slopes: Slopes,
    /// In the changes from the parent to both children.
    children: Vec<[f64; 2]>,
    /// In the change aside, to the parent from its place on the line between them.
    aside: Vec<[f64; 1]>,
}

impl PairShares {
    fn children(&self) -> impl Iterator<Item = (u32, [f64; 2])> {
        self.slopes.wedges().iter().copied().zip(self.children.iter().copied())
    }

    fn difference(&self) -> impl Iterator<Item = (u32, f64)> {
        self.children().map(|(wedge, [first, second])| (wedge, second - first))
    }

    fn aside(&self) -> impl Iterator<Item = (u32, f64)> {
        self.slopes.wedges().iter().copied().zip(self.aside.iter().map(|[share]| *share))
    }
}

impl Pair {
    /// Returns the expected difference of the parent from the first child.
    fn between(&self, difference: i32) -> i32 {
        (self.part * f64::from(difference)).round() as i32
    }
}

impl Values<'_> {
    /// Returns the pair that a wedge is of.
    pub(super) fn pair(&self, of: &Lineage) -> Option<Pair> {
        let (own, other) = (of.wedge, of.partner?);
        let (first, second) = if of.is_second { (other, own) } else { (own, other) };
        let wedges = [first, of.parent?, second];
        let [a, p, b] = wedges.map(|wedge| self.known.place(wedge));
        let way = b - a;
        let squared = dot(way, way);
        let part = if squared > 0.0 { (dot(way, p - a) / squared).clamp(0.0, 1.0) } else { 0.5 };
        Some(Pair { wedges, part, aside: p - a - part * way })
    }

    /// Computes the shares of the wedges around a pair's parent in the values of the pair.
    pub(super) fn share(&self, pair: &Pair, star: &[StarFace], shares: &mut PairShares) {
        let [first, parent, second] = pair.wedges;
        let PairShares { slopes, children, aside } = shares;
        self.known.fit(parent, None, star, slopes);
        slopes.shares([first, second].map(|child| self.known.way([child, parent])), children);
        slopes.shares_around(pair.aside, aside);
    }

    /// Replaces the values of a pair's parent by those that a file can hold.
    ///
    /// Colours stay within the ranges of their columns, so that none is brighter than 1.
    pub(super) fn derive_parent(
        &mut self,
        pair: &Pair,
        layer: &LayerColumns,
        shares: &PairShares,
        ranges: &[[i32; 2]],
    ) {
        if let Some(directions) = layer.directions {
            let plane = directions.plane();
            let [a, p, b] = pair.wedges.map(|wedge| self.known.code(wedge, directions));
            let difference = apart(plane.near(b, a), a);
            let (middle, step) = self.middle(pair, directions, a, difference);
            let off = apart(plane.near(p, middle), middle);
            let off = [0, 1].map(|k| nearest(off[k], step[k]));
            let at = plane.code([0, 1].map(|k| middle[k] + off[k] * step[k])).0;
            let is_there = plane.steps_to(at, middle, step).is_some();
            let p = if is_there { at } else { plane.code(middle).0 };
            self.known.set_code(pair.wedges[1], directions, p);
        }
        for columns in layer.plain() {
            let asides = self.known.changes(layer, &columns, shares.aside());
            for (column, aside) in columns.zip(asides) {
                let [a, p, b] = pair.wedges.map(|wedge| self.number(wedge, column));
                let difference = b.wrapping_sub(a);
                let between = pair.between(difference).wrapping_add(aside);
                let step = self.leeways[column].step(difference);
                let off = nearest(p.wrapping_sub(a).wrapping_sub(between), step);
                let p = a.wrapping_add(between).wrapping_add(off.wrapping_mul(step));
                let p = match layer.kind {
                    LayerKind::Color(_) => back_within(p, step, ranges[column]),
                    _ => p,
                };
                self.set(pair.wedges[1], column, p);
            }
        }
    }

    /// Returns, by column, the expected differences of the second child from the first, and of the
    /// parent from its place on the line between them.
    fn expected(
        &self,
        layer: &LayerColumns,
        columns: &Range<usize>,
        shares: &PairShares,
    ) -> impl Iterator<Item = [i32; 2]> + use<> {
        let differences = self.known.changes(layer, columns, shares.difference());
        let asides = self.known.changes(layer, columns, shares.aside());
        differences.into_iter().zip(asides).map(|(difference, aside)| [difference, aside])
    }

    /// Returns the place at which a parent is expected, and the steps in which it is off that.
    fn middle(
        &self,
        pair: &Pair,
        columns: DirectionColumns,
        a: Place,
        difference: Place,
    ) -> (Place, Place) {
        let middle = [0, 1].map(|k| a[k].wrapping_add(pair.between(difference[k])));
        (middle, [0, 1].map(|k| self.leeways[columns.start + k].step(difference[k])))
    }

    fn predicted_difference(
        &self,
        pair: &Pair,
        layer: &LayerColumns,
        directions: DirectionColumns,
        shares: &PairShares,
    ) -> Place {
        let [a, p, b] = pair.wedges;
        let [a, b] = self.known.directions_at(([a, b], p), layer, directions, shares.children());
        apart(b, a)
    }

    /// Computes the residuals of a pair's values.
    pub(super) fn pair_residuals(
        &self,
        pair: &Pair,
        layer: &LayerColumns,
        shares: &PairShares,
        set: &mut impl FnMut(u32, usize, i32),
    ) {
        let [first, _, second] = pair.wedges;
        if let Some(directions) = layer.directions {
            let plane = directions.plane();
            let [a, p, b] = pair.wedges.map(|wedge| self.known.code(wedge, directions));
            let mut difference = apart(plane.near(b, a), a);
            let (middle, step) = self.middle(pair, directions, a, difference);
            let (at, mut off) = plane.steps_to(p, middle, step).unwrap_or((middle, [0; 2]));
            if plane.code(at).1 {
                // Seen from the parent, all is turned.
                (difference, off) = (difference.map(|x| -x), off.map(|x| -x));
            }
            let predicted = self.predicted_difference(pair, layer, directions, shares);
            let line = self.known.line(pair.wedges[1], layer, directions);
            let (off, residual) = (line.encode(off), line.encode(apart(difference, predicted)));
            for k in 0..2 {
                set(first, layer.start + k, off[k]);
                set(second, layer.start + k, residual[k]);
            }
        }
        for columns in layer.plain() {
            let expected = self.expected(layer, &columns, shares);
            for (column, [predicted, aside]) in columns.zip(expected) {
                let [a, p, b] = pair.wedges.map(|wedge| self.number(wedge, column));
                let difference = b.wrapping_sub(a);
                let between = pair.between(difference).wrapping_add(aside);
                let off = p.wrapping_sub(a).wrapping_sub(between);
                set(first, column, nearest(off, self.leeways[column].step(difference)));
                set(second, column, difference.wrapping_sub(predicted));
            }
        }
    }

    /// Computes the values of a pair from their residuals.
    pub(super) fn solve_pair(&mut self, pair: &Pair, layer: &LayerColumns, shares: &PairShares) {
        let [first, _, second] = pair.wedges;
        if let Some(directions) = layer.directions {
            let plane = directions.plane();
            let [off, p, residual] = pair.wedges.map(|wedge| self.known.code(wedge, directions));
            let line = self.known.line(pair.wedges[1], layer, directions);
            let (off, residual) = (line.decode(off), line.decode(residual));
            let predicted = self.predicted_difference(pair, layer, directions, shares);
            let difference = [0, 1].map(|k| predicted[k].wrapping_add(residual[k]));
            let (middle, step) = self.middle(pair, directions, [0; 2], difference);
            let a = [0, 1]
                .map(|k| p[k].wrapping_sub(off[k].wrapping_mul(step[k])).wrapping_sub(middle[k]));
            let b = [0, 1].map(|k| a[k].wrapping_add(difference[k]));
            self.known.set_code(first, directions, plane.code(a).0);
            self.known.set_code(second, directions, plane.code(b).0);
        }
        for columns in layer.plain() {
            let expected = self.expected(layer, &columns, shares);
            for (column, [predicted, aside]) in columns.zip(expected) {
                let [off, p, residual] = pair.wedges.map(|wedge| self.number(wedge, column));
                let difference = predicted.wrapping_add(residual);
                let off = off.wrapping_mul(self.leeways[column].step(difference));
                let between = pair.between(difference).wrapping_add(aside);
                let a = p.wrapping_sub(off).wrapping_sub(between);
                self.set(first, column, a);
                self.set(second, column, a.wrapping_add(difference));
            }
        }
    }
}

fn apart(to: Place, from: Place) -> Place {
    [0, 1].map(|k| to[k].wrapping_sub(from[k]))
}

/// Moves a number that rounding has taken out of a range back by a step, if that helps.
fn back_within(number: i32, step: i32, [low, high]: [i32; 2]) -> i32 {
    let back = if number > high { number.checked_sub(step) } else { number.checked_add(step) };
    let is_within = |number: i32| (low..=high).contains(&number);
    back.filter(|&back| !is_within(number) && is_within(back)).unwrap_or(number)
}

/// Divides a number and rounds it to the nearest integer; `step` must be odd.
fn nearest(number: i32, step: i32) -> i32 {
    let half = i64::from(step / 2);
    (i64::from(number) + half).div_euclid(i64::from(step)) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_number_of_steps_leaves_less_than_a_step() {
        for number in -40..40 {
            for step in [1, 3, 15] {
                assert!((number - step * nearest(number, step)).abs() <= step / 2);
            }
        }
        assert_eq!(nearest(i32::MIN, 1), i32::MIN);
    }

    #[test]
    fn numbers_go_back_into_their_range() {
        for number in 0..=10 {
            assert_eq!(back_within(number, 3, [0, 10]), number);
        }
        assert_eq!([-1, 11, 13].map(|number| back_within(number, 3, [0, 10])), [2, 8, 10]);
        // Of no help: too far away, too narrow, at the end of numbers.
        assert_eq!(back_within(14, 3, [0, 10]), 14);
        assert_eq!(back_within(4, 15, [3, 3]), 4);
        assert_eq!(back_within(i32::MIN, 15, [0, 10]), i32::MIN);
    }
}
