//! Probability tables of attributes, fitted to the mesh and shared by all blocks of a file.

use super::super::models::ResidualTable;
use super::shape::{FREEDOM_BITS, ResidualShape, WIDTH_BITS};
use crate::bits::{BitReader, Bits};
use crate::bytes::{Malformed, Reader};

/// Bits of the table of a single bit.
pub(super) const BIT_BITS: u32 = 12;
const BIT_ALL: u16 = 1 << BIT_BITS;

/// Probability that a bit is clear, in 4096ths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chance(u16);

impl Chance {
    /// A code stands for a probability: 0 to 31 for seldom set, in half octaves; then seldom clear.
    fn of(code: u8) -> Self {
        const HALVES: [u32; 2] = [BIT_ALL as u32, 2896];
        let rare = |code: u8| {
            (HALVES[usize::from(code % 2)] >> (1 + code / 2)).max(MIN_PROBABILITY.into())
        };
        match code {
            0..CHANCES => Self(BIT_ALL - rare(code) as u16),
            _ => Self(rare((code - CHANCES).min(CHANCES - 1)) as u16),
        }
    }

    /// Returns the code for the numbers of clear and set bits.
    pub(super) fn code([clear, set]: [u32; 2]) -> u8 {
        let all = f64::from(clear + set) + 1.0;
        let half = |count: u32| {
            let code = 2.0 * (all / (f64::from(count) + 0.5)).log2() - 2.0;
            code.round().clamp(0.0, f64::from(CHANCES - 1)) as u8
        };
        if set <= clear { half(set) } else { CHANCES + half(clear) }
    }

    /// Returns where the share of a bit starts, and its size.
    #[inline]
    pub(super) fn share(self, bit: bool) -> (u16, u16) {
        if bit { (self.0, BIT_ALL - self.0) } else { (0, self.0) }
    }

    /// Returns the bit at a slot.
    #[inline]
    pub(super) fn at(self, place: u16) -> bool {
        place >= self.0
    }

    /// Moves the probability towards a bit.
    #[inline]
    pub(super) fn adapt(&mut self, bit: bool) {
        let to = if bit { MIN_PROBABILITY } else { BIT_ALL - MIN_PROBABILITY };
        let by = (i32::from(to) - i32::from(self.0)) / (1 << SLOWNESS);
        self.0 = (i32::from(self.0) + by) as u16;
    }
}

const CHANCES: u8 = 16;
/// Bits of a code.
const CHANCE_BITS: u32 = 5;
/// Minimum probability of a bit, in 4096ths.
const MIN_PROBABILITY: u16 = 8;
const SLOWNESS: u32 = 5;

/// Distribution of the residuals of a context.
#[derive(Clone, Debug)]
pub(super) struct ResidualModel {
    pub(super) table: ResidualTable,
    pub(super) low_bits: u8,
}

/// Tables of a file.
#[derive(Clone, Debug)]
pub(in super::super) struct LayerTables {
    pub(super) bits: Vec<Chance>,
    /// Distinct distributions, and the one of each context.
    models: Vec<ResidualModel>,
    of_context: Vec<u16>,
}

/// Codes of the tables, as stored: those of contexts that never occur are missing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in super::super) struct TableCodes {
    bits: Vec<Option<u8>>,
    residuals: Vec<Option<ResidualShape>>,
}

impl ResidualShape {
    fn model(self) -> ResidualModel {
        let (class, low_bits) = self.class();
        ResidualModel { table: ResidualTable::of(class, self.code()), low_bits }
    }
}

impl LayerTables {
    pub(in super::super) fn new(codes: &TableCodes) -> Self {
        // A damaged file may use a context that it has no codes of.
        let bits = codes.bits.iter().map(|code| Chance::of(code.unwrap_or_default()));
        let mut shapes: Vec<_> = codes.residuals.iter().map(|of| of.unwrap_or_default()).collect();
        let place =
            |shapes: &[ResidualShape], shape| shapes.binary_search(shape).unwrap_or(0) as u16;
        let all = shapes.clone();
        shapes.sort_unstable();
        shapes.dedup();
        Self {
            bits: bits.collect(),
            of_context: all.iter().map(|shape| place(&shapes, shape)).collect(),
            models: shapes.into_iter().map(ResidualShape::model).collect(),
        }
    }

    /// Returns the distribution of a context.
    #[inline]
    pub(super) fn residuals(&self, context: usize) -> &ResidualModel {
        &self.models[usize::from(self.of_context[context])]
    }
}

impl TableCodes {
    /// Creates codes of all contexts.
    pub(super) fn new(bits: Vec<Option<u8>>, residuals: Vec<Option<ResidualShape>>) -> Self {
        Self { bits, residuals }
    }

    pub(in super::super) fn store(&self, out: &mut Vec<u8>) {
        let mut bits = Bits::default();
        for code in &self.bits {
            bits.push(code.is_some().into(), 1);
            code.iter().for_each(|&code| bits.push(code.into(), CHANCE_BITS));
        }
        for shape in &self.residuals {
            bits.push(shape.is_some().into(), 1);
            if let Some(shape) = shape {
                bits.push(shape.width.into(), WIDTH_BITS);
                bits.push(shape.freedom.into(), FREEDOM_BITS);
            }
        }
        bits.store(out);
    }

    /// Reads the codes of a number of contexts.
    pub(in super::super) fn restore(
        bits: usize,
        residuals: usize,
        reader: &mut Reader,
    ) -> Result<Self, Malformed> {
        let mut source = BitReader::new(reader);
        let mut this = Self { bits: Vec::new(), residuals: Vec::new() };
        for _ in 0..bits {
            let is_there = source.take(1)? == 1;
            this.bits.push(
                is_there.then(|| source.take(CHANCE_BITS)).transpose()?.map(|code| code as u8),
            );
        }
        for _ in 0..residuals {
            let is_there = source.take(1)? == 1;
            let shape =
                is_there.then(|| Ok([source.take(WIDTH_BITS)?, source.take(FREEDOM_BITS)?]));
            let shape = shape.transpose()?;
            this.residuals
                .push(shape.map(|[w, f]| ResidualShape { width: w as u8, freedom: f as u8 }));
        }
        Ok(this)
    }
}
