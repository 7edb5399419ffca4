//! Values of the wedges of all levels, as residuals of what is predicted from those before them.
//!
//! Where a wedge *p* has one child *a* at the first node and one *b* at the second, it lies about
//! between them. So the file has the difference of *a* and *b*, and by how much *p* is off the place
//! between them, in steps of some cells: values of nodes that are split need not be as exact as
//! those of the finest mesh. From these and *p* the reader computes *a* and *b*, without a loss:
//! what is added to each depends only on what the reader has [BE92].

use crate::cut::each_split_star;
use crate::forest::NONE;
use crate::implicit::Implicit;
use crate::wedges::Wedges;

use super::layer_coding::{LayerCoding, Leeway};
use super::lineage::{Lineage, Role, relate};
use super::octahedral_plane::{OctahedralPlane, Place};
use super::slope::Slope;
use super::value_prediction::{Kin, Known, LayerColumns};

/// Returns what a file has for each wedge of a model, given their integers: residuals, or for wedges
/// of roots their values.
///
/// Those of vertices that are split are first replaced by ones that a file can hold.
pub(super) fn residuals(
    mt: &Implicit,
    all: &Wedges,
    coding: &[LayerCoding],
    rows: Vec<i32>,
) -> Vec<i32> {
    let mut values = Values::new(mt, all, coding, rows);
    values.derive_parents();
    let mut out = values.known.rows.clone();
    let (mut slope, mut family) = (Slope::default(), Vec::new());
    each_split_star(mt, |update, star| {
        values.family(update, &mut family);
        for of in &family {
            let parent = of.parent.unwrap_or(0);
            let mut set = |wedge: u32, column: usize, number: i32| {
                out[wedge as usize * values.known.columns + column] = number;
            };
            match (of.role(), values.pair(of)) {
                (Role::Difference, Some(pair)) => {
                    values.known.fit(parent, None, star, &mut slope);
                    for layer in &values.layers {
                        values.pair_residuals(&pair, layer, &slope, &mut set);
                    }
                }
                (Role::Parent, Some(_)) => {}
                _ => {
                    values.known.fit(parent, of.sibling, star, &mut slope);
                    for layer in &values.layers {
                        values.single_residuals(of, layer, &slope, &mut set);
                    }
                }
            }
        }
    });
    out
}

/// Returns the integers of all wedges of a model, given what a file has for each.
///
/// In part of a file, those of updates whose dependencies are missing are any numbers.
pub(super) fn restored(
    mt: &Implicit,
    all: &Wedges,
    coding: &[LayerCoding],
    rows: Vec<i32>,
) -> Vec<i32> {
    let mut values = Values::new(mt, all, coding, rows);
    let layers = std::mem::take(&mut values.layers);
    let (mut slope, mut family) = (Slope::default(), Vec::new());
    each_split_star(mt, |update, star| {
        values.family(update, &mut family);
        // Other wedges may be predicted from those of pairs.
        for of in family.iter().filter(|of| of.role() == Role::Difference) {
            let Some(pair) = values.pair(of) else { continue };
            values.known.fit(pair.wedges[1], None, star, &mut slope);
            layers.iter().for_each(|layer| values.solve_pair(&pair, layer, &slope));
        }
        for of in family.iter().filter(|of| of.role() == Role::Single) {
            values.known.fit(of.parent.unwrap_or(0), of.sibling, star, &mut slope);
            layers.iter().for_each(|layer| values.solve_single(of, layer, &slope));
        }
    });
    values.known.rows
}

/// Values of the wedges of a model while they are coded.
struct Values<'m> {
    known: Known<'m>,
    all: &'m Wedges,
    layers: Vec<LayerColumns>,
    leeways: Vec<Leeway>,
}

/// The children of a wedge, one at each node, and the wedge between them.
struct Pair {
    wedges: [u32; 3],
    /// Part of the way from the first child to the second at which the parent is.
    part: f64,
}

