//! Probability and prediction models that all blocks of a file share.
//!
//! Nothing is learnt while decoding, so that every block can be decoded alone. The models take some
//! hundred bytes of a file.

use glam::Vec4;

use super::border::Step;
use super::fans::FanTable;
use super::gate::CONTEXTS;
use super::predict::{FEATURES, GATES};
use super::rans::Symbol;
use crate::bits::{BitReader, Bits};
use crate::bytes::{Malformed, Reader};

/// Bits of the tables of residuals.
pub(super) const RESIDUAL_BITS: u32 = 11;
pub(super) const RESIDUAL_ALL: usize = 1 << RESIDUAL_BITS;
/// Largest residual with its own symbol.
pub(super) const MAX_RESIDUAL: i32 = 24;
pub(super) const SYMBOLS: usize = 2 * MAX_RESIDUAL as usize + 2;
/// Symbol that escapes to larger residuals.
pub(super) const ESCAPE: usize = SYMBOLS - 1;
/// Classes of widths: a quarter of an octave each, from a quarter of a cell to four cells. Larger
/// widths use the last four, and low bits.
pub(super) const CLASSES: usize = 16;

/// Bits of the tables of steps.
pub(super) const STEP_BITS: u32 = 12;
const STEP_ALL: u32 = 1 << STEP_BITS;
const STEPS: usize = Step::ALL.len();

/// Model parameters as stored in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ModelCodes {
    pub(super) weights: [[i8; FEATURES]; GATES],
    pub(super) spreads: [[u8; 2]; GATES],
    pub(super) start: u8,
    pub(super) shapes: [u8; CLASSES],
    /// Step frequencies of each context that has its own table; the last table serves all others.
    pub(super) steps: Vec<Option<[u8; STEPS]>>,
}

/// Models expanded for use.
#[derive(Clone, Debug)]
pub(super) struct Models {
    /// For each kind of gate the feature weights, then the variances along the surface and across
    /// it relative to the gate's squared sides.
    pub(super) gates: [[Vec4; 2]; GATES],
    /// Variance of the corners of a separate face.
    pub(super) start: f32,
    pub(super) residuals: Box<[ResidualTable; CLASSES]>,
    /// The slots of all of these, class after class.
    pub(super) slots: Box<[u32; CLASSES * RESIDUAL_ALL]>,
    pub(super) steps: Box<[StepTable; CONTEXTS]>,
    pub(super) fans: Box<[FanTable; CONTEXTS]>,
}

/// Probability table of the residuals of a class.
#[derive(Clone, Debug)]
pub(super) struct ResidualTable {
    /// For each slot the symbol, its size, and the slot's offset from the symbol's start.
    places: Box<[u32; RESIDUAL_ALL]>,
    starts: [u16; SYMBOLS + 1],
}

/// Probability table of steps: the start of each, and the end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepTable([u16; STEPS + 1]);

impl ResidualTable {
    /// Returns the symbol at a slot, its size, and the slot's offset from its start.
    #[inline(always)]
    pub(super) fn at(&self, place: usize) -> (usize, u32, u32) {
        unpack(self.places[place % RESIDUAL_ALL])
    }

    /// Returns a symbol with low bits; `None` if it has no slots and must be escaped.
    pub(super) fn symbol(&self, symbol: usize, low: u16, low_bits: u8) -> Option<Symbol> {
        let (start, end) = (self.starts[symbol], self.starts[symbol + 1]);
        let bits = RESIDUAL_BITS as u8;
        (start < end).then(|| Symbol { start, size: end - start, bits, low_bits, low })
    }

    pub(super) fn of(class: usize, code: u8) -> Self {
        Self::cut(&parts(class, code))
    }

