//! Reading of residuals and numbers.

use super::encode::{CHUNK_BITS, JOINT_LOW_BITS, LENGTH_BITS};
use super::models::{ESCAPE, MAX_RESIDUAL, Models, RESIDUAL_BITS, ResidualTable, unpack};
use super::predict::Width;
use super::rans::Symbols;

/// Decodes the difference of a number from its prediction.
#[inline(always)]
pub(super) fn residual(symbols: &mut Symbols, table: &ResidualTable, low_bits: u32) -> i32 {
    let slot = table.at(symbols.place(RESIDUAL_BITS));
    residual_at(symbols, slot, low_bits)
}

/// Decodes the difference of a coordinate from its prediction.
#[inline(always)]
pub(super) fn residual_of(symbols: &mut Symbols, models: &Models, width: Width) -> i32 {
    let at = width.class << RESIDUAL_BITS | symbols.place(RESIDUAL_BITS);
    residual_at(symbols, unpack(models.slots[at % models.slots.len()]), width.low_bits.into())
}

#[inline(always)]
fn residual_at(
    symbols: &mut Symbols,
    (symbol, size, offset): (usize, u32, u32),
    low_bits: u32,
) -> i32 {
    if symbol == ESCAPE || low_bits > u32::from(JOINT_LOW_BITS) {
        return rare(symbols, (symbol, size, offset), low_bits);
    }
    let low = symbols.consume(RESIDUAL_BITS, size, offset, low_bits);
    ((symbol as i32 - MAX_RESIDUAL) << low_bits) + low as i32 - (1 << low_bits >> 1)
}

#[cold]
fn rare(symbols: &mut Symbols, (symbol, size, offset): (usize, u32, u32), low_bits: u32) -> i32 {
    let with = if low_bits <= u32::from(JOINT_LOW_BITS) { low_bits } else { 0 };
    let mut low = symbols.consume(RESIDUAL_BITS, size, offset, with);
    if with < low_bits {
        low = number(symbols, low_bits);
    }
    let mut far = symbol as i32 - MAX_RESIDUAL;
    if symbol == ESCAPE {
        let is_below = symbols.uniform(1) == 1;
        far = any_number(symbols) as i32;
        far = if is_below { far.wrapping_neg() } else { far };
    }
    far.wrapping_shl(low_bits).wrapping_add(low as i32).wrapping_sub(1 << low_bits >> 1)
}

/// Decodes a number of a known length.
pub(super) fn number(symbols: &mut Symbols, bits: u32) -> u32 {
    let mut number = 0;
    let mut at = 0;
    while at < bits {
        let chunk = (bits - at).min(CHUNK_BITS);
        number |= symbols.uniform(chunk) << at;
        at += chunk;
    }
    number
}

/// Decodes a number of any length.
pub(super) fn any_number(symbols: &mut Symbols) -> u32 {
    let bits = symbols.uniform(u32::from(LENGTH_BITS));
    number(symbols, bits)
}
