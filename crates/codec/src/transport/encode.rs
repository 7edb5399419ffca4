//! Blocks as symbols, and as bytes.

use glam::{BVec4A, Vec4};

use super::border::Step;
use super::gate::{Gate, NODE_BITS, OTHERS, OTHERS_BITS};
use super::models::{Distances, FAR, MOST, Models};
use super::predict::{Cells, Guess, LANES, Trends};
use super::rans::Symbol;
use super::walk::Walk;

/// How far a coordinate is from where it is expected.
#[derive(Clone, Copy, Debug)]
pub(super) struct Told {
    distance: i32,
    pub(super) class: u8,
    low_bits: u8,
}

impl Told {
    /// The symbol in the table of the class, how far it is, and the bits below.
    pub(super) fn symbol(&self) -> (usize, i32, u16) {
        let raised = self.distance + (1 << self.low_bits >> 1);
        let far = raised >> self.low_bits;
        let symbol = if far.abs() <= MOST { (far + MOST) as usize } else { FAR };
        (symbol, far, (raised & ((1 << self.low_bits) - 1)) as u16)
    }

    fn push(&self, distances: &Distances, symbols: &mut Vec<Symbol>) {
        let (symbol, far, low) = self.symbol();
        let with = if self.low_bits <= WITH_BITS { self.low_bits } else { 0 };
        let with_low = if with > 0 { low } else { 0 };
        let known = distances.symbol(symbol, with_low, with);
        let is_far = known.is_none() || symbol == FAR;
        let rare = || distances.symbol(FAR, with_low, with).expect("there are always others");
        symbols.push(known.unwrap_or_else(rare));
        if with < self.low_bits {
            push_number(u32::from(low), u32::from(self.low_bits), symbols);
        }
        if is_far {
            symbols.push(Symbol::even(u16::from(far < 0), 1));
            push_any(far.unsigned_abs(), symbols);
        }
    }
}

/// So many bits below are in one go with their symbol.
pub(super) const WITH_BITS: u8 = 5;
/// Bits of the number of bits of a number.
pub(super) const LENGTH_BITS: u8 = 5;
/// Numbers are told so many bits at a time.
pub(super) const CHUNK_BITS: u32 = 12;

fn push_number(number: u32, bits: u32, symbols: &mut Vec<Symbol>) {
    let mut at = 0;
    while at < bits {
        let chunk = (bits - at).min(CHUNK_BITS);
        symbols.push(Symbol::even((number >> at & ((1 << chunk) - 1)) as u16, chunk as u8));
        at += chunk;
    }
}

/// A number of which nothing is known.
fn push_any(number: u32, symbols: &mut Vec<Symbol>) {
    let bits = u32::BITS - number.leading_zeros();
    symbols.push(Symbol::even(bits as u16, LENGTH_BITS));
    push_number(number, bits, symbols);
}

/// How far all vertices but the first are from where they are expected, of four blocks at most.
pub(super) fn tell(walks: &[Walk], cells: &[Cells], models: &Models) -> [Vec<Told>; LANES] {
    // Side by side as in the decoder: each is asked for some six times.
    let placed: [Vec<Vec4>; LANES] = std::array::from_fn(|lane| {
        let vertices = walks.get(lane).map_or(&[][..], |walk| &walk.vertices);
        vertices.iter().map(|&v| cells[v as usize].extend(0.0)).collect()
    });
    let at = |lane: usize, v: u16| placed[lane].get(usize::from(v)).copied().unwrap_or(Vec4::ZERO);
    let longest = walks.iter().map(|walk| walk.births.len()).max().unwrap_or(0);
    let mut told: [Vec<Told>; LANES] = std::array::from_fn(|_| Vec::with_capacity(3 * longest));
    let mut trends = Trends::new();
    for v in 1..longest {
        let birth = |lane: usize| walks.get(lane).and_then(|walk| walk.births.get(v)).copied();
        let births: [Option<Gate>; LANES] = std::array::from_fn(birth);
        let gates = births.map(Option::unwrap_or_default);
        let guesses = trends.guess(&gates, models, at);
        let places = std::array::from_fn(|lane| at(lane, v as u16));
        for (lane, _) in births.iter().enumerate().filter(|(_, gate)| gate.is_some()) {
            let guess = match gates[lane].faces_a {
                0 => Guess::start(v as u16, &gates[lane], models, |v| at(lane, v)),
                _ => guesses.of(lane),
            };
            let axes = guess.axes();
            guess.take(|turn, nearest, (class, low_bits)| {
                let cell = places[lane][axes[turn]] as i32;
                let (class, low_bits) = (class as u8, low_bits as u8);
                told[lane].push(Told { distance: cell - nearest, class, low_bits });
                cell
            });
        }
        trends.tell(&guesses, places, BVec4A::from_array(gates.map(|gate| gate.faces_a > 0)));
    }
    told
}

/// All symbols of a block.
pub(super) fn symbols(
    walk: &Walk,
    (first, first_bits): (Cells, [u8; 3]),
    tags: &[(u16, u32)],
    told: &[Told],
    models: &Models,
    symbols: &mut Vec<Symbol>,
) -> [usize; 2] {
    for k in 0..3 {
        push_number(first[k] as u32, u32::from(first_bits[k]), symbols);
    }
    let mut others = walk.others.iter();
    for &(context, step) in &walk.steps {
        symbols.push(models.steps[usize::from(context)].symbol(step));
        if step == Step::Other {
            push_other(*others.next().expect("one each"), symbols);
        }
    }
    let from = symbols.len();
    for told in told {
        told.push(&models.distances[usize::from(told.class)], symbols);
    }
    let to = symbols.len();
    symbols.push(Symbol::even(u16::from(!tags.is_empty()), 1));
    if !tags.is_empty() {
        push_number(tags.len() as u32, NODE_BITS, symbols);
    }
    for &(vertex, tag) in tags {
        push_number(u32::from(vertex), NODE_BITS, symbols);
        push_any(tag, symbols);
    }
    [from, to]
}

fn push_other(other: Result<usize, u16>, symbols: &mut Vec<Symbol>) {
    let before = |count: usize| OTHERS[..count].iter().map(|&(_, size)| size).sum::<u16>();
    let bits = OTHERS_BITS as u8;
    let symbol = |start, size| Symbol { start, size, bits, low_bits: 0, low: 0 };
    match other {
        Ok(at) => symbols.push(symbol(before(at), OTHERS[at].1)),
        Err(node) => {
            let start = before(OTHERS.len());
            symbols.push(symbol(start, (1 << OTHERS_BITS) - start));
            push_number(u32::from(node), NODE_BITS, symbols);
        }
    }
}
