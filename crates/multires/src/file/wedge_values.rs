//! Coding of the values of wedges, by pairs of children.
//!
//! Where a wedge *p* has one child *a* at the first node and one *b* at the second, it lies about
//! between them. So the file has the difference of *a* and *b*, and by how much *p* is off the place
//! between them, in steps of some cells: values of nodes that are split need not be as exact as
//! those of the finest mesh. From these and *p* the reader computes *a* and *b*, without a loss:
//! what is added to each depends only on what the reader has [BE92].

use std::io;

use glam::DVec3;

use super::range_coder::{Decoder, Encoder};
use super::residual_models::{ResidualModels, Role};
use super::slope::Slope;
use super::streams::{Packer, Unpacker};
use super::wedge_state::{Kin, Lineage, WedgeError, WedgeState};
use crate::forest::NONE;

/// Weight of the step from the parent to the first child, which leads on to the second: all three are
/// mostly on a line.
const OWN: f64 = 8.0;
/// Number of ancestors by whose siblings values are predicted, and the weight of each relative to
/// the one before.
const ANCESTORS: usize = 6;
const FADE: f64 = 0.5;

impl WedgeState {
    /// Replaces the values of the parents of pairs by those that a file can hold.
    ///
    /// Updates must come from the finest to the coarsest.
    pub(super) fn derive_parents(&mut self, lineage: &[Lineage]) {
        for of in lineage.iter().filter(|of| of.partner.is_some() && of.is_second) {
            let Some(pair) = self.pair(of) else { continue };
            let columns = self.columns();
            for column in 0..columns {
                let [a, p, b] = pair.wedges.map(|wedge| self.row(wedge)[column]);
                let (between, step) = self.between(&pair, column, b.wrapping_sub(a));
                let off = nearest(p.wrapping_sub(a).wrapping_sub(between), step);
                let p = a.wrapping_add(between).wrapping_add(off.wrapping_mul(step));
                self.numbers[pair.wedges[1] as usize * columns + column] = p;
            }
        }
    }

    /// Encodes the values of the wedges of a run, given the class of distances of each update.
    pub(super) fn write_values(
        &self,
        lineage: &[Lineage],
        sizes: &[u8],
        packer: &mut Packer,
    ) -> io::Result<()> {
        let mut models = ResidualModels::new(self.columns());
        let mut encoder = Encoder::new();
        let start = lineage.first().map_or(0, |of| of.update);
        for of in lineage {
            let size = sizes[(of.update - start) as usize];
            models.code(&mut encoder, role(of), size, &mut self.residuals(of));
        }
        packer.encoded(lineage.len() * self.columns(), &encoder.finish())
    }

    /// Decodes the values of the wedges of a run.
    pub(super) fn read_values(
        &mut self,
        lineage: &[Lineage],
        sizes: &[u8],
        input: &mut Unpacker<'_>,
    ) -> Result<(), WedgeError> {
        if !self.in_pairs {
            return self.read_columns(lineage, input);
        }
        let columns = self.columns();
        let bytes = input.encoded(lineage.len() * columns)?;
        let mut decoder = Decoder::new(&bytes);
        let mut models = ResidualModels::new(columns);
        let start = lineage.first().map_or(0, |of| of.update);
        let from = self.numbers.len();
        self.numbers.resize(from + lineage.len() * columns, 0);
        // Residuals first take the place of values.
        for (of, row) in lineage.iter().zip(self.numbers[from..].chunks_mut(columns.max(1))) {
            models.code(&mut decoder, role(of), sizes[(of.update - start) as usize], row);
        }
        if !decoder.is_at_end() {
            return Err(WedgeError::Invalid("it has more attribute values than wedges"));
        }
        for update in lineage.chunk_by(|a, b| a.update == b.update) {
            // Other wedges may be predicted from those of pairs.
            update
                .iter()
                .filter(|of| of.partner.is_some() && of.is_second)
                .for_each(|of| self.solve(of));
            for of in update.iter().filter(|of| of.partner.is_none()) {
                let predicted = self.predicted(of);
                self.set(of.wedge, |column, residual| predicted[column].wrapping_add(residual));
            }
        }
        Ok(())
    }

    /// Decodes the values in the form of earlier versions, with a stream for each column.
    fn read_columns(
        &mut self,
        lineage: &[Lineage],
        input: &mut Unpacker<'_>,
    ) -> Result<(), WedgeError> {
        let residuals = (0..self.columns()).map(|_| input.signed(lineage.len()));
        let residuals = residuals.collect::<io::Result<Vec<_>>>()?;
        self.numbers.reserve(lineage.len() * self.columns());
        for (i, of) in lineage.iter().enumerate() {
            let numbers = self.predicted(of);
            let numbers = numbers.iter().zip(&residuals);
            self.numbers.extend(numbers.map(|(&x, column)| x.wrapping_add(column[i])));
        }
        Ok(())
    }

    fn set(&mut self, wedge: u32, value: impl Fn(usize, i32) -> i32) {
        let columns = self.columns();
        let row = &mut self.numbers[wedge as usize * columns..][..columns];
        row.iter_mut().enumerate().for_each(|(column, number)| *number = value(column, *number));
    }

