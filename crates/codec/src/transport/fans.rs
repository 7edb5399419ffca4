//! Fans: the faces that are added around one vertex of the border, coded as one symbol.
//!
//! A fan is a number of new vertices, and how it ends. Its probability is the product of those of
//! its steps, whose tables the header has, so fans take the bits of their steps and a third of the
//! symbols.

use super::border::{Border, EdgeState, Node, Step};
use super::gate::{CONTEXTS, Gate, NEARBY, NODE_BITS, context_of, node_at_offset};
use super::models::{STEP_BITS, StepTable};
use super::rans::{Symbol, Symbols};
use super::read::number;

/// Most new vertices of one fan; what follows is another fan.
pub(super) const MAX_NEW: usize = 7;
/// Ways in which a fan ends.
const ENDS: usize = 3;
/// Number of symbols: each end after 0 to [`MAX_NEW`] new vertices.
const FANS: usize = ENDS * (MAX_NEW + 1);
const ALL: u16 = 1 << STEP_BITS;

/// End of a fan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FanEnd {
    /// As [`Step::Previous`].
    Previous,
    /// As [`Step::Nothing`].
    Nothing,
    /// A symbol of [`RareStep`] follows.
    Rare,
}

const FAN_ENDS: [FanEnd; ENDS] = [FanEnd::Previous, FanEnd::Nothing, FanEnd::Rare];

/// Probability table of fans: where each one's slots end, after a zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct FanTable([i16; FANS + 1]);

impl FanTable {
    /// Returns the tables of all contexts.
    pub(super) fn all(steps: &[StepTable; CONTEXTS]) -> Box<[Self; CONTEXTS]> {
        Box::new(std::array::from_fn(|context| {
            // Each new vertex adds a face to the fan's, and has one itself.
            let (a, before) = (context / 24, context / 2 % 2);
            let step = |new: usize| match new {
                0 => &steps[context],
                new => &steps[context_of((a + new).min(6), 0, before, 0)],
            };
            Self::of(step)
        }))
    }

    /// Builds a table, given that of the step after some new vertices.
    fn of<'a>(step: impl Fn(usize) -> &'a StepTable) -> Self {
        let whole = f64::from(ALL);
        let mut sizes = [0; FANS];
        let mut part = 1.0;
        for new in 0..=MAX_NEW {
            let size = |taken: Step| f64::from(step(new).symbol(taken).size);
            let ends = [size(Step::Previous), size(Step::Nothing)];
            let rare = match new {
                MAX_NEW => whole - ends[0] - ends[1],
                _ => size(Step::Next) + size(Step::Other),
            };
            for (end, size) in [ends[0], ends[1], rare].into_iter().enumerate() {
                sizes[end * (MAX_NEW + 1) + new] = ((part * size + 0.5) as u16).max(1);
            }
            part *= size(Step::New) / whole;
        }
        let most = (0..FANS).max_by_key(|&k| sizes[k]).unwrap_or(0);
        // What rounding and the least sizes have added is less than the largest share.
        sizes[most] = (sizes[most] + ALL) - sizes.iter().sum::<u16>();
        let mut bounds = [0; FANS + 1];
        for (k, &size) in sizes.iter().enumerate() {
            bounds[k + 1] = bounds[k] + size as i16;
        }
        Self(bounds)
    }

    /// Decodes a fan: its number of new vertices, and its end.
    #[inline(always)]
    pub(super) fn read(&self, symbols: &mut Symbols) -> (usize, FanEnd) {
        let place = symbols.place(STEP_BITS) as i16;
        // A sign for each symbol that ends before the slot: sums of signs are fast in vectors.
        let before = self.0[1..].iter().map(|&end| (end - 1 - place) >> 15).sum::<i16>();
        let symbol = before.unsigned_abs() as usize % FANS;
        let start = self.0[symbol];
        let (size, offset) = ((self.0[symbol + 1] - start) as u32, (place - start) as u32);
        symbols.consume(STEP_BITS, size, offset, 0);
        (symbol % (MAX_NEW + 1), FAN_ENDS[symbol / (MAX_NEW + 1)])
    }

    /// Returns the number of slots of each fan.
    #[cfg(test)]
    pub(super) fn sizes(&self) -> [i32; FANS] {
        std::array::from_fn(|k| i32::from(self.0[k + 1]) - i32::from(self.0[k]))
    }

    /// Returns the symbol of a fan.
    fn symbol(&self, new: usize, end: FanEnd) -> Symbol {
        let symbol = end as usize * (MAX_NEW + 1) + new;
        let start = self.0[symbol];
        let size = (self.0[symbol + 1] - start) as u16;
        Symbol { start: start as u16, size, bits: STEP_BITS as u8, low_bits: 0, low: 0 }
    }
}

