//! Patches of the fish's body: blocks of quads, and the fins and eyes that replace them.

use glam::DVec3;

/// A point of the surface and its colour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub position: DVec3,
    pub color: DVec3,
}

/// A block of quads of the grid, as ranges of rings and of positions around the body, which wrap
/// and may reach up to three times around.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub rings: [usize; 2],
    pub around: [usize; 2],
}

impl Block {
    /// Returns the number of quads along and around the body.
    pub fn size(&self) -> [usize; 2] {
        [self.rings[1] - self.rings[0], self.around[1] - self.around[0]]
    }

    /// Returns true if the quad is in the block.
    pub fn holds(&self, ring: usize, j: usize, around: usize) -> bool {
        let [first, last] = self.rings;
        (first..last).contains(&ring)
            && (j + 3 * around - self.around[0]) % around < self.around[1] - self.around[0]
    }
}

/// A point of a patch: `u` along the body, `v` around it, `t` from the body to the cap; each in
/// [0, 1].
#[derive(Clone, Copy, Debug)]
pub(super) struct Within {
    pub u: f64,
    pub v: f64,
    pub t: f64,
}

/// A point in one cell of the texture; the cell is [0, 1]².
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    pub cell: usize,
    pub uv: [f64; 2],
}

/// Shape of a patch.
pub(super) trait Shape {
    /// Returns the position of a point; not called for `t` = 0, which is on the body.
    fn place(&self, at: Within) -> DVec3;
    /// Returns texture chart and colour of the corner `at` of a quad with the center `quad`.
    fn look(&self, at: Within, quad: Within) -> (Chart, Spot);
}

/// A block of the grid, the number of rows of quads in its walls, and its shape.
pub(super) struct Patch {
    pub block: Block,
    pub levels: usize,
    pub shape: Box<dyn Shape>,
}

impl Patch {
    /// Returns the number of faces added, those of the walls: the cap has as many as the block had.
    pub fn added_faces(&self) -> usize {
        let [a, b] = self.block.size();
        4 * (a + b) * self.levels
    }
}

/// Returns the points on the rim of a block, counter-clockwise seen from outside.
pub(super) fn rim(a: usize, b: usize) -> Vec<[usize; 2]> {
    let mut rim: Vec<_> = (0..a).map(|i| [i, 0]).collect();
    rim.extend((0..b).map(|j| [a, j]));
    rim.extend((1..=a).rev().map(|i| [i, b]));
    rim.extend((1..=b).rev().map(|j| [0, j]));
    rim
}

/// Returns the point of a patch at `i` quads along and `j` quads around.
pub(super) fn within(i: usize, j: usize, [a, b]: [usize; 2], t: f64) -> Within {
    Within { u: i as f64 / a as f64, v: j as f64 / b as f64, t }
}

/// Maps a point of a cell to the whole texture, where two rows of eight cells are below the body.
pub(super) fn in_cell(Chart { cell, uv }: Chart) -> [f64; 2] {
    let [column, row] = [(cell % 8) as f64, (cell / 8) as f64];
    [(column + 0.03 + 0.94 * uv[0]) / 8.0, (row + 0.03 + 0.94 * uv[1]) * 0.18]
}
