//! Levels of a chain by distance, as a look-up table.
// Loops over lanes become vector code, closures over arrays need not; and `clamp` keeps a NaN.
#![allow(clippy::needless_range_loop, clippy::manual_clamp)]

use crate::levels::{Chain, LevelTable};
use crate::select::{InstanceLevel, LANES};

/// Level of a chain for every distance, looked up by the bits of the distance's square.
///
/// The exponent and four bits of the mantissa choose the entry: 32 entries an octave of distance,
/// without a root or a logarithm.
#[derive(Clone, Debug)]
pub struct ChainLevels {
    entries: Vec<InstanceLevel>,
}

const DROPPED_BITS: u32 = ChainLevels::DROPPED_BITS;
const LEAST: f32 = ChainLevels::LEAST;
const MOST: f32 = ChainLevels::MOST;

/// Number of entries before the one of [`LEAST`].
const FIRST: u32 = LEAST.to_bits() >> DROPPED_BITS;

impl ChainLevels {
    /// Bits of a float below those that choose an entry.
    pub const DROPPED_BITS: u32 = 19;

    /// Least square of a distance with a separate entry; smaller ones take the first.
    pub const LEAST: f32 = 1.0 / (1 << 20) as f32;

    /// Greatest square of a distance with a separate entry; larger ones take the last.
    pub const MOST: f32 = (1u64 << 40) as f32;

    /// Creates a table of hidden members; [`ChainLevels::fill`] gives it levels.
    pub fn new() -> Self {
        let last = MOST.to_bits() >> DROPPED_BITS;
        Self { entries: vec![InstanceLevel::HIDDEN; (last - FIRST + 1) as usize] }
    }

    /// Sets the level for every distance in body lengths, without allocating.
    pub fn fill(&mut self, level: impl Fn(f32) -> usize) {
        for (entry, bits) in self.entries.iter_mut().zip(FIRST..) {
            *entry = InstanceLevel::drawn(level(f32::from_bits(bits << DROPPED_BITS).sqrt()));
        }
    }

    /// Sets for every distance the finest level of a chain with at most as many triangles as
    /// `share` returns, as a fraction of the model's; the coarsest if none has so few.
    pub fn fill_by_share(&mut self, table: &LevelTable, chain: &Chain, share: impl Fn(f32) -> f32) {
        let all = table.triangle_count(0) as f32;
        self.fill(|distance| {
            let most = share(distance).clamp(0.0, 1.0) * all;
            let fits = |level: &usize| table.triangle_count(*level) as f32 <= most + 0.5;
            chain.levels.clone().find(fits).unwrap_or(chain.levels.end - 1)
        });
    }

    /// Sets for every distance the coarsest level of the whole chain whose error spans at most one
    /// pixel, at a detail of 1; `pixels_at_one` are the pixels of a body length at distance 1.
    pub fn fill_by_screen_error(&mut self, table: &LevelTable, pixels_at_one: f32, detail: f32) {
        let whole = table.chains[0].levels.clone();
        // Error in body lengths that spans a pixel at distance 1.
        let tolerance = 1.0 / (detail * pixels_at_one);
        self.fill(|distance| {
            let fits = |level: &usize| table.levels[*level].error <= tolerance * distance;
            whole.clone().rev().find(fits).unwrap_or(whole.start)
        });
    }

    /// Returns the level of every entry. Entry i is for squares of distances whose bits, shifted
    /// right by [`ChainLevels::DROPPED_BITS`], are i more than those of [`ChainLevels::LEAST`].
    pub fn entries(&self) -> &[InstanceLevel] {
        &self.entries
    }

    /// Returns the level for the square of a distance; zero for one that is not a number.
    #[inline(always)]
    pub fn at_squared(&self, distance_squared: f32) -> InstanceLevel {
        self.entries[self.entry(distance_squared)]
    }

    /// Sets the levels for the squares of eight distances.
    ///
    /// A loop, since closures over arrays are not always inlined.
    #[inline(always)]
    pub fn look_up(&self, squares: &[f32; LANES], levels: &mut [InstanceLevel; LANES]) {
        let mut entries = [0; LANES];
        #[expect(clippy::manual_clamp, reason = "`max` also replaces a NaN")]
        for lane in 0..LANES {
            entries[lane] = squares[lane].max(LEAST).min(MOST).to_bits() >> DROPPED_BITS;
        }
        for lane in 0..LANES {
            levels[lane] = self.entries[(entries[lane] - FIRST) as usize];
        }
    }

    /// Returns the number of the entry for the square of a distance.
    #[inline(always)]
    #[expect(clippy::manual_clamp, reason = "`max` also replaces a NaN")]
    pub(crate) fn entry(&self, distance_squared: f32) -> usize {
        let bits = distance_squared.max(LEAST).min(MOST).to_bits() >> DROPPED_BITS;
        (bits - FIRST) as usize
    }

    /// Returns the number of entries.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// Returns the least distance of an entry, in body lengths.
    pub(crate) fn distance(entry: usize) -> f32 {
        f32::from_bits((entry as u32 + FIRST) << DROPPED_BITS).sqrt()
    }
}

impl Default for ChainLevels {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_distance_has_an_entry_near_it() {
        let mut levels = ChainLevels::new();
        levels.fill(|distance| (distance * 10.0) as usize % 1000);
        for distance in [0.5f32, 1.0, 3.7, 20.0] {
            let found = levels.at_squared(distance * distance).level().unwrap() as f32 / 10.0;
            assert!(found <= distance && found > 0.95 * distance - 0.1, "{distance}: {found}");
        }
        for odd in [f32::NAN, f32::INFINITY, -1.0, 0.0, f32::MAX] {
            assert!(levels.at_squared(odd).level().is_some());
        }
    }
}
