//! Values of the wedges of all levels, as residuals of what is predicted from those before them.
//!
//! Where a wedge *p* has one child *a* at the first node and one *b* at the second, it lies about
//! between them. So the file has the difference of *a* and *b*, and by how much *p* is off the place
//! between them, in steps of some cells: values of nodes that are split need not be as exact as
//! those of the finest mesh. From these and *p* the reader computes *a* and *b*, without a loss:
//! what is added to each depends only on what the reader has [BE92].

use meshlod_mesh::LayerKind;

use crate::cut::{SplitStars, each_split_star};
use crate::forest::NONE;
use crate::implicit::Implicit;
use crate::wedges::Wedges;

use super::layer_coding::{LayerCoding, Leeway};
use super::lineage::{Lineage, Role, relate};
use super::octahedral_plane::{OctahedralPlane, Place};
use super::slope::Slope;
use super::value_prediction::{Kin, Known, LayerColumns, PairSlopes};

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
    let stars = SplitStars::of(mt);
    values.derive_parents(&stars);
    let mut out = values.known.rows.clone();
    let (mut slope, mut slopes) = (Slope::default(), PairSlopes::default());
    let mut family = Vec::new();
    for (update, star) in stars.iter() {
        values.family(update, &mut family);
        for of in &family {
            let mut set = |wedge: u32, column: usize, number: i32| {
                out[wedge as usize * values.known.columns + column] = number;
            };
            match (of.role(), values.pair(of)) {
                (Role::Difference, Some(pair)) => {
                    values.known.fit_pair(pair.wedges[1], star, &mut slopes);
                    for layer in &values.layers {
                        values.pair_residuals(&pair, layer, &slopes, &mut set);
                    }
                }
                (Role::Parent, Some(_)) => {}
                _ => {
                    values.known.fit(of.parent.unwrap_or(0), of.sibling, star, &mut slope);
                    for layer in &values.layers {
                        values.single_residuals(of, layer, &slope, &mut set);
                    }
                }
            }
        }
    }
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
    let (mut slope, mut slopes) = (Slope::default(), PairSlopes::default());
    let mut family = Vec::new();
    each_split_star(mt, |update, star| {
        values.family(update, &mut family);
        // Other wedges may be predicted from those of pairs.
        for of in family.iter().filter(|of| of.role() == Role::Difference) {
            let Some(pair) = values.pair(of) else { continue };
            values.known.fit_pair(pair.wedges[1], star, &mut slopes);
            layers.iter().for_each(|layer| values.solve_pair(&pair, layer, &slopes));
        }
        for of in family.iter().filter(|of| of.role() == Role::Single) {
            values.known.fit(of.parent.unwrap_or(0), of.sibling, star, &mut slope);
            layers.iter().for_each(|layer| values.solve_single(of, layer, &slope));
        }
    });
    values.known.rows
}

/// Values of the wedges of a model while they are coded.
pub(super) struct Values<'m> {
    pub(super) known: Known<'m>,
    all: &'m Wedges,
    layers: Vec<LayerColumns>,
    pub(super) leeways: Vec<Leeway>,
}

impl<'m> Values<'m> {
    fn new(mt: &'m Implicit, all: &'m Wedges, coding: &[LayerCoding], rows: Vec<i32>) -> Self {
        let layers = LayerColumns::of(coding);
        let normals = layers.iter().find(|layer| layer.kind == LayerKind::Normal);
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

    pub(super) fn number(&self, wedge: u32, column: usize) -> i32 {
        self.known.rows[wedge as usize * self.known.columns + column]
    }

    pub(super) fn set(&mut self, wedge: u32, column: usize, number: i32) {
        self.known.rows[wedge as usize * self.known.columns + column] = number;
    }

    pub(super) fn set_code(&mut self, wedge: u32, start: usize, [x, y]: Place) {
        self.set(wedge, start, x);
        self.set(wedge, start + 1, y);
    }

    /// Replaces the values of the parents of pairs by those that a file can hold.
    fn derive_parents(&mut self, stars: &SplitStars) {
        let layers = self.layers.clone();
        for layer in &layers {
            if let Some(bits) = layer.directions {
                let plane = OctahedralPlane::new(bits);
                for wedge in 0..self.known.kin.len() as u32 {
                    let code = self.known.code(wedge, layer.start);
                    self.set_code(wedge, layer.start, plane.code(code).0);
                }
            }
        }
        let (mut family, mut ring) = (Vec::new(), Slope::default());
        // Children and all nodes around are split by later updates.
        for (update, star) in stars.iter().rev() {
            self.family(update, &mut family);
            for of in family.iter().filter(|of| of.role() == Role::Difference) {
                let Some(pair) = self.pair(of) else { continue };
                self.known.fit_ring(pair.wedges[1], star, &mut ring);
                for layer in &layers {
                    self.derive_parent(&pair, layer, &ring);
                }
            }
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
