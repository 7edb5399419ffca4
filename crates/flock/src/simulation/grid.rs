//! Uniform grid that sorts members by cell, so that neighbours are near in memory too.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

/// Grid of cells as wide as the neighbour radius, with members in the order of their cells.
///
/// Cells that are too many for the members are folded: the grid repeats in space, and members far
/// apart may share a cell. That costs candidates, never neighbours. Within a cell members keep
/// their order, so that the order does not depend on the number of threads.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    /// Binary logarithms of the number of cells along each axis.
    bits: [u32; 3],
    /// First member of each cell in sorted order, and the number of members at the end.
    starts: Vec<u32>,
    /// Cell of each member in the order before sorting.
    cells: Vec<u32>,
    /// Member, in the order before, that comes to each place.
    order: Vec<u32>,
}

/// Least number of cells along an axis, as a binary logarithm: with four, the cells on both sides
/// of one differ.
const LEAST_BITS: u32 = 2;
/// Members that a thread takes at once.
const CHUNK: usize = 8192;

impl Grid {
    /// Sorts members by cell, given their positions by axis; see [`Self::order`].
    ///
    /// Cost: O(n), n = members; at most max(64, 2 n) cells.
    pub fn sort(&mut self, position: &[Vec<f32>; 3], cell: f32) {
        let (least, greatest) = bounds(position);
        self.bits = bits_for((greatest - least) / cell, position[0].len());
        self.assign(position, least, cell.recip());
        self.count();
    }

    /// Returns the member, in the order before sorting, that comes to each place.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Returns the number of cells.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the sorted members of consecutive cells.
    pub fn members(&self, cells: Range<usize>) -> Range<usize> {
        self.starts[cells.start] as usize..self.starts[cells.end] as usize
    }

    /// Returns the cell after the last whose members begin at or before `member`.
    pub fn cell_of(&self, cells: Range<usize>, member: usize) -> usize {
        let starts = &self.starts[cells.start..cells.end];
        cells.start + starts.partition_point(|&start| start as usize <= member)
    }

    /// Calls `visit` with the runs of sorted members that are in a cell or next to it, each once.
    #[inline]
    pub fn for_runs_around(&self, cell: usize, mut visit: impl FnMut(Range<usize>)) {
        let [bx, by, bz] = self.bits;
        let mask = |bits: u32| (1_usize << bits) - 1;
        let (x, y, z) = (cell & mask(bx), (cell >> bx) & mask(by), cell >> (bx + by));
        for dz in [mask(bz), 0, 1] {
            for dy in [mask(by), 0, 1] {
                let row = (((z + dz) & mask(bz)) << by | ((y + dy) & mask(by))) << bx;
                if x > 0 && x < mask(bx) {
                    visit(self.members(row + x - 1..row + x + 2));
                } else {
                    // The row is folded here: its two ends are next to each other.
                    let other = if x == 0 { mask(bx) } else { 0 };
                    let pair = if x == 0 { 0 } else { x - 1 };
                    visit(self.members(row + pair..row + pair + 2));
                    visit(self.members(row + other..row + other + 1));
                }
            }
        }
    }

    fn assign(&mut self, [x, y, z]: &[Vec<f32>; 3], least: Vec3, per_length: f32) {
        let [bx, by, bz] = self.bits;
        self.cells.resize(x.len(), 0);
        let cell = |from: f32, at: f32, bits: u32| {
            ((at - from) * per_length) as i32 as u32 & ((1 << bits) - 1)
        };
        self.cells.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, cells)| {
            let first = chunk * CHUNK;
            let range = first..first + cells.len();
            let (x, y, z) = (&x[range.clone()], &y[range.clone()], &z[range]);
            for (((to, &x), &y), &z) in cells.iter_mut().zip(x).zip(y).zip(z) {
                let row = cell(least.z, z, bz) << by | cell(least.y, y, by);
                *to = row << bx | cell(least.x, x, bx);
            }
        });
    }

    /// Counting sort by cell.
    fn count(&mut self) {
        let cells = 1_usize << self.bits.iter().sum::<u32>();
        self.starts.clear();
        self.starts.resize(cells + 1, 0);
        for &cell in &self.cells {
            self.starts[cell as usize + 1] += 1;
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        // Filling moves each cell's start to its end, which is the start of the next.
        self.order.resize(self.cells.len(), 0);
        for (member, &cell) in self.cells.iter().enumerate() {
            let place = &mut self.starts[cell as usize];
            self.order[*place as usize] = member as u32;
            *place += 1;
        }
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }
}

/// Returns the least and greatest coordinates; zero if there are no members.
fn bounds([x, y, z]: &[Vec<f32>; 3]) -> (Vec3, Vec3) {
    let along = |values: &[f32]| {
        let fold = |(lo, hi): (f32, f32), &value: &f32| (lo.min(value), hi.max(value));
        let pair = |a: (f32, f32), b: (f32, f32)| (a.0.min(b.0), a.1.max(b.1));
        let none = (f32::INFINITY, f32::NEG_INFINITY);
        let chunks = values.par_chunks(CHUNK).map(|chunk| chunk.iter().fold(none, fold));
        chunks.reduce(|| none, pair)
    };
    if x.is_empty() {
        return (Vec3::ZERO, Vec3::ZERO);
    }
    let [x, y, z] = [x, y, z].map(|values| along(values));
    (Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1))
}

/// Returns binary logarithms of the number of cells along each axis: enough for all, or as many as
/// there are members.
fn bits_for(cells: Vec3, members: usize) -> [u32; 3] {
    let most = members.next_power_of_two().trailing_zeros().max(3 * LEAST_BITS);
    let needed = |cells: f32| (cells.min(1e9) as u32 + 1).next_power_of_two().trailing_zeros();
    let mut bits = cells.to_array().map(|cells| needed(cells).max(LEAST_BITS));
    while bits.iter().sum::<u32>() > most {
        let widest = (0..3).max_by_key(|&axis| bits[axis]).unwrap_or(0);
        bits[widest] -= 1;
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::slots::Slots;

    fn scattered(count: usize, scale: f32) -> [Vec<f32>; 3] {
        let points: Vec<Vec3> = Slots::new(3).take(count).map(|p| p * scale).collect();
        [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect())
    }

    #[test]
    fn all_neighbours_are_in_the_runs_once() {
        for (count, scale) in [(0, 1.0), (1, 1.0), (500, 5.0), (500, 1e6), (3000, 0.1)] {
            let position = scattered(count, scale);
            let mut grid = Grid::default();
            grid.sort(&position, 1.0);
            assert!(grid.len() <= 64.max(2 * count));
            let at = |i: u32| Vec3::from([0, 1, 2].map(|axis| position[axis][i as usize]));
            for cell in (0..grid.len()).filter(|&cell| !grid.members(cell..cell + 1).is_empty()) {
                let mut seen = vec![0; count];
                grid.for_runs_around(cell, |run| {
                    grid.order()[run].iter().for_each(|&i| seen[i as usize] += 1);
                });
                assert!(seen.iter().all(|&times| times <= 1));
                for &i in &grid.order()[grid.members(cell..cell + 1)] {
                    let near = (0..count as u32).filter(|&j| at(i).distance(at(j)) < 0.999);
                    near.for_each(|j| assert_eq!(seen[j as usize], 1));
                }
            }
        }
    }

    #[test]
    fn sorting_is_stable() {
        let mut grid = Grid::default();
        grid.sort(&scattered(2000, 4.0), 1.0);
        for cell in 0..grid.len() {
            assert!(grid.order()[grid.members(cell..cell + 1)].is_sorted());
        }
    }
}