    /// Distributes the slots in proportion. Symbols too rare for a slot are left to the escape.
    fn cut(parts: &[f64; SYMBOLS]) -> Self {
        let all: f64 = parts.iter().sum();
        let mut sizes: Vec<i32> =
            parts.iter().map(|part| (part / all * RESIDUAL_ALL as f64 + 0.5) as i32).collect();
        sizes[ESCAPE] = sizes[ESCAPE].max(1);
        // The most likely symbol makes up for all rounding.
        let middle = MAX_RESIDUAL as usize;
        sizes[middle] += RESIDUAL_ALL as i32 - sizes.iter().sum::<i32>();
        debug_assert!(sizes[middle] > 0);
        let mut starts = [0; SYMBOLS + 1];
        let mut places = vec![0; RESIDUAL_ALL];
        for (symbol, &size) in sizes.iter().enumerate() {
            let start = starts[symbol];
            starts[symbol + 1] = start + size as u16;
            for offset in 0..size as u32 {
                places[usize::from(start) + offset as usize] =
                    offset << 18 | (size as u32) << 6 | symbol as u32;
            }
        }
        let places: Box<[u32]> = places.into();
        Self { places: places.try_into().expect("as many as there are"), starts }
    }
}

/// Returns the symbol of a slot, its size, and the slot's offset from its start.
#[inline(always)]
pub(super) fn unpack(slot: u32) -> (usize, u32, u32) {
    ((slot & 63) as usize, slot >> 6 & 0xfff, slot >> 18)
}

/// Integrates Student's t-distribution over the cell of each symbol, with the width and the degrees
/// of freedom of a shape code.
pub(super) fn parts(class: usize, code: u8) -> [f64; SYMBOLS] {
    let width = pow2(2 * class as i32 - 15 + i32::from(code & 31) - 16);
    let freedom = FREEDOM[usize::from(code >> 5)];
    let scale = 1.0 / (width * width * f64::from(freedom));
    let density = |x: f64| {
        let part = 1.0 / (1.0 + x * x * scale);
        (0..freedom.div_ceil(2)).fold(1.0, |product, _| product * part)
    };
    // Simpson's rule on the two halves of a cell.
    let part = |d: i32| {
        let at = |quarters: i32| density(f64::from(d) + f64::from(quarters) / 4.0);
        (at(-2) + at(2) + 4.0 * (at(-1) + at(1)) + 2.0 * at(0)) / 12.0
    };
    let mut parts = [0.0; SYMBOLS];
    for d in 0..=MAX_RESIDUAL {
        let part = part(d);
        parts[(MAX_RESIDUAL + d) as usize] = part;
        parts[(MAX_RESIDUAL - d) as usize] = part;
    }
    // The tail in steps of eight cells, as far as residuals are to be expected.
    let beyond = (0..20).map(|k| density(f64::from(MAX_RESIDUAL + 4 + 8 * k)));
    parts[ESCAPE] = 16.0 * beyond.sum::<f64>();
    parts
}

/// Degrees of freedom, all odd.
const FREEDOM: [u32; 8] = [1, 3, 5, 7, 9, 13, 19, 31];
/// Returns 2^(`eighths` / 8), the same on every machine.
pub(super) fn pow2(eighths: i32) -> f64 {
    const PARTS: [f64; 8] = [
        1.0,
        1.090_507_732_665_257_7,
        1.189_207_115_002_721,
        1.296_839_554_651_009_6,
        std::f64::consts::SQRT_2,
        1.542_210_825_407_940_7,
        1.681_792_830_507_429,
        1.834_008_086_409_342_4,
    ];
    let whole = f64::from_bits(((1023 + eighths.div_euclid(8)) as u64) << 52);
    whole * PARTS[eighths.rem_euclid(8) as usize]
}

impl StepTable {
    /// Returns the step at a slot, its size, and the slot's offset from its start.
    #[inline(always)]
    pub(super) fn at(&self, place: usize) -> (Step, u32, u32) {
        let place = place as u16;
        let offset = |k: usize| usize::from(place >= self.0[k]);
        let step = offset(1) + offset(2) + offset(3) + offset(4);
        let start = self.0[step];
        (Step::ALL[step], u32::from(self.0[step + 1] - start), u32::from(place.wrapping_sub(start)))
    }

    pub(super) fn symbol(&self, step: Step) -> Symbol {
        let start = self.0[step as usize];
        let size = self.0[step as usize + 1] - start;
        Symbol { start, size, bits: STEP_BITS as u8, low_bits: 0, low: 0 }
    }