    /// Computes the values of a pair from their residuals.
    fn solve(&mut self, of: &Lineage) {
        let Some(pair) = self.pair(of) else { return };
        let predicted = self.predicted_difference(&pair);
        let columns = self.columns();
        for (column, predicted) in predicted.into_iter().enumerate() {
            let [off, p, residual] = pair.wedges.map(|wedge| self.row(wedge)[column]);
            let difference = predicted.wrapping_add(residual);
            let (between, step) = self.between(&pair, column, difference);
            let a = p.wrapping_sub(off.wrapping_mul(step)).wrapping_sub(between);
            self.numbers[pair.wedges[0] as usize * columns + column] = a;
            self.numbers[pair.wedges[2] as usize * columns + column] = a.wrapping_add(difference);
        }
    }

    /// Returns what the file has for a wedge.
    fn residuals(&self, of: &Lineage) -> Vec<i32> {
        let columns = 0..self.columns();
        let own = |column: usize| self.row(of.wedge)[column];
        match (role(of), self.pair(of)) {
            (Role::Parent, Some(pair)) => {
                let off = |column: usize| {
                    let [a, p, b] = pair.wedges.map(|wedge| self.row(wedge)[column]);
                    let (between, step) = self.between(&pair, column, b.wrapping_sub(a));
                    nearest(p.wrapping_sub(a).wrapping_sub(between), step)
                };
                columns.map(off).collect()
            }
            (Role::Difference, Some(pair)) => {
                let predicted = self.predicted_difference(&pair);
                let from =
                    |column: usize| own(column).wrapping_sub(self.row(pair.wedges[0])[column]);
                columns.map(|column| from(column).wrapping_sub(predicted[column])).collect()
            }
            _ => {
                let predicted = self.predicted(of);
                columns.map(|column| own(column).wrapping_sub(predicted[column])).collect()
            }
        }
    }

    /// Returns the pair that a wedge is of.
    fn pair(&self, of: &Lineage) -> Option<Pair> {
        let (own, other) = (of.wedge, of.partner?);
        let (first, second) = if of.is_second { (other, own) } else { (own, other) };
        let wedges = [first, of.parent?, second];
        let [a, p, b] = wedges.map(|wedge| self.kin[wedge as usize].place.as_dvec3());
        let way = b - a;
        let length = way.length_squared();
        let part = if length > 0.0 { (way.dot(p - a) / length).clamp(0.0, 1.0) } else { 0.5 };
        Some(Pair { wedges, part })
    }

    /// Returns by how much the parent of a pair is expected to differ from the first child, and the
    /// steps in which it is off that.
    fn between(&self, pair: &Pair, column: usize, difference: i32) -> (i32, i32) {
        let between = (pair.part * f64::from(difference)).round() as i32;
        (between, self.leeways[column].step(difference))
    }

    /// Returns the predicted differences of a pair's values.
    fn predicted_difference(&self, pair: &Pair) -> Vec<i32> {
        let [first, parent, second] = pair.wedges;
        let mut slope = Slope::default();
        self.add_ancestors(parent, &mut slope);
        self.along(&slope, self.way([second, first]))
    }

    /// Returns the predicted integers of a wedge that is of no pair.
    fn predicted(&self, of: &Lineage) -> Vec<i32> {
        let Some(parent) = of.parent else { return vec![0; self.columns()] };
        let base = of.sibling.unwrap_or(parent);
        let mut slope = Slope::default();
        if let Some(first) = of.sibling {
            slope.add(self.way([first, parent]), [first, parent], OWN);
        }
        self.add_ancestors(parent, &mut slope);
        let steps = self.along(&slope, self.way([of.wedge, base]));
        steps.iter().zip(self.row(base)).map(|(step, &at)| at.wrapping_add(*step)).collect()
    }

    /// Adds the steps between a wedge and its sibling, and between those above.
    fn add_ancestors(&self, wedge: u32, slope: &mut Slope) {
        let (mut at, mut weight) = (wedge, 1.0);
        for _ in 0..ANCESTORS {
            let Kin { parent, sibling, .. } = self.kin[at as usize];
            if sibling != NONE {
                slope.add(self.way([at, sibling]), [at, sibling], weight);
                weight *= FADE;
            }
            if parent == NONE {
                break;
            }
            at = parent;
        }
    }

    /// Returns by how much values change along a way.
    fn along(&self, slope: &Slope, way: DVec3) -> Vec<i32> {
        let parts = slope.parts(way);
        let change = |column: usize| {
            let at = |wedge: u32| f64::from(self.row(wedge)[column]);
            let steps = parts.iter().map(|&(part, [to, from])| part * (at(to) - at(from)));
            steps.sum::<f64>().round() as i32
        };
        (0..self.columns()).map(change).collect()
    }

    /// Returns the way from the second wedge to the first.
    fn way(&self, [to, from]: [u32; 2]) -> DVec3 {
        (self.kin[to as usize].place - self.kin[from as usize].place).as_dvec3()
    }
}

/// The children of a wedge, one at each node, and the wedge between them.
struct Pair {
    wedges: [u32; 3],
    /// Part of the way from the first child to the second at which the parent is.
    part: f64,
}

/// Divides a number and rounds it to the nearest integer; `step` must be odd.
fn nearest(number: i32, step: i32) -> i32 {
    let half = i64::from(step / 2);
    (i64::from(number) + half).div_euclid(i64::from(step)) as i32
}

fn role(of: &Lineage) -> Role {
    match (of.partner.is_some(), of.is_second) {
        (false, _) => Role::Single,
        (true, false) => Role::Parent,
        (true, true) => Role::Difference,
    }
}
