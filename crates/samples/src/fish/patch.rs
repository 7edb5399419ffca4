//! Patches: blocks of the grid, and what grows out of them.

use glam::DVec3;

/// A point of the surface and its colour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub position: DVec3,
    pub color: DVec3,
}

/// A block of the grid's quads: from the first ring to the last, and around likewise; places around
/// may go past the count, up to three times, and start again.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub rings: [usize; 2],
    pub around: [usize; 2],
}

impl Block {
    /// Quads along and around.
    pub fn size(&self) -> [usize; 2] {
        [self.rings[1] - self.rings[0], self.around[1] - self.around[0]]
    }

    /// Whether it takes the quad there out of the grid.
    pub fn holds(&self, ring: usize, j: usize, around: usize) -> bool {
        let [first, last] = self.rings;
        (first..last).contains(&ring)
            && (j + 3 * around - self.around[0]) % around < self.around[1] - self.around[0]
    }
}

/// A place of a patch: `u` along the body and `v` around it over the block, `t` from the body (0)
/// to the cap (1); each in [0, 1].
#[derive(Clone, Copy, Debug)]
pub(super) struct Within {
    pub u: f64,
    pub v: f64,
    pub t: f64,
}

/// A place in one cell of the texture; the cell is [0, 1]².
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    pub cell: usize,
    pub uv: [f64; 2],
}

/// What grows out of a block.
pub(super) trait Shape {
    /// Where a place lies; never asked for `t` = 0, which is the body's.
    fn place(&self, at: Within) -> DVec3;
    /// How a corner at `at` looks in a quad whose middle is `quad`.
    fn look(&self, at: Within, quad: Within) -> (Chart, Spot);
}

/// A block, how many rows of quads its walls have, and its shape.
pub(super) struct Patch {
    pub block: Block,
    pub levels: usize,
    pub shape: Box<dyn Shape>,
}

impl Patch {
    /// Faces of its walls: all that it adds, for the cap has as many as the block had.
    pub fn added_faces(&self) -> usize {
        let [a, b] = self.block.size();
        4 * (a + b) * self.levels
    }
}

/// The places on a block's rim, counter-clockwise from outside.
pub(super) fn rim(a: usize, b: usize) -> Vec<[usize; 2]> {
    let mut rim: Vec<_> = (0..a).map(|i| [i, 0]).collect();
    rim.extend((0..b).map(|j| [a, j]));
    rim.extend((1..=a).rev().map(|i| [i, b]));
    rim.extend((1..=b).rev().map(|j| [0, j]));
    rim
}

/// The place of a block's point `i` along and `j` around.
pub(super) fn within(i: usize, j: usize, [a, b]: [usize; 2], t: f64) -> Within {
    Within { u: i as f64 / a as f64, v: j as f64 / b as f64, t }
}

/// A place of a cell in the whole texture: two rows of eight below the body.
pub(super) fn in_cell(Chart { cell, uv }: Chart) -> [f64; 2] {
    let [column, row] = [(cell % 8) as f64, (cell / 8) as f64];
    [(column + 0.03 + 0.94 * uv[0]) / 8.0, (row + 0.03 + 0.94 * uv[1]) * 0.18]
}
