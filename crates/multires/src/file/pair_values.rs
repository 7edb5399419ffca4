//! Values of a wedge with one child at either node: the difference of both, and by how much the
//! parent is off the place between them.

use glam::DVec3;

use super::lineage::Lineage;
use super::octahedral_plane::{OctahedralPlane, Place};
use super::slope::Slope;
use super::value_prediction::{LayerColumns, PairSlopes};
use super::wedge_values::Values;

/// The children of a wedge, one at each node, and the wedge between them.
pub(super) struct Pair {
    /// First child, parent, second child.
    pub(super) wedges: [u32; 3],
    /// Part of the way from the first child to the second at which the parent is.
    part: f64,
    /// Way to the parent from that place.
    aside: DVec3,
}

impl Pair {
    /// Returns by how much the parent is expected to differ from the first child.
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
        let length = way.length_squared();
        let part = if length > 0.0 { (way.dot(p - a) / length).clamp(0.0, 1.0) } else { 0.5 };
        Some(Pair { wedges, part, aside: p - a - part * way })
    }

    /// Replaces the values of a pair's parent by those that a file can hold.
    pub(super) fn derive_parent(&mut self, pair: &Pair, layer: &LayerColumns, ring: &Slope) {
        if let Some(bits) = layer.directions {
            let plane = OctahedralPlane::new(bits);
            let [a, p, b] = pair.wedges.map(|wedge| self.known.code(wedge, layer.start));
            let difference = apart(plane.near(b, a), a);
            let (middle, step) = self.middle(pair, layer.start, a, difference);
            let off = apart(plane.near(p, middle), middle);
            let off = [0, 1].map(|k| nearest(off[k], step[k]));
            let at = plane.code([0, 1].map(|k| middle[k] + off[k] * step[k])).0;
            let is_there = plane.steps_to(at, middle, step).is_some();
            let p = if is_there { at } else { plane.code(middle).0 };
            self.set_code(pair.wedges[1], layer.start, p);
        }
        for column in layer.plain() {
            let [a, p, b] = pair.wedges.map(|wedge| self.number(wedge, column));
            let difference = b.wrapping_sub(a);
            let between = self.between(pair, column, difference, ring);
            let step = self.leeways[column].step(difference);
            let off = nearest(p.wrapping_sub(a).wrapping_sub(between), step);
            let p = a.wrapping_add(between).wrapping_add(off.wrapping_mul(step));
            self.set(pair.wedges[1], column, p);
        }
    }

    /// Returns by how much a number of the parent is expected to differ from that of the first child:
    /// by its part of the difference, and by what the wedges around change aside from the line
    /// between the children.
    fn between(&self, pair: &Pair, column: usize, difference: i32, ring: &Slope) -> i32 {
        pair.between(difference).wrapping_add(self.known.change(ring, pair.aside, column))
    }

    /// Returns the place at which a parent is expected, and the steps in which it is off that.
    fn middle(&self, pair: &Pair, start: usize, a: Place, difference: Place) -> (Place, Place) {
        let middle = [0, 1].map(|k| a[k].wrapping_add(pair.between(difference[k])));
        (middle, [0, 1].map(|k| self.leeways[start + k].step(difference[k])))
    }

    fn predicted_places(
        &self,
        pair: &Pair,
        layer: &LayerColumns,
        bits: u8,
        slope: &Slope,
    ) -> Place {
        let [a, p, b] = pair.wedges;
        let [a, b] = self.known.directions_at(slope, ([a, b], p), layer, bits);
        apart(b, a)
    }

    /// Computes the residuals of a pair's values.
    pub(super) fn pair_residuals(
        &self,
        pair: &Pair,
        layer: &LayerColumns,
        slopes: &PairSlopes,
        set: &mut impl FnMut(u32, usize, i32),
    ) {
        let [first, _, second] = pair.wedges;
        if let Some(bits) = layer.directions {
            let plane = OctahedralPlane::new(bits);
            let [a, p, b] = pair.wedges.map(|wedge| self.known.code(wedge, layer.start));
            let mut difference = apart(plane.near(b, a), a);
            let (middle, step) = self.middle(pair, layer.start, a, difference);
            let (at, mut off) = plane.steps_to(p, middle, step).unwrap_or((middle, [0; 2]));
            if plane.code(at).1 {
                // Seen from the parent, all is turned.
                (difference, off) = (difference.map(|x| -x), off.map(|x| -x));
            }
            let predicted = self.predicted_places(pair, layer, bits, &slopes.difference);
            let line = self.known.line(pair.wedges[1], layer, bits);
            let (off, residual) = (line.encode(off), line.encode(apart(difference, predicted)));
            for k in 0..2 {
                set(first, layer.start + k, off[k]);
                set(second, layer.start + k, residual[k]);
            }
        }
        let way = self.known.place(second) - self.known.place(first);
        for column in layer.plain() {
            let [a, p, b] = pair.wedges.map(|wedge| self.number(wedge, column));
            let difference = b.wrapping_sub(a);
            let between = self.between(pair, column, difference, &slopes.ring);
            let off = p.wrapping_sub(a).wrapping_sub(between);
            set(first, column, nearest(off, self.leeways[column].step(difference)));
            let predicted = self.known.change(&slopes.difference, way, column);
            set(second, column, difference.wrapping_sub(predicted));
        }
    }

    /// Computes the values of a pair from their residuals.
    pub(super) fn solve_pair(&mut self, pair: &Pair, layer: &LayerColumns, slopes: &PairSlopes) {
        let [first, _, second] = pair.wedges;
        if let Some(bits) = layer.directions {
            let plane = OctahedralPlane::new(bits);
            let [off, p, residual] = pair.wedges.map(|wedge| self.known.code(wedge, layer.start));
            let line = self.known.line(pair.wedges[1], layer, bits);
            let (off, residual) = (line.decode(off), line.decode(residual));
            let predicted = self.predicted_places(pair, layer, bits, &slopes.difference);
            let difference = [0, 1].map(|k| predicted[k].wrapping_add(residual[k]));
            let (middle, step) = self.middle(pair, layer.start, [0; 2], difference);
            let a = [0, 1]
                .map(|k| p[k].wrapping_sub(off[k].wrapping_mul(step[k])).wrapping_sub(middle[k]));
            let b = [0, 1].map(|k| a[k].wrapping_add(difference[k]));
            self.set_code(first, layer.start, plane.code(a).0);
            self.set_code(second, layer.start, plane.code(b).0);
        }
        let way = self.known.place(second) - self.known.place(first);
        for column in layer.plain() {
            let [off, p, residual] = pair.wedges.map(|wedge| self.number(wedge, column));
            let difference = self.known.change(&slopes.difference, way, column);
            let difference = difference.wrapping_add(residual);
            let off = off.wrapping_mul(self.leeways[column].step(difference));
            let between = self.between(pair, column, difference, &slopes.ring);
            let a = p.wrapping_sub(off).wrapping_sub(between);
            self.set(first, column, a);
            self.set(second, column, a.wrapping_add(difference));
        }
    }
}

fn apart(to: Place, from: Place) -> Place {
    [0, 1].map(|k| to[k].wrapping_sub(from[k]))
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
}
