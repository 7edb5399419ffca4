//! Block headers, and the search for the best one.

use glam::{DMat3, DVec3};

use super::frame::Frame;

/// Placement of a block's cells. Axes: two along the surface, then the one across it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct BlockHeader {
    pub(super) frame: Frame,
    /// Bits that two vertices take together along each axis.
    pub(super) widths: [u8; 3],
    /// Cell size along each axis, as a code of [`Units::size`].
    pub(super) steps: [u8; 3],
    /// Middle of the first cell relative to the middle of the group, in units of
    /// [`Units::anchors`].
    pub(super) anchors: [i32; 3],
}

/// Units that all blocks share.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Units {
    /// Size of step 0.
    pub(super) cell: f64,
    /// Step codes of the anchors' units, along the surface and across it.
    pub(super) anchors: [u8; 2],
}

/// Vertices of a block for which a header is sought.
pub(super) struct BlockVertices<'s> {
    /// Positions of the vertices.
    pub(super) places: &'s [DVec3],
    /// Middle of the block's group.
    pub(super) middle: DVec3,
    /// Sum of squared normals around the vertices, by area.
    pub(super) normals: DMat3,
}

/// Desired cell sizes of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellSizes {
    /// Size across the surface.
    pub(super) across: f64,
    /// Upper limit on size along the surface / size across it.
    pub(super) max_elongation: f64,
}

/// Greatest number of bits that two vertices may take along an axis.
pub(super) const WIDEST: u8 = 56;
/// Greatest distance of a block from the middle of its group, in anchor units.
const MAX_ANCHOR: f64 = (1 << 30) as f64;

/// Factor by which cells may exceed the desired size: half the jump to the next width, and a step.
const LARGER: f64 = 1.3;

/// Powers of 2^(1/8).
const EIGHTHS: [f64; 8] = [
    1.0,
    1.090_507_732_665_257_7,
    1.189_207_115_002_721,
    1.296_839_554_651_009_6,
    std::f64::consts::SQRT_2,
    1.542_210_825_407_940_7,
    1.681_792_830_507_429,
    1.834_008_086_409_342_4,
];
const OCTAVE: u8 = 8;

impl Units {
    /// Returns units for cells of about this size across the surface: an eighth of it and larger.
    pub(super) fn around(across: f64) -> Self {
        // Anchors lie on every half cell across the surface, on every second cell along it, where
        // blocks have more cells.
        Self { cell: across / 8.0, anchors: [4 * OCTAVE, 2 * OCTAVE] }
    }

    /// Returns the size of a step.
    #[inline]
    pub(super) fn size(&self, step: u8) -> f64 {
        self.cell * EIGHTHS[usize::from(step % OCTAVE)] * (1u64 << (step / OCTAVE)) as f64
    }

    /// Returns the greatest step no larger than a size, or the least of its octave.
    fn step_below(&self, size: f64) -> u8 {
        let octave = floor_log2(size / self.cell).min(31) as u8 * OCTAVE;
        (octave..=octave + (OCTAVE - 1))
            .rev()
            .find(|&step| self.size(step) <= size)
            .unwrap_or(octave)
    }

    /// Returns width, step and anchor of cells of about a size that cover a range.
    fn fitted(&self, reach: [f64; 2], size: f64, anchor: f64) -> Option<(u8, u8, i32)> {
        let length = reach[1] - reach[0];
        let count = (length / size).max(1.0);
        // Twice the binary logarithm, rounded.
        let about = u8::try_from(floor_log2(count * count * std::f64::consts::SQRT_2)).ok()?;
        // With few cells, the rounded anchor may leave the range uncovered. Then take more cells,
        // not larger ones.
        (about..=WIDEST).find_map(|width| {
            let count = numbers(width) as f64;
            let most = self.step_below(size * LARGER);
            // A single cell covers the range at any size.
            let least = if count > 1.0 { self.step_below(length / count) } else { most };
            let fit = |step| Some((width, step, first(reach, count, self.size(step), anchor)?));
            (least..=most).find_map(fit)
        })
    }

    fn anchor(&self, axis: usize) -> f64 {
        self.size(self.anchors[usize::from(axis == 2)])
    }
}

/// Returns the binary exponent of a number of at least 1, else 0. A logarithm may differ between
/// machines.
fn floor_log2(x: f64) -> u32 {
    if x >= 1.0 { (x.to_bits() >> 52) as u32 - 1023 } else { 0 }
}

