//! One walk over a block for encoder, decoder and statistics: what differs is what becomes of a
//! decision.

use super::super::encode::{push_number, push_residual};
use super::super::rans::{Symbol, Symbols};
use super::super::read::{number, residual};
use super::models::{BIT_BITS, Chance, LayerTables, ResidualModel};

/// Section of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum BlockPart {
    /// Wedges of corners.
    Wedges,
    /// Attribute layer with this number.
    Layer(usize),
    /// Materials and objects.
    Labels,
}

/// Receiver of the decisions of a block. An encoder receives each value, a decoder returns it.
pub(in super::super) trait Coder {
    /// Notes that a part of the block begins.
    fn begin(&mut self, _: BlockPart) {}
    /// Codes a bit whose probability is adapted as the block goes on.
    fn bit(&mut self, context: usize, bit: Option<bool>) -> bool;
    /// Codes the difference of a number from its prediction.
    fn residual(&mut self, context: usize, residual: Option<i32>) -> i32;
    /// Codes one of 2^`bits` equally likely numbers.
    fn number(&mut self, bits: u32, number: Option<u32>) -> u32;
}

/// Probabilities of a block's bits, which all blocks start with.
#[derive(Clone, Debug, Default)]
struct AdaptiveBits(Vec<Chance>);

impl AdaptiveBits {
    fn of(tables: &LayerTables) -> Self {
        Self(tables.bits.clone())
    }
}

/// Coder that appends symbols.
pub(in super::super) struct SymbolWriter<'a> {
    tables: &'a LayerTables,
    bits: AdaptiveBits,
    symbols: &'a mut Vec<Symbol>,
    /// Each part with the number of symbols before it.
    pub(in super::super) parts: Vec<(BlockPart, usize)>,
}

impl<'a> SymbolWriter<'a> {
    pub(in super::super) fn new(tables: &'a LayerTables, symbols: &'a mut Vec<Symbol>) -> Self {
        Self { tables, bits: AdaptiveBits::of(tables), symbols, parts: Vec::new() }
    }
}

impl Coder for SymbolWriter<'_> {
    fn begin(&mut self, part: BlockPart) {
        self.parts.push((part, self.symbols.len()));
    }

    fn bit(&mut self, context: usize, bit: Option<bool>) -> bool {
        let bit = bit.expect("an encoder is told");
        let (start, size) = self.bits.0[context].share(bit);
        let bits = BIT_BITS as u8;
        self.symbols.push(Symbol { start, size, bits, low_bits: 0, low: 0 });
        self.bits.0[context].adapt(bit);
        bit
    }

    fn residual(&mut self, context: usize, residual: Option<i32>) -> i32 {
        let residual = residual.expect("an encoder is told");
        let ResidualModel { table, low_bits } = self.tables.residuals(context);
        push_residual(residual, *low_bits, table, self.symbols);
        residual
    }

    fn number(&mut self, bits: u32, number: Option<u32>) -> u32 {
        let number = number.expect("an encoder is told");
        push_number(number, bits, self.symbols);
        number
    }
}

/// Coder that reads symbols.
pub(in super::super) struct SymbolReader<'a, 's, 'b> {
    tables: &'a LayerTables,
    bits: AdaptiveBits,
    symbols: &'s mut Symbols<'b>,
}

impl<'a, 's, 'b> SymbolReader<'a, 's, 'b> {
    pub(in super::super) fn new(tables: &'a LayerTables, symbols: &'s mut Symbols<'b>) -> Self {
        Self { tables, bits: AdaptiveBits::of(tables), symbols }
    }
}

impl Coder for SymbolReader<'_, '_, '_> {
    #[inline]
    fn bit(&mut self, context: usize, _: Option<bool>) -> bool {
        let chance = &mut self.bits.0[context];
        let place = self.symbols.place(BIT_BITS) as u16;
        let bit = chance.at(place);
        let (start, size) = chance.share(bit);
        self.symbols.consume(BIT_BITS, u32::from(size), u32::from(place - start), 0);
        chance.adapt(bit);
        bit
    }

    #[inline]
    fn residual(&mut self, context: usize, _: Option<i32>) -> i32 {
        let ResidualModel { table, low_bits } = self.tables.residuals(context);
        residual(self.symbols, table, u32::from(*low_bits))
    }

    fn number(&mut self, bits: u32, _: Option<u32>) -> u32 {
        number(self.symbols, bits)
    }
}
