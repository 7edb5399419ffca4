//! Gains: pixels that finer levels set right per triangle, by direction and size.
// Loops over lanes become vector code, closures over arrays need not; and `clamp` keeps a NaN.
#![allow(clippy::needless_range_loop, clippy::manual_clamp)]

use crate::levels::{FacingLevels, LevelTable};

/// Number of sizes: four to the octave of pixels per body length, twelve octaves.
pub(super) const SIZES: usize = 48;

/// Bits of the square of a size below those that choose: half an octave of the square.
const DROPPED_BITS: u32 = 22;

/// Square of the least size, in pixels per body length.
const LEAST: f32 = 1.0 / 16.0;

/// Returns the index of a size, given its square in pixels per body length.
#[inline(always)]
pub(super) fn size_of(square: f32) -> usize {
    let steps = (square.max(LEAST).to_bits() >> DROPPED_BITS) - (LEAST.to_bits() >> DROPPED_BITS);
    (steps as usize).min(SIZES - 1)
}

/// Returns the pixels per body length in the middle of a size.
pub(super) fn pixels_of(size: usize) -> f32 {
    let bits = (size as u32 + (LEAST.to_bits() >> DROPPED_BITS)) << DROPPED_BITS;
    (f32::from_bits(bits) * 1.22).sqrt()
}

/// Step to a finer level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// Logarithm to base 2 of the pixels that become right per triangle, for a member that nothing
    /// hides. Falls from step to step.
    pub log_gain: f32,
    /// Depth of the finer level in the chain.
    pub depth: u8,
    /// Triangles that the step adds.
    pub triangles: u32,
}

/// Steps from the coarsest level to the finest, for every direction and size.
///
/// Only levels on the lower convex hull of difference over triangles have a step: others cost more
/// than they show.
pub(super) struct Gains {
    steps: Vec<Step>,
    /// Start of the steps of each direction and size, direction by direction.
    starts: Vec<u32>,
    /// Depth and triangles of the coarsest level worth drawing, for each direction and size.
    coarsest: Vec<(u8, u32)>,
}

impl Gains {
    pub(super) fn new(table: &LevelTable) -> Self {
        let views = table.differences.directions();
        let mut gains = Self { steps: Vec::new(), starts: vec![0], coarsest: Vec::new() };
        for view in 0..views.len() {
            let triangles = mean_triangles(table, view);
            for size in 0..SIZES {
                let px = pixels_of(size);
                let level = |(depth, &triangles): (usize, &u32)| Candidate {
                    depth: depth as u8,
                    triangles,
                    difference: table.differences.area(view, depth, px) * px * px,
                };
                let hull = hull(triangles.iter().enumerate().map(level));
                gains.coarsest.push((hull[0].depth, hull[0].triangles));
                gains.steps.extend(hull.windows(2).map(|pair| Step {
                    log_gain: pair[0].gain_to(&pair[1]).log2(),
                    depth: pair[1].depth,
                    triangles: pair[1].triangles - pair[0].triangles,
                }));
                gains.starts.push(gains.steps.len() as u32);
            }
        }
        gains
    }

    /// Returns the steps of a direction and size, from the coarsest level on.
    #[inline]
    pub(super) fn steps(&self, look: usize) -> &[Step] {
        &self.steps[self.starts[look] as usize..self.starts[look + 1] as usize]
    }

    /// Returns the depth and the triangles of the coarsest level of a direction and size.
    #[inline]
    pub(super) fn coarsest(&self, look: usize) -> (u8, u32) {
        self.coarsest[look]
    }
}

/// Returns the number of triangles of every level, finest first, as a mean over the facing chains
/// of directions that are compared in one.
fn mean_triangles(table: &LevelTable, view: usize) -> Vec<u32> {
    let views = table.differences.directions();
    let mean = |(depth, facing): (usize, &FacingLevels)| {
        let FacingLevels { directions, levels } = facing;
        if levels.is_empty() {
            return table.triangle_count(depth) as u32;
        }
        let is_near = |cell: &usize| views.cell(directions.axis(*cell)) == view;
        let mut cells: Vec<usize> = (0..directions.len()).filter(is_near).collect();
        if cells.is_empty() {
            cells.push(directions.cell(views.axis(view)));
        }
        let sum: usize = cells.iter().map(|cell| table.triangle_count(levels.start + cell)).sum();
        sum.div_ceil(cells.len()) as u32
    };
    table.facing.iter().enumerate().map(mean).collect()
}

/// Level that may be chosen.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    depth: u8,
    triangles: u32,
    /// Pixels that are wrong.
    difference: f32,
}

impl Candidate {
    /// Returns the pixels that become right per triangle on the way to a finer level.
    fn gain_to(&self, finer: &Self) -> f32 {
        (self.difference - finer.difference) / (finer.triangles - self.triangles) as f32
    }
}

/// Returns the levels on the lower convex hull of difference over triangles, coarsest first. The
/// levels come finest first.
fn hull(levels: impl DoubleEndedIterator<Item = Candidate>) -> Vec<Candidate> {
    let mut hull: Vec<Candidate> = Vec::new();
    for level in levels.rev() {
        while let Some(last) = hull.last() {
            let no_better =
                level.triangles <= last.triangles && level.difference <= last.difference;
            let before = hull.len().checked_sub(2).map(|i| hull[i]);
            let convex = before.is_none_or(|before| {
                level.triangles > last.triangles && before.gain_to(last) > last.gain_to(&level)
            });
            if !no_better && convex {
                break;
            }
            hull.pop();
        }
        let gains = hull.last().is_none_or(|last| {
            level.triangles > last.triangles && level.difference < last.difference
        });
        if gains {
            hull.push(level);
        }
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidates(of: &[(u32, f32)]) -> Vec<Candidate> {
        let level = |(depth, &(triangles, difference)): (usize, &(u32, f32))| Candidate {
            depth: depth as u8,
            triangles,
            difference,
        };
        of.iter().enumerate().map(level).collect()
    }

    #[test]
    fn the_hull_leaves_out_what_costs_more_than_it_shows() {
        let levels =
            candidates(&[(100, 0.0), (50, 4.0), (40, 1.0), (20, 9.0), (10, 2.5), (5, 8.0)]);
        let depths: Vec<u8> = hull(levels.into_iter()).iter().map(|c| c.depth).collect();
        assert_eq!(depths, [5, 4, 2, 0]);
    }

    #[test]
    fn levels_that_look_alike_leave_the_coarsest() {
        let levels = candidates(&[(100, 1.0), (50, 1.0), (25, 1.0)]);
        assert_eq!(hull(levels.into_iter()).len(), 1);
        let single = candidates(&[(1, 0.0)]);
        assert_eq!(hull(single.into_iter()).len(), 1);
    }

    #[test]
    fn sizes_are_quarter_octaves() {
        for size in 0..SIZES {
            assert_eq!(size_of(pixels_of(size).powi(2)), size);
        }
        assert_eq!(size_of(4.0 * 9.0) - size_of(9.0), 4);
        assert!([0.0, f32::NAN, f32::INFINITY, -1.0].iter().all(|&s| size_of(s) < SIZES));
    }
}
