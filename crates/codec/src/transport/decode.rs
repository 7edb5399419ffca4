//! Blocks from bytes that may be anything.

use super::border::{Border, NODES, Step};
use super::encode::{CHUNK_BITS, LENGTH_BITS, WITH_BITS};
use super::gate::{Gate, NODE_BITS, OTHERS, OTHERS_BITS, context, walk};
use super::join::checksum;
use super::models::{DISTANCE_BITS, FAR, MOST, Models, STEP_BITS};
use super::predict::{Cells, Guess, SPAN, Trend};
use super::rans::Symbols;
use crate::bytes::Malformed;

const MASK: usize = NODES - 1;

/// Room for one block after the other.
pub(super) struct Lane {
    border: Border,
    births: Vec<Gate>,
    cells: Box<[Cells; NODES]>,
    pub(super) faces: Vec<[u16; 3]>,
    /// Those vertices that are not what their cell says.
    tags: Vec<(u16, u32)>,
}

/// Whether a vertex may be in other blocks too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reach {
    Inside,
    /// One with all of its cell that have this tag.
    Joint(u32),
}

impl Lane {
    pub(super) fn new() -> Self {
        let cells: Box<[Cells]> = vec![Cells::ZERO; NODES].into();
        Self {
            border: Border::new(),
            births: Vec::with_capacity(NODES),
            cells: cells.try_into().expect("as many as there are"),
            faces: Vec::new(),
            tags: Vec::new(),
        }
    }

    /// The cells of the vertices of the last block.
    pub(super) fn cells(&self) -> &[Cells] {
        &self.cells[..self.births.len()]
    }

    /// Decodes a block of at most [`super::border::MOST_FACES`] faces.
    pub(super) fn decode(
        &mut self,
        bytes: &[u8],
        faces: usize,
        models: &Models,
        first_bits: [u8; 3],
    ) -> Result<(), Malformed> {
        let mut symbols = Symbols::new(bytes)?;
        let first = first_bits.map(|bits| number(&mut symbols, u32::from(bits)) as f32);
        self.cells[0] = Cells::from(first);
        self.connect(&mut symbols, faces, models);
        let is_inside = self.place(&mut symbols, models);
        self.read_tags(&mut symbols)?;
        symbols.finish(checksum(self.cells().iter().copied()))?;
        if is_inside { Ok(()) } else { Err(wrong("a vertex is outside of all cells")) }
    }

    #[inline(never)]
    fn connect(&mut self, symbols: &mut Symbols, faces: usize, models: &Models) {
        self.border.clear();
        self.births.clear();
        self.faces.clear();
        while self.faces.len() < faces {
            let Some(at) = self.border.pivot() else {
                let first = self.births.len() as u16;
                let corners = [first, first + 1, first + 2];
                self.births.extend([0, 1, 2].map(Gate::corner));
                self.border.start(corners);
                self.faces.push(corners);
                continue;
            };
            let steps = &models.steps[context(&self.border, at)];
            let (step, size, behind) = steps.at(symbols.place(STEP_BITS));
            symbols.pass(STEP_BITS, size, behind, 0);
            let face = match step {
                Step::New => {
                    let vertex = self.births.len() as u16;
                    self.births.push(Gate::at(&self.border, at));
                    self.border.put_new(at, vertex)
                }
                Step::Before => self.border.put_before(at),
                Step::Behind => self.border.put_behind(at),
                Step::Nothing => {
                    self.border.shut(at);
                    continue;
                }
                Step::Other => {
                    let other = other(&self.border, at, symbols);
                    self.border.put_other(at, other)
                }
            };
            self.faces.push(face);
        }
    }