impl Pair {
    /// Returns by how much the parent is expected to differ from the first child.
    fn between(&self, difference: i32) -> i32 {
        (self.part * f64::from(difference)).round() as i32
    }
}

impl<'m> Values<'m> {
    fn new(mt: &'m Implicit, all: &'m Wedges, coding: &[LayerCoding], rows: Vec<i32>) -> Self {
        let layers = LayerColumns::of(coding);
        let normals = layers.iter().find(|layer| layer.kind == meshlod_mesh::LayerKind::Normal);
        let normals = normals.and_then(|layer| Some((layer.start, layer.directions?)));
        let columns = coding.iter().map(LayerCoding::columns).sum();
        let leeways = coding.iter().flat_map(LayerCoding::leeways).collect();
        let known = Known { mt, rows, columns, kin: Vec::new(), normals };
        let mut this = Self { known, all, layers, leeways };
        let wedges = all.first(mt.node_count() as u32) as usize;
        this.known.kin.reserve_exact(wedges);
        for node in 0..mt.node_count() as u32 {
            let kin = Kin { node, parent: NONE, sibling: NONE };
            this.known.kin.extend(all.of(node).map(|_| kin));
        }
        let mut family = Vec::new();
        for update in 0..mt.update_count() as u32 {
            this.family(update, &mut family);
            for of in &family {
                let kin = &mut this.known.kin;
                kin[of.wedge as usize].parent = of.parent.unwrap_or(NONE);
                if let Some(sibling) = of.sibling {
                    kin[of.wedge as usize].sibling = sibling;
                    kin[sibling as usize].sibling = of.wedge;
                }
            }
        }
        this
    }

    fn family(&self, update: u32, family: &mut Vec<Lineage>) {
        family.clear();
        let (mt, all) = (self.known.mt, self.all);
        let children = mt.children(update).map(|child| all.of(child));
        let record = all.split(update, mt.children(update), || mt.created_count(update));
        let local = |wedge: usize| record.map_or(Some(0), |record| record.parent(wedge));
        relate(Some(all.of(mt.parent(update))), children, local, family);
    }

    /// Returns the pair that a wedge is of.
    fn pair(&self, of: &Lineage) -> Option<Pair> {
        let (own, other) = (of.wedge, of.partner?);
        let (first, second) = if of.is_second { (other, own) } else { (own, other) };
        let wedges = [first, of.parent?, second];
        let [a, p, b] = wedges.map(|wedge| self.known.place(wedge));
        let way = b - a;
        let length = way.length_squared();
        let part = if length > 0.0 { (way.dot(p - a) / length).clamp(0.0, 1.0) } else { 0.5 };
        Some(Pair { wedges, part })
    }

    fn number(&self, wedge: u32, column: usize) -> i32 {
        self.known.rows[wedge as usize * self.known.columns + column]
    }

    fn set(&mut self, wedge: u32, column: usize, number: i32) {
        self.known.rows[wedge as usize * self.known.columns + column] = number;
    }

    fn set_code(&mut self, wedge: u32, start: usize, [x, y]: Place) {
        self.set(wedge, start, x);
        self.set(wedge, start + 1, y);
    }

    /// Replaces the values of the parents of pairs by those that a file can hold.
    fn derive_parents(&mut self) {
        let layers = self.layers.clone();
        for layer in &layers {
            if let Some(bits) = layer.directions {
                let plane = OctahedralPlane::new(bits);
                for wedge in 0..self.known.kin.len() as u32 {
                    self.set_code(
                        wedge,
                        layer.start,
                        plane.code(self.known.code(wedge, layer.start)).0,
                    );
                }
            }
        }
        let mut family = Vec::new();
        // Children are split by later updates.
        for update in (0..self.known.mt.update_count() as u32).rev() {
            self.family(update, &mut family);
            for of in family.iter().filter(|of| of.role() == Role::Difference) {
                let Some(pair) = self.pair(of) else { continue };
                for layer in &layers {
                    self.derive_parent(&pair, layer);
                }
            }
        }
    }

