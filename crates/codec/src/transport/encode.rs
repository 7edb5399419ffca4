//! Encoding of blocks as symbols.

use glam::{BVec4A, Vec4};

use super::fans::push_fans;
use super::gate::{Gate, NODE_BITS};
use super::lanes::{LANES, Vec3x4};
use super::models::{ESCAPE, MAX_RESIDUAL, Models, ResidualTable};
use super::predict::{CellVec, SpreadScales, Width};
use super::rans::Symbol;
use super::walk::BlockWalk;

/// Difference of a coordinate from its prediction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residual {
    value: i32,
    pub(super) class: u8,
    low_bits: u8,
}

impl Residual {
    /// Returns the symbol in the table of the class, the value without its low bits, and the low
    /// bits.
    pub(super) fn symbol(&self) -> (usize, i32, u16) {
        let raised = self.value + (1 << self.low_bits >> 1);
        let far = raised >> self.low_bits;
        let symbol = if far.abs() <= MAX_RESIDUAL { (far + MAX_RESIDUAL) as usize } else { ESCAPE };
        (symbol, far, (raised & ((1 << self.low_bits) - 1)) as u16)
    }

    /// Appends the symbols of the residual.
    fn push(&self, table: &ResidualTable, symbols: &mut Vec<Symbol>) {
        let (symbol, far, low) = self.symbol();
        let with = if self.low_bits <= JOINT_LOW_BITS { self.low_bits } else { 0 };
        let with_low = if with > 0 { low } else { 0 };
        let known = table.symbol(symbol, with_low, with);
        let is_far = known.is_none() || symbol == ESCAPE;
        let rare = || table.symbol(ESCAPE, with_low, with).expect("there are always others");
        symbols.push(known.unwrap_or_else(rare));
        if with < self.low_bits {
            push_number(u32::from(low), u32::from(self.low_bits), symbols);
        }
        if is_far {
            symbols.push(Symbol::uniform(u16::from(far < 0), 1));
            push_any(far.unsigned_abs(), symbols);
        }
    }
}

/// Greatest number of low bits that are coded together with their symbol.
pub(super) const JOINT_LOW_BITS: u8 = 5;
/// Bits of the length of a number of any length.
pub(super) const LENGTH_BITS: u8 = 5;
/// Greatest number of bits that are coded at once.
pub(super) const CHUNK_BITS: u32 = 12;

/// Encodes a residual with this many low bits in a table.
pub(super) fn push_residual(
    value: i32,
    low_bits: u8,
    table: &ResidualTable,
    symbols: &mut Vec<Symbol>,
) {
    Residual { value, class: 0, low_bits }.push(table, symbols);
}

/// Encodes a number of a known length.
pub(super) fn push_number(number: u32, bits: u32, symbols: &mut Vec<Symbol>) {
    let mut at = 0;
    while at < bits {
        let chunk = (bits - at).min(CHUNK_BITS);
        symbols.push(Symbol::uniform((number >> at & ((1 << chunk) - 1)) as u16, chunk as u8));
        at += chunk;
    }
}

/// Encodes a number of any length.
fn push_any(number: u32, symbols: &mut Vec<Symbol>) {
    let bits = u32::BITS - number.leading_zeros();
    symbols.push(Symbol::uniform(bits as u16, LENGTH_BITS));
    push_number(number, bits, symbols);
}

/// Computes the residuals of all vertices but the first, for up to four blocks.
pub(super) fn residuals(
    walks: &[BlockWalk],
    cells: &[CellVec],
    models: &Models,
) -> [Vec<Residual>; LANES] {
    // Gathered as in the decoder: each position is used some six times.
    let placed: [Vec<Vec4>; LANES] = std::array::from_fn(|lane| {
        let vertices = walks.get(lane).map_or(&[][..], |walk| &walk.vertices);
        vertices.iter().map(|&v| cells[v as usize].extend(0.0)).collect()
    });
    let at = |lane: usize, v: u16| placed[lane].get(usize::from(v)).copied().unwrap_or(Vec4::ZERO);
    let longest = walks.iter().map(|walk| walk.gates.len()).max().unwrap_or(0);
    let mut residuals: [Vec<Residual>; LANES] =
        std::array::from_fn(|_| Vec::with_capacity(3 * longest));
    let mut scales = SpreadScales::new();
    for v in 1..longest {
        let gate = |lane: usize| walks.get(lane).and_then(|walk| walk.gates.get(v)).copied();
        let known: [Option<Gate>; LANES] = std::array::from_fn(gate);
        let gates = known.map(Option::unwrap_or_default);
        let mut predictions = scales.predict(&gates, models, at);
        let places = Vec3x4::new(std::array::from_fn(|lane| at(lane, v as u16)));
        for (lane, gate) in gates.iter().enumerate().filter(|(_, gate)| gate.faces_a == 0) {
            predictions.start(lane, (v as u16, gate), models, |v| at(lane, v));
        }
        let values = predictions.encode(places);
        for (lane, _) in known.iter().enumerate().filter(|(_, gate)| gate.is_some()) {
            for (turn, value) in values.iter().enumerate() {
                let Width { class, low_bits } = predictions.widths(turn)[lane];
                let (value, class) = (value[lane] as i32, class as u8);
                residuals[lane].push(Residual { value, class, low_bits });
            }
        }
        scales.update(&predictions, places, BVec4A::from_array(gates.map(|gate| gate.faces_a > 0)));
    }
    residuals
}

/// Appends all symbols of a block. Returns where the residuals start and end.
pub(super) fn symbols(
    walk: &BlockWalk,
    (first, first_bits): (CellVec, [u8; 3]),
    tags: &[(u16, u32)],
    residuals: &[Residual],
    models: &Models,
    symbols: &mut Vec<Symbol>,
) -> [usize; 2] {
    for k in 0..3 {
        push_number(first[k] as u32, u32::from(first_bits[k]), symbols);
    }
    push_fans(&walk.steps, &walk.others, &models.fans, symbols);
    let from = symbols.len();
    for residual in residuals {
        residual.push(&models.residuals[usize::from(residual.class)], symbols);
    }
    let to = symbols.len();
    symbols.push(Symbol::uniform(u16::from(!tags.is_empty()), 1));
    if !tags.is_empty() {
        push_number(tags.len() as u32, NODE_BITS, symbols);
    }
    for &(vertex, tag) in tags {
        push_number(u32::from(vertex), NODE_BITS, symbols);
        push_any(tag, symbols);
    }
    [from, to]
}