    /// Builds a table. A code is a power of the cube root of ½; every step gets at least one slot.
    pub(super) fn of(codes: [u8; STEPS]) -> Self {
        const THIRDS: [u32; 3] = [1 << 16, 52_016, 41_285];
        let part = |code: u8| (THIRDS[usize::from(code) % 3] >> (code / 3)).max(1);
        let all: u32 = codes.iter().map(|&code| part(code)).sum();
        let mut sizes = codes.map(|code| (part(code) * (STEP_ALL - 8) / all).max(1));
        let most = (0..STEPS).max_by_key(|&k| sizes[k]).unwrap_or(0);
        sizes[most] += STEP_ALL - sizes.iter().sum::<u32>();
        let mut starts = [0; STEPS + 1];
        for (k, size) in sizes.iter().enumerate() {
            starts[k + 1] = starts[k] + *size as u16;
        }
        Self(starts)
    }

    /// Returns the codes closest to the observed counts.
    pub(super) fn codes(counts: [u32; STEPS]) -> [u8; STEPS] {
        let all: u32 = counts.iter().sum();
        counts.map(|count| {
            let code = 3.0 * (f64::from(all) / f64::from(count)).log2();
            code.round().clamp(0.0, 31.0) as u8
        })
    }
}

/// Bits of a step's code.
const CODE_BITS: u32 = 5;

impl ModelCodes {
    pub(super) fn store(&self, out: &mut Vec<u8>) {
        out.extend(self.weights.iter().flatten().map(|&w| w as u8));
        out.extend(self.spreads.iter().flatten());
        out.push(self.start);
        out.extend(self.shapes);
        let mut bits = Bits::default();
        for codes in &self.steps {
            bits.push(u64::from(codes.is_some()), 1);
            for &code in codes.iter().flatten() {
                bits.push(u64::from(code), CODE_BITS);
            }
        }
        bits.store(out);
    }

    pub(super) fn restore(reader: &mut Reader) -> Result<Self, Malformed> {
        let mut this = Self {
            weights: [[0; FEATURES]; GATES],
            spreads: [[0; 2]; GATES],
            start: 0,
            shapes: [0; CLASSES],
            steps: Vec::with_capacity(CONTEXTS + 1),
        };
        for weight in this.weights.iter_mut().flatten() {
            *weight = reader.u8()? as i8;
        }
        for spread in this.spreads.iter_mut().flatten() {
            *spread = reader.u8()?;
        }
        this.start = reader.u8()?;
        for shape in &mut this.shapes {
            *shape = reader.u8()?;
        }
        let mut source = BitReader::new(reader);
        for _ in 0..=CONTEXTS {
            let mut codes = None;
            if source.take(1)? == 1 {
                let all = source.take(CODE_BITS * STEPS as u32)?;
                codes = Some(std::array::from_fn(|k| (all >> (CODE_BITS * k as u32) & 31) as u8));
            }
            this.steps.push(codes);
        }
        Ok(this)
    }
}

impl Models {
    pub(super) fn new(codes: &ModelCodes) -> Self {
        let rest = codes.steps.last().copied().flatten().unwrap_or([6; STEPS]);
        let gate = |kind: usize| {
            let [w0, w1, w2, w3, w4] = codes.weights[kind].map(|weight| f32::from(weight) / 64.0);
            let [along, across] = codes.spreads[kind].map(|code| pow2(32 - i32::from(code)) as f32);
            [Vec4::new(w0, w1, w2, w3), Vec4::new(w4, along, across, 0.0)]
        };
        let steps = Box::new(std::array::from_fn(|context| {
            StepTable::of(codes.steps[context].unwrap_or(rest))
        }));
        let residuals: Box<[_; CLASSES]> =
            Box::new(std::array::from_fn(|class| ResidualTable::of(class, codes.shapes[class])));
        let slots: Vec<u32> = residuals.iter().flat_map(|table| *table.places).collect();
        let slots: Box<[u32]> = slots.into();
        Self {
            gates: std::array::from_fn(gate),
            start: pow2(2 * i32::from(codes.start)) as f32,
            slots: slots.try_into().expect("as many as there are"),
            residuals,
            fans: FanTable::all(&steps),
            steps,
        }
    }
}