    fn derive_parent(&mut self, pair: &Pair, layer: &LayerColumns) {
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
            let between = pair.between(difference);
            let step = self.leeways[column].step(difference);
            let off = nearest(p.wrapping_sub(a).wrapping_sub(between), step);
            let p = a.wrapping_add(between).wrapping_add(off.wrapping_mul(step));
            self.set(pair.wedges[1], column, p);
        }
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
    fn pair_residuals(
        &self,
        pair: &Pair,
        layer: &LayerColumns,
        slope: &Slope,
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
            let predicted = self.predicted_places(pair, layer, bits, slope);
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
            let off = p.wrapping_sub(a).wrapping_sub(pair.between(difference));
            set(first, column, nearest(off, self.leeways[column].step(difference)));
            let predicted = self.known.change(slope, way, column);
            set(second, column, difference.wrapping_sub(predicted));
        }
    }

    /// Computes the values of a pair from their residuals.
    fn solve_pair(&mut self, pair: &Pair, layer: &LayerColumns, slope: &Slope) {
        let [first, _, second] = pair.wedges;
        if let Some(bits) = layer.directions {
            let plane = OctahedralPlane::new(bits);
            let [off, p, residual] = pair.wedges.map(|wedge| self.known.code(wedge, layer.start));
            let line = self.known.line(pair.wedges[1], layer, bits);
            let (off, residual) = (line.decode(off), line.decode(residual));
            let predicted = self.predicted_places(pair, layer, bits, slope);
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
            let difference = self.known.change(slope, way, column).wrapping_add(residual);
            let off = off.wrapping_mul(self.leeways[column].step(difference));
            let a = p.wrapping_sub(off).wrapping_sub(pair.between(difference));
            self.set(first, column, a);
            self.set(second, column, a.wrapping_add(difference));
        }
    }

    /// Computes the residuals of a wedge of no pair.
    fn single_residuals(
        &self,
        of: &Lineage,
        layer: &LayerColumns,
        slope: &Slope,
        set: &mut impl FnMut(u32, usize, i32),
    ) {
        let Some(base) = of.sibling.or(of.parent) else { return };
        if let Some(bits) = layer.directions {
            let [predicted] = self.known.directions_at(slope, ([of.wedge], base), layer, bits);
            let code = self.known.code(of.wedge, layer.start);
            let at = OctahedralPlane::new(bits).near(code, predicted);
            (0..2).for_each(|k| set(of.wedge, layer.start + k, at[k] - predicted[k]));
        }
        let way = self.known.place(of.wedge) - self.known.place(base);
        for column in layer.plain() {
            let predicted = self.number(base, column);
            let predicted = predicted.wrapping_add(self.known.change(slope, way, column));
            set(of.wedge, column, self.number(of.wedge, column).wrapping_sub(predicted));
        }
    }

    /// Computes the values of a wedge of no pair from their residuals.
    fn solve_single(&mut self, of: &Lineage, layer: &LayerColumns, slope: &Slope) {
        let Some(base) = of.sibling.or(of.parent) else { return };
        if let Some(bits) = layer.directions {
            let [predicted] = self.known.directions_at(slope, ([of.wedge], base), layer, bits);
            let residual = self.known.code(of.wedge, layer.start);
            let at = [0, 1].map(|k| predicted[k].wrapping_add(residual[k]));
            self.set_code(of.wedge, layer.start, OctahedralPlane::new(bits).code(at).0);
        }
        let way = self.known.place(of.wedge) - self.known.place(base);
        for column in layer.plain() {
            let predicted = self.number(base, column);
            let predicted = predicted.wrapping_add(self.known.change(slope, way, column));
            self.set(of.wedge, column, self.number(of.wedge, column).wrapping_add(predicted));
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