/// Adds the faces of a fan that have new vertices: `count` of them, at least one, from `vertex` on.
/// Calls `add` with each face and its gate.
#[inline(always)]
pub(super) fn add_fan(
    border: &mut Border,
    at: u16,
    (vertex, count): (u16, u16),
    mut add: impl FnMut([u16; 3], Gate),
) {
    let mut gate = Gate::at(border, at);
    let Gate { a, b, .. } = gate;
    if a == b {
        // The face counts of both ends are one.
        for vertex in vertex..vertex + count {
            let gate = Gate::at(border, at);
            add(border.add_new(at, vertex), gate);
        }
        return;
    }
    let second = border.node(at).next;
    let first = border.len() as u16;
    let mut next = second;
    for vertex in vertex..vertex + count {
        let (previous, state) = (border.len() as u16 + 1, EdgeState::Open);
        next = border.push(Node { vertex, next, previous, apex: a, previous_apex: a, state });
        border.set_faces(vertex, 2);
        add([gate.b, a, vertex], gate);
        gate.next = gate.b;
        (gate.previous_apex, gate.apex, gate.b) = (gate.apex, gate.b, vertex);
        gate.faces_a = gate.faces_a.saturating_add(1);
        gate.faces_b = 1;
    }
    border.node_mut(next).previous = at;
    let node = border.node_mut(at);
    (node.next, node.apex, node.previous_apex) = (next, gate.apex, gate.previous_apex);
    border.node_mut(second).previous = first;
    border.set_faces(gate.b, 1);
    border.set_faces(a, gate.faces_a);
    border.set_faces(b, border.faces_at(b).saturating_add(1));
}

/// Step after a fan that ends otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RareStep {
    /// As [`Step::New`], after [`MAX_NEW`] others.
    New,
    /// As [`Step::Next`].
    Next,
    /// As [`Step::Other`], with its node.
    Other(u16),
}

/// Bits of the table of rare steps.
const RARE_BITS: u32 = 8;
/// Slots of a new vertex, of the next one, of each of [`NEARBY`], and of a node by its number. Those
/// of the nodes are in proportion to those of [`NEARBY`]; the first two are not fitted to anything.
const RARE: [u16; NEARBY.len() + 3] = [4, 36, 186, 14, 4, 4, 2, 2, 2, 2];

impl RareStep {
    #[cold]
    pub(super) fn read(border: &Border, at: u16, symbols: &mut Symbols) -> Self {
        let place = symbols.place(RARE_BITS) as u16;
        let mut start = 0;
        let mut which = 0;
        while place >= start + RARE[which] {
            start += RARE[which];
            which += 1;
        }
        symbols.consume(RARE_BITS, RARE[which].into(), u32::from(place - start), 0);
        match which {
            0 => Self::New,
            1 => Self::Next,
            _ => Self::Other(match NEARBY.get(which - 2) {
                Some(&(by, _)) => node_at_offset(border, at, by),
                None => border.known(number(symbols, NODE_BITS) as u16),
            }),
        }
    }
}

/// Appends the symbols of a block's steps, given the context of each, and of its other nodes their
/// index in [`NEARBY`], else their number.
pub(super) fn push_fans(
    steps: &[(u8, Step)],
    others: &[Result<usize, u16>],
    fans: &[FanTable; CONTEXTS],
    symbols: &mut Vec<Symbol>,
) {
    let mut others = others.iter();
    let mut at = 0;
    while let Some(&(context, _)) = steps.get(at) {
        let table = &fans[usize::from(context)];
        let new = steps[at..].iter().take_while(|(_, step)| *step == Step::New).count();
        let new = new.min(MAX_NEW);
        at += new;
        let Some(&(_, step)) = steps.get(at) else {
            // The block is complete, however the fan ends.
            let ends = FAN_ENDS.map(|end| table.symbol(new, end));
            symbols.extend(ends.into_iter().max_by_key(|symbol| symbol.size));
            return;
        };
        at += 1;
        let end = match step {
            Step::Previous => FanEnd::Previous,
            Step::Nothing => FanEnd::Nothing,
            Step::New | Step::Next | Step::Other => FanEnd::Rare,
        };
        symbols.push(table.symbol(new, end));
        let rare = match step {
            Step::Previous | Step::Nothing => continue,
            Step::New => Ok(0),
            Step::Next => Ok(1),
            Step::Other => others.next().expect("one each").map(|nearby| nearby + 2),
        };
        push_rare(rare, symbols);
    }
}

fn push_rare(rare: Result<usize, u16>, symbols: &mut Vec<Symbol>) {
    let which = rare.unwrap_or(RARE.len() - 1);
    let start = RARE[..which].iter().sum();
    let bits = RARE_BITS as u8;
    symbols.push(Symbol { start, size: RARE[which], bits, low_bits: 0, low: 0 });
    if let Err(node) = rare {
        symbols.push(Symbol::uniform(node, NODE_BITS as u8));
    }
}