    /// Where all vertices but the first are; false if one is where none can be.
    #[inline(never)]
    fn place(&mut self, symbols: &mut Symbols, models: &Models) -> bool {
        let mut trend = Trend::new();
        let mut is_inside = true;
        for (v, gate) in self.births.iter().enumerate().skip(1) {
            let at = |v: u16| self.cells[usize::from(v) & MASK];
            let is_start = gate.faces_a == 0;
            let guess = if is_start {
                Guess::start(v as u16, gate, models, at)
            } else {
                Guess::at(gate, models, &trend, at)
            };
            let mut place = [0.0; 3];
            let mut read = |axis: usize, (nearest, (class, low_bits)): (i32, (usize, u32))| {
                let cell = nearest.wrapping_add(distance(symbols, models, class, low_bits));
                is_inside &= (0..SPAN).contains(&cell);
                let cell = cell & (SPAN - 1);
                place[axis] = cell as f32;
                guess.off(axis, cell)
            };
            let [first, second, third] = guess.axes();
            let off = read(first, guess.first());
            let off = [off, read(second, guess.second(off))];
            read(third, guess.third(off));
            let place = Cells::from(place);
            if !is_start {
                guess.tell(place, &mut trend);
            }
            self.cells[v & MASK] = place;
        }
        is_inside
    }

    fn read_tags(&mut self, symbols: &mut Symbols) -> Result<(), Malformed> {
        self.tags.clear();
        if symbols.even(1) == 0 {
            return Ok(());
        }
        for _ in 0..number(symbols, NODE_BITS) {
            let vertex = number(symbols, NODE_BITS) as u16;
            let tag = any(symbols);
            if usize::from(vertex) >= self.births.len() {
                return Err(wrong("a vertex that is not there has a tag"));
            }
            self.tags.push((vertex, tag));
        }
        Ok(())
    }

    /// Which vertices are in other blocks, or here again.
    pub(super) fn reach(&self, out: &mut Vec<Reach>) {
        out.clear();
        out.resize(self.births.len(), Reach::Inside);
        for vertex in self.border.vertices() {
            out[usize::from(vertex)] = Reach::Joint(0);
        }
        for &(vertex, tag) in &self.tags {
            out[usize::from(vertex)] = Reach::Joint(tag);
        }
    }
}

/// How far a coordinate is from where it is expected.
#[inline(always)]
fn distance(symbols: &mut Symbols, models: &Models, class: usize, low_bits: u32) -> i32 {
    let (symbol, size, behind) = models.distances[class].at(symbols.place(DISTANCE_BITS));
    if symbol == FAR || low_bits > u32::from(WITH_BITS) {
        return rare(symbols, (symbol, size, behind), low_bits);
    }
    let low = symbols.pass(DISTANCE_BITS, size, behind, low_bits);
    ((symbol as i32 - MOST) << low_bits) + low as i32 - (1 << low_bits >> 1)
}

#[cold]
fn rare(symbols: &mut Symbols, (symbol, size, behind): (usize, u32, u32), low_bits: u32) -> i32 {
    let with = if low_bits <= u32::from(WITH_BITS) { low_bits } else { 0 };
    let mut low = symbols.pass(DISTANCE_BITS, size, behind, with);
    if with < low_bits {
        low = number(symbols, low_bits);
    }
    let mut far = symbol as i32 - MOST;
    if symbol == FAR {
        let is_below = symbols.even(1) == 1;
        far = any(symbols) as i32;
        far = if is_below { far.wrapping_neg() } else { far };
    }
    far.wrapping_shl(low_bits).wrapping_add(low as i32).wrapping_sub(1 << low_bits >> 1)
}

#[cold]
fn other(border: &Border, at: u16, symbols: &mut Symbols) -> u16 {
    let place = symbols.place(OTHERS_BITS) as u16;
    let mut start = 0;
    for (by, size) in OTHERS {
        if place < start + size {
            symbols.pass(OTHERS_BITS, u32::from(size), u32::from(place - start), 0);
            return walk(border, at, by);
        }
        start += size;
    }
    symbols.pass(OTHERS_BITS, (1 << OTHERS_BITS) - u32::from(start), u32::from(place - start), 0);
    border.known(number(symbols, NODE_BITS) as u16)
}

fn number(symbols: &mut Symbols, bits: u32) -> u32 {
    let mut number = 0;
    let mut at = 0;
    while at < bits {
        let chunk = (bits - at).min(CHUNK_BITS);
        number |= symbols.even(chunk) << at;
        at += chunk;
    }
    number
}

/// A number of which nothing is known.
fn any(symbols: &mut Symbols) -> u32 {
    let bits = symbols.even(u32::from(LENGTH_BITS));
    number(symbols, bits)
}

fn wrong(reason: &str) -> Malformed {
    Malformed { at: 0, reason: reason.into() }
}