/// Returns how many cells a vertex can tell apart if two vertices share `width` bits.
///
/// 1, 1, 2, 2, 4, 5, 8, 11, 16, 22, 32, 45, …: half an octave each, with hardly any bits lost.
#[inline]
pub(super) fn numbers(width: u8) -> u64 {
    (1u64 << width).isqrt()
}

impl BlockVertices<'_> {
    /// Finds the frame in which the fewest cells of equal effect cover the block.
    pub(super) fn frame(&self, sizes: &CellSizes) -> Frame {
        let best = |best: (f64, Frame), frame: Frame| {
            let cells = self.cells(frame.axes(), sizes);
            if cells < best.0 { (cells, frame) } else { best }
        };
        let start = Frame::towards(greatest(&self.normals));
        let mut found = start.turned().fold((f64::INFINITY, start), best);
        for step in [8, 4, 2, 1] {
            for _ in 0..4 {
                let next = found.1.tilted(step).fold(found, best);
                if next.1 == found.1 {
                    break;
                }
                found = next;
            }
        }
        found.1.turned().fold(found, best).1
    }

    /// Estimates the number of cells in a frame.
    fn cells(&self, axes: [DVec3; 3], sizes: &CellSizes) -> f64 {
        let sizes = self.sizes(axes, sizes);
        let count = |k: usize| {
            let [low, high] = self.reach(axes[k]);
            1.0 + (high - low) / sizes[k]
        };
        count(0) * count(1) * count(2)
    }

    /// Returns the desired cell size along each axis. For a given number of cells the error is
    /// least if all axes have the same effect, which is the root mean square of the normals'
    /// components.
    fn sizes(&self, axes: [DVec3; 3], sizes: &CellSizes) -> [f64; 3] {
        let parts = axes.map(|axis| axis.dot(self.normals * axis).max(0.0).sqrt());
        let along = |k: usize| {
            let is_flat = parts[k] * sizes.max_elongation <= parts[2];
            let times = if is_flat { sizes.max_elongation } else { (parts[2] / parts[k]).max(1.0) };
            sizes.across * times
        };
        [along(0), along(1), sizes.across]
    }

    fn reach(&self, axis: DVec3) -> [f64; 2] {
        self.places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &place| {
            let x = place.dot(axis);
            [low.min(x), high.max(x)]
        })
    }

    /// Builds the header for a frame; `None` if it needs numbers beyond the format's.
    pub(super) fn header(
        &self,
        frame: Frame,
        units: &Units,
        sizes: &CellSizes,
    ) -> Option<BlockHeader> {
        let axes = frame.axes();
        let sizes = self.sizes(axes, sizes);
        let mut header = BlockHeader { frame, ..BlockHeader::default() };
        for k in 0..3 {
            let middle = self.middle.dot(axes[k]);
            let reach = self.reach(axes[k]).map(|x| x - middle);
            let fitted = units.fitted(reach, sizes[k], units.anchor(k))?;
            (header.widths[k], header.steps[k], header.anchors[k]) = fitted;
        }
        Some(header)
    }
}

/// Returns an anchor from which the cells cover a range; `None` if none exists.
fn first([low, high]: [f64; 2], count: f64, cell: f64, anchor: f64) -> Option<i32> {
    let least = ((high - (count - 0.5) * cell) / anchor).ceil();
    let most = ((low + 0.5 * cell) / anchor).floor();
    let found = ((least + most) * 0.5).round().min(most);
    (least <= most && found.abs() < MAX_ANCHOR).then_some(found as i32)
}

impl BlockHeader {
    /// Returns the sides of a cell, and the middle of the first one relative to the middle of the
    /// group.
    pub(super) fn cells(&self, units: &Units) -> ([DVec3; 3], DVec3) {
        let axes = self.frame.axes();
        let at = |k: usize| axes[k] * (f64::from(self.anchors[k]) * units.anchor(k));
        let first = at(0) + at(1) + at(2);
        ([0, 1, 2].map(|k| axes[k] * units.size(self.steps[k])), first)
    }

    /// Returns the number of bits of two vertices.
    pub(super) fn bits(&self) -> u32 {
        self.widths.iter().map(|&width| u32::from(width)).sum()
    }
}

/// Estimates the dominant eigenvector by power iteration.
fn greatest(squares: &DMat3) -> DVec3 {
    let longer = |a: DVec3, b: DVec3| if b.length_squared() > a.length_squared() { b } else { a };
    let mut along = longer(longer(squares.x_axis, squares.y_axis), squares.z_axis);
    for _ in 0..16 {
        // For a zero matrix any direction will do.
        along = *squares * along.try_normalize().unwrap_or(DVec3::Z);
    }
    along.try_normalize().unwrap_or(DVec3::Z)
}
