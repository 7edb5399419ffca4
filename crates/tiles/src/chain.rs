//! Fingerprint of the curves along which tiles meet: those of neighbours cancel out.

use crate::tile::TileMesh;

/// Sum of numbers that stand for the border edges of tiles, each negative for the edge in the other
/// direction. It is 0 if every edge between tiles is there in both directions, and else with a
/// probability of 2⁻¹²⁸.
pub type ChainSum = u128;

/// Returns the sum of the border edges of a tile.
pub fn chain_sum(tile: &TileMesh) -> ChainSum {
    tile.border.iter().fold(0, |sum: ChainSum, edge| {
        let [a, b] = edge.map(|v| tile.point(v));
        let number = |low: [i32; 3], high: [i32; 3]| {
            let half = |seed| {
                let words = low.iter().chain(&high);
                words.fold(seed, |state, &word| mixed(state ^ u64::from(word as u32)))
            };
            u128::from(half(0x9E37_79B9_7F4A_7C15)) << 64 | u128::from(half(0xD1B5_4A32_D192_ED03))
        };
        match a < b {
            true => sum.wrapping_add(number(a, b)),
            false => sum.wrapping_sub(number(b, a)),
        }
    })
}

/// Mixes the bits of a word so that each depends on all: the finalizer of MurmurHash3.
fn mixed(mut word: u64) -> u64 {
    for factor in [0xFF51_AFD7_ED55_8CCD, 0xC4CE_B9FE_1A85_EC53] {
        word = (word ^ (word >> 33)).wrapping_mul(factor);
    }
    word ^ (word >> 33)
}
