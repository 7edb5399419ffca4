//! Values of the wedges of all levels, as residuals of predictions from the ones before.
//!
//! Where a wedge *p* has one child *a* at the first node and one *b* at the second, it lies about
//! between them. So the file has the difference of *a* and *b*, and by how much *p* is off the place
//! between them, in steps of some cells: values of nodes that are split need not be as exact as
//! those of the finest mesh. From these and *p* the reader computes *a* and *b*, without a loss:
//! what is added to each depends only on what the reader has [BE92].

use glam::Vec3;

use crate::cut::{SplitStars, StarFace, each_split_star};
use crate::forest::NONE;
use crate::implicit::Implicit;
use crate::wedges::Wedges;

use super::layer_coding::{LayerCoding, Leeway};
use super::lineage::{Lineage, Role, relate};
use super::pair_values::PairShares;
use super::slope::Slopes;
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
    let stars = SplitStars::of(mt);
    values.derive_parents(&stars);
    let mut out = values.known.rows.clone();
    let (mut shares, mut single) = (PairShares::default(), SingleShares::default());
    let mut family = Vec::new();
    for (update, star) in stars.iter() {
        values.family(update, &mut family);
        values.link(&family);
        for of in &family {
            let mut set = |wedge: u32, column: usize, number: i32| {
                out[wedge as usize * values.known.columns + column] = number;
            };
            match (of.role(), values.pair(of)) {
                (Role::Difference, Some(pair)) => {
                    values.share(&pair, star, &mut shares);
                    for layer in &values.layers {
                        values.pair_residuals(&pair, layer, &shares, &mut set);
                    }
                }
                (Role::Parent, Some(_)) => {}
                _ => {
                    values.share_single(of, star, &mut single);
                    for layer in &values.layers {
                        values.single_residuals(of, layer, &single, &mut set);
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
    for root in mt.roots().flat_map(|(root, _)| all.of(root)) {
        for directions in layers.iter().filter_map(|layer| layer.directions) {
            let code = values.known.code(root, directions);
            values.known.set_code(root, directions, code);
        }
    }
    let (mut shares, mut single) = (PairShares::default(), SingleShares::default());
    let mut family = Vec::new();
    each_split_star(mt, |update, star| {
        values.family(update, &mut family);
        values.link(&family);
        // Other wedges may be predicted from those of pairs.
        for of in family.iter().filter(|of| of.role() == Role::Difference) {
            let Some(pair) = values.pair(of) else { continue };
            values.share(&pair, star, &mut shares);
            layers.iter().for_each(|layer| values.solve_pair(&pair, layer, &shares));
        }
        for of in family.iter().filter(|of| of.role() == Role::Single) {
            values.share_single(of, star, &mut single);
            layers.iter().for_each(|layer| values.solve_single(of, layer, &single));
        }
    });
    values.known.rows
}

/// Wedges by which the values of a wedge of no pair are predicted, with their shares in the change to
/// it from another.
#[derive(Default)]
struct SingleShares {
    slopes: Slopes,
    shares: Vec<[f64; 1]>,
}

impl SingleShares {
    fn iter(&self) -> impl Iterator<Item = (u32, [f64; 1])> {
        self.slopes.wedges().iter().copied().zip(self.shares.iter().copied())
    }
}

/// Values of the wedges of a model while they are coded.
pub(super) struct Values<'m> {
    pub(super) known: Known,
    mt: &'m Implicit,
    all: &'m Wedges,
    layers: Vec<LayerColumns>,
    pub(super) leeways: Vec<Leeway>,
}

impl<'m> Values<'m> {
    fn new(mt: &'m Implicit, all: &'m Wedges, coding: &[LayerCoding], rows: Vec<i32>) -> Self {
        let layers = LayerColumns::of(coding);
        let leeways = coding.iter().flat_map(LayerCoding::leeways).collect();
        let mut kin = Vec::with_capacity(all.first(mt.node_count() as u32) as usize);
        for node in 0..mt.node_count() as u32 {
            let place = Vec3::from(mt.stored_position(node));
            let own = Kin { place, parent: NONE, sibling: NONE };
            kin.extend(all.of(node).map(|_| own));
        }
        Self { known: Known::new(&layers, rows, kin), mt, all, layers, leeways }
    }

    /// Notes how the wedges of an update's children are related.
    fn link(&mut self, family: &[Lineage]) {
        let kin = &mut self.known.kin;
        for of in family {
            kin[of.wedge as usize].parent = of.parent.unwrap_or(NONE);
            if let Some(sibling) = of.sibling {
                kin[of.wedge as usize].sibling = sibling;
                kin[sibling as usize].sibling = of.wedge;
            }
        }
    }

    fn family(&self, update: u32, family: &mut Vec<Lineage>) {
        family.clear();
        let (mt, all) = (self.mt, self.all);
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

    /// Replaces the values of the parents of pairs by those that a file can hold.
    fn derive_parents(&mut self, stars: &SplitStars) {
        let layers = self.layers.clone();
        for layer in &layers {
            let Some(directions) = layer.directions else { continue };
            for wedge in 0..self.known.kin.len() as u32 {
                let code = directions.plane().code(self.known.code(wedge, directions)).0;
                self.known.set_code(wedge, directions, code);
            }
        }
        let ranges = self.known.ranges();
        let (mut family, mut shares) = (Vec::new(), PairShares::default());
        // Children and all nodes around are split by later updates.
        for (update, star) in stars.iter().rev() {
            self.family(update, &mut family);
            for of in family.iter().filter(|of| of.role() == Role::Difference) {
                let Some(pair) = self.pair(of) else { continue };
                self.share(&pair, star, &mut shares);
                for layer in &layers {
                    self.derive_parent(&pair, layer, &shares, &ranges);
                }
            }
        }
    }

    /// Computes the shares of the wedges around in the values of a wedge of no pair.
    fn share_single(&self, of: &Lineage, star: &[StarFace], shares: &mut SingleShares) {
        let SingleShares { slopes, shares } = shares;
        let parent = of.parent.unwrap_or(0);
        self.known.fit(parent, of.sibling, star, slopes);
        let base = of.sibling.unwrap_or(parent);
        slopes.shares([self.known.way([of.wedge, base])], shares);
    }

    /// Computes the residuals of a wedge of no pair.
    fn single_residuals(
        &self,
        of: &Lineage,
        layer: &LayerColumns,
        shares: &SingleShares,
        set: &mut impl FnMut(u32, usize, i32),
    ) {
        let Some(base) = of.sibling.or(of.parent) else { return };
        if let Some(directions) = layer.directions {
            let wedges = ([of.wedge], base);
            let [predicted] = self.known.directions_at(wedges, layer, directions, shares.iter());
            let code = self.known.code(of.wedge, directions);
            let at = directions.plane().near(code, predicted);
            (0..2).for_each(|k| set(of.wedge, layer.start + k, at[k] - predicted[k]));
        }
        for columns in layer.plain() {
            let shares = shares.iter().map(|(wedge, [share])| (wedge, share));
            let changes = self.known.changes(layer, &columns, shares);
            for (column, change) in columns.zip(changes) {
                let predicted = self.number(base, column).wrapping_add(change);
                set(of.wedge, column, self.number(of.wedge, column).wrapping_sub(predicted));
            }
        }
    }

    /// Computes the values of a wedge of no pair from their residuals.
    fn solve_single(&mut self, of: &Lineage, layer: &LayerColumns, shares: &SingleShares) {
        let Some(base) = of.sibling.or(of.parent) else { return };
        if let Some(directions) = layer.directions {
            let wedges = ([of.wedge], base);
            let [predicted] = self.known.directions_at(wedges, layer, directions, shares.iter());
            let residual = self.known.code(of.wedge, directions);
            let at = [0, 1].map(|k| predicted[k].wrapping_add(residual[k]));
            self.known.set_code(of.wedge, directions, directions.plane().code(at).0);
        }
        for columns in layer.plain() {
            let shares = shares.iter().map(|(wedge, [share])| (wedge, share));
            let changes = self.known.changes(layer, &columns, shares);
            for (column, change) in columns.zip(changes) {
                let predicted = self.number(base, column).wrapping_add(change);
                self.set(of.wedge, column, self.number(of.wedge, column).wrapping_add(predicted));
            }
        }
    }
}
