//! Encoding in bits of the steps by which a patch grows.

use std::ops::Range;

use super::Rows;
use super::grow::{Found, GrowthStep};
use crate::bits::{Bits, Cursor, width};
use crate::bytes::Malformed;

/// Prefix code at the start of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Code {
    /// Next node of one of the patch's own rows.
    Own,
    /// [`Found::Next`].
    Next,
    /// [`Found::Previous`].
    Previous,
    /// [`Found::Nothing`].
    Nothing,
    /// Node of another patch.
    Foreign,
    /// [`Found::Known`].
    Known,
}

/// Codes by decreasing frequency, for 0, 1 and 2 ends of the gate in foreign rows, and for no gate.
/// Each is written in unary: as many ones as its index, and a zero except for the last. On ten
/// meshes steps take 3.2 bits per face, and 4.0 with one list for all.
const CODES: [&[Code]; 4] = {
    use Code::*;
    [
        &[Own, Previous, Next, Nothing, Foreign, Known],
        &[Foreign, Own, Previous, Next, Nothing, Known],
        &[Nothing, Own, Foreign, Previous, Next, Known],
        &[Own, Foreign, Known],
    ]
};

/// Rows of a patch: its own, and the foreign ones that it has nodes of.
pub(super) struct PatchRows {
    pub(super) own: Range<u32>,
    pub(super) foreign: Vec<u32>,
}

/// Row of a node, and its number there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NodeAddress {
    pub(super) row: u32,
    pub(super) number: u32,
}

/// Context of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Context {
    codes: &'static [Code],
    /// Most probable row of a new node.
    row: u32,
}

impl PatchRows {
    pub(super) fn of(
        steps: &[GrowthStep],
        own: Range<u32>,
        place: impl Fn(u32) -> NodeAddress,
    ) -> Self {
        let rows = steps.iter().filter_map(GrowthStep::new_node).map(|node| place(node).row);
        let mut foreign: Vec<u32> = rows.filter(|row| !own.contains(row)).collect();
        foreign.sort_unstable();
        foreign.dedup();
        Self { own, foreign }
    }

    /// Returns the context of a step, given the rows of the gate's nodes.
    pub(super) fn context(&self, gate: Option<[u32; 2]>) -> Context {
        let Some([from, to]) = gate else {
            return Context { codes: CODES[3], row: self.own.start };
        };
        let own = [to, from].into_iter().filter(|row| self.own.contains(row));
        Context {
            codes: CODES[2 - own.clone().count()],
            row: own.clone().next().unwrap_or(self.own.start),
        }
    }

    /// Writes the foreign rows, and then the steps.
    pub(super) fn push(
        &self,
        steps: &[GrowthStep],
        place: impl Fn(u32) -> NodeAddress,
        rows: &Rows,
        bits: &mut Bits,
    ) {
        push_count(bits, self.foreign.len() as u64);
        self.foreign.iter().for_each(|&row| bits.push(row.into(), width(rows.len())));
        let mut known = 0;
        for step in steps {
            let context = self.context(step.gate.map(|gate| gate.map(|node| place(node).row)));
            match step.finds {
                Found::Nothing => context.push_code(bits, Code::Nothing),
                Found::Next => context.push_code(bits, Code::Next),
                Found::Previous => context.push_code(bits, Code::Previous),
                Found::Known(number) => {
                    context.push_code(bits, Code::Known);
                    bits.push(number.into(), width(known));
                }
                Found::New(node) => {
                    known += 1;
                    self.push_new(context, place(node), rows, bits);
                }
            }
        }
    }

    fn push_new(&self, context: Context, place: NodeAddress, rows: &Rows, bits: &mut Bits) {
        let NodeAddress { row, number } = place;
        if self.own.contains(&row) {
            context.push_code(bits, Code::Own);
            self.push_own(context, row, bits);
        } else {
            context.push_code(bits, Code::Foreign);
            let at = self.foreign.binary_search(&row).expect("it was put there");
            bits.push(at as u64, width(self.foreign.len()));
            bits.push(number.into(), width(rows.size(row) as usize));
        }
    }

    /// Writes one of the patch's own rows; a zero stands for the likely one.
    fn push_own(&self, context: Context, row: u32, bits: &mut Bits) {
        if self.own.len() > 1 {
            bits.push((row != context.row).into(), 1);
            if row != context.row {
                bits.push((row - self.own.start).into(), width(self.own.len()));
            }
        }
    }

    pub(super) fn next_own(&self, context: Context, bits: &mut Cursor) -> Result<u32, Malformed> {
        if self.own.len() == 1 || bits.next(1)? == 0 {
            return Ok(context.row);
        }
        let at = bits.next(width(self.own.len()))? as usize;
        let row = self.own.clone().nth(at);
        row.ok_or_else(|| bits.wrong(format!("the patch has no row {at} of its own")))
    }

    pub(super) fn next(own: Range<u32>, rows: &Rows, bits: &mut Cursor) -> Result<Self, Malformed> {
        let count = next_count(bits)?;
        if count > (rows.len() - own.len()) as u64 {
            return Err(
                bits.wrong(format!("the patch names {count} foreign rows, more than there are"))
            );
        }
        let mut foreign = Vec::new();
        for _ in 0..count {
            let row = bits.next(width(rows.len()))? as u32;
            if row as usize >= rows.len() {
                return Err(
                    bits.wrong(format!("row {row} does not exist: there are {} rows", rows.len()))
                );
            }
            foreign.push(row);
        }
        Ok(Self { own, foreign })
    }
}

impl Context {
    fn push_code(&self, bits: &mut Bits, code: Code) {
        let ones = self.codes.iter().position(|&other| other == code).expect("it is one of them");
        let is_last = ones + 1 == self.codes.len();
        bits.push((1 << ones) - 1, ones as u32 + u32::from(!is_last));
    }

    pub(super) fn next_code(&self, bits: &mut Cursor) -> Result<Code, Malformed> {
        let mut ones = 0;
        while ones + 1 < self.codes.len() && bits.next(1)? == 1 {
            ones += 1;
        }
        Ok(self.codes[ones])
    }
}

/// Bits of the length of a count.
const COUNT_WIDTH: u32 = 5;

fn push_count(bits: &mut Bits, count: u64) {
    let width = u64::BITS - count.leading_zeros();
    bits.push(width.into(), COUNT_WIDTH);
    bits.push(count, width);
}

fn next_count(bits: &mut Cursor) -> Result<u64, Malformed> {
    let width = bits.next(COUNT_WIDTH)? as u32;
    bits.next(width)
}
