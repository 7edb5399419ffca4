//! Counts of symbols, to which predictions and tables are fitted.

use super::coder::Coder;
use super::models::{Chance, TableCodes};
use super::shape::fit_shape;

/// Counts what would be coded, for the tables to be fitted to.
#[derive(Clone, Debug)]
pub(in super::super) struct Statistics {
    /// Number of bits that are clear and set, for each context.
    pub(super) bits: Vec<[u32; 2]>,
    /// All residuals of each context.
    pub(super) residuals: Vec<Vec<i32>>,
}

impl Statistics {
    pub(in super::super) fn new(bits: usize, residuals: usize) -> Self {
        Self { bits: vec![[0; 2]; bits], residuals: vec![Vec::new(); residuals] }
    }
}

impl Coder for Statistics {
    fn bit(&mut self, context: usize, bit: Option<bool>) -> bool {
        let bit = bit.expect("an encoder is told");
        self.bits[context][usize::from(bit)] += 1;
        bit
    }

    fn residual(&mut self, context: usize, residual: Option<i32>) -> i32 {
        let residual = residual.expect("an encoder is told");
        self.residuals[context].push(residual);
        residual
    }

    fn number(&mut self, _: u32, number: Option<u32>) -> u32 {
        number.expect("an encoder is told")
    }
}

impl Statistics {
    /// Fits codes to what was counted.
    pub(super) fn codes(&self) -> TableCodes {
        let chance = |&counts: &[u32; 2]| (counts != [0; 2]).then(|| Chance::code(counts));
        let shape = |all: &Vec<i32>| (!all.is_empty()).then(|| fit_shape(all).0);
        let bits = self.bits.iter().map(chance).collect();
        TableCodes::new(bits, self.residuals.iter().map(shape).collect())
    }

    /// Returns about how many bits what was counted will take, tables included.
    pub(super) fn cost(&self) -> f64 {
        let residuals = self.residuals.iter().filter(|of| !of.is_empty());
        let residuals: f64 = residuals.map(|of| fit_shape(of).1 + 9.0).sum();
        let entropy = |[clear, set]: [u32; 2]| {
            let part = |count: u32| {
                let count = f64::from(count);
                if count > 0.0 { count * (f64::from(clear + set) / count).log2() } else { 0.0 }
            };
            part(clear) + part(set)
        };
        residuals + self.bits.iter().map(|&counts| entropy(counts)).sum::<f64>()
    }
}
