//! Uniform grid that sorts members by cell, so that neighbours are near in memory too.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

/// Grid of cells as wide as the neighbour radius (along x, a fraction of it), with members in the
/// order of their cells.
///
/// Cells that are too many for the members are folded: the grid repeats in space, and members far
/// apart may share a cell. That costs candidates, never neighbours. Within a cell members keep
/// their order, so that the order does not depend on the number of threads.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    /// Number of cells along each axis.
    size: [u32; 3],
    /// First member of each cell in sorted order, and the number of members at the end.
    starts: Vec<u32>,
    /// Cell of each member in the order before sorting.
    cells: Vec<u32>,
    /// Member, in the order before, that comes to each place.
    order: Vec<u32>,
}

/// Cells along x in a neighbour radius. A run of candidates is 2 + 1 / `PARTS` radii long.
const PARTS: u32 = 4;
/// Least number of cells along each axis, so that those around one differ.
const LEAST: [u32; 3] = [2 * PARTS + 1, 3, 3];
/// Greatest number of runs around a cell: rows, each in two where it is folded.
const RUNS: usize = 18;
/// Members that a thread takes at once.
const CHUNK: usize = 8192;

/// Runs of sorted members around a cell.
#[derive(Clone, Debug)]
pub struct Runs {
    runs: [Range<u32>; RUNS],
    len: usize,
}

impl Default for Runs {
    fn default() -> Self {
        Self { runs: [const { 0..0 }; RUNS], len: 0 }
    }
}

impl Runs {
    /// Returns the runs.
    pub fn as_slice(&self) -> &[Range<u32>] {
        &self.runs[..self.len]
    }

    #[inline]
    fn push(&mut self, run: Range<u32>) {
        if !run.is_empty() {
            self.runs[self.len] = run;
            self.len += 1;
        }
    }
}

impl Grid {
    /// Sorts members by cell, given their positions by axis; see [`Self::order`].
    ///
    /// Cost: O(n), n = members; at most max(81, 4 n) cells.
    pub fn sort(&mut self, position: &[Vec<f32>; 3], radius: f32) {
        let (least, greatest) = bounds(position);
        let per_length = Vec3::new(PARTS as f32, 1.0, 1.0) / radius;
        self.size = size_for((greatest - least) * per_length, position[0].len());
        self.assign(position, least, per_length);
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

    /// Returns the first cell that begins after `member`.
    pub fn cell_of(&self, cells: Range<usize>, member: usize) -> usize {
        let starts = &self.starts[cells.start..cells.end];
        cells.start + starts.partition_point(|&start| start as usize <= member)
    }

    /// Finds the runs of sorted members in a cell or within the radius of it, each once.
    #[inline]
    pub fn find_runs(&self, cell: usize, runs: &mut Runs) {
        let [nx, ny, nz] = self.size;
        let cell = cell as u32;
        let (x, row) = (cell % nx, cell / nx);
        let (y, z) = (row % ny, row / ny);
        let around = |at: u32, n: u32| {
            [if at > 0 { at - 1 } else { n - 1 }, at, if at + 1 < n { at + 1 } else { 0 }]
        };
        runs.len = 0;
        for z in around(z, nz) {
            for y in around(y, ny) {
                let row = (z * ny + y) * nx;
                let mut push = |from: u32, to: u32| {
                    let [from, to] = [from, to].map(|x| self.starts[(row + x) as usize]);
                    runs.push(from..to);
                };
                // Where the row is folded, its two ends are next to each other.
                if x < PARTS {
                    push(0, x + PARTS + 1);
                    push(nx + x - PARTS, nx);
                } else if x + PARTS >= nx {
                    push(x - PARTS, nx);
                    push(0, x + PARTS + 1 - nx);
                } else {
                    push(x - PARTS, x + PARTS + 1);
                }
            }
        }
    }

    fn assign(&mut self, [x, y, z]: &[Vec<f32>; 3], least: Vec3, per_length: Vec3) {
        let [nx, ny, nz] = self.size;
        self.cells.resize(x.len(), 0);
        let fold = |at: f32, n: u32| {
            let at = at as u32;
            if at < n { at } else { at % n }
        };
        self.cells.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, cells)| {
            let first = chunk * CHUNK;
            let range = first..first + cells.len();
            let (x, y, z) = (&x[range.clone()], &y[range.clone()], &z[range]);
            for (((to, &x), &y), &z) in cells.iter_mut().zip(x).zip(y).zip(z) {
                let at = (Vec3::new(x, y, z) - least) * per_length;
                *to = (fold(at.z, nz) * ny + fold(at.y, ny)) * nx + fold(at.x, nx);
            }
        });
    }

    /// Counting sort by cell.
    fn count(&mut self) {
        let cells = self.size.iter().product::<u32>() as usize;
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

/// Returns the number of cells along each axis: enough for all, or four for each member.
fn size_for(cells: Vec3, members: usize) -> [u32; 3] {
    let most = (4 * members as u64).max(LEAST.iter().product::<u32>().into());
    let needed = cells.to_array().map(|cells| cells.min(1e9) as u32 + 1);
    let mut size: [u32; 3] = std::array::from_fn(|axis| needed[axis].max(LEAST[axis]));
    while size.iter().map(|&n| u64::from(n)).fold(1, u64::saturating_mul) > most {
        // The axis that has the most cells to spare is halved; one has some, as `most` is enough
        // for the least number along each.
        let spare = |&axis: &usize| 64 * u64::from(size[axis]) / u64::from(LEAST[axis]);
        let widest = (0..3).max_by_key(spare).unwrap_or(0);
        size[widest] = (size[widest] / 2).max(LEAST[widest]);
    }
    size
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
        for (count, scale) in [(0, 1.0), (1, 1.0), (500, 5.0), (500, 1e6), (3000, 0.1), (22, 1.1)] {
            let position = scattered(count, scale);
            let mut grid = Grid::default();
            grid.sort(&position, 1.0);
            assert!(grid.len() <= 81.max(4 * count));
            let at = |i: u32| Vec3::from([0, 1, 2].map(|axis| position[axis][i as usize]));
            for cell in (0..grid.len()).filter(|&cell| !grid.members(cell..cell + 1).is_empty()) {
                let mut seen = vec![0; count];
                let mut runs = Runs::default();
                grid.find_runs(cell, &mut runs);
                for Range { start, end } in runs.as_slice() {
                    let run = &grid.order()[*start as usize..*end as usize];
                    run.iter().for_each(|&i| seen[i as usize] += 1);
                }
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
