//! The header of a block, and how one is found.

use glam::{DMat3, DVec3};

use super::frame::Frame;

/// How the cells of a block lie. Axes: two along the surface, then the one across it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Shape {
    pub(super) frame: Frame,
    /// How many bits two vertices take together along each axis.
    pub(super) widths: [u8; 3],
    /// How large cells are along each, as [`Units::size`] says.
    pub(super) steps: [u8; 3],
    /// Where the middle of the first cell is, from the middle of the group on, in steps of [`Units::anchors`].
    pub(super) anchors: [i32; 3],
}

/// What all blocks are measured by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Units {
    /// The size of step 0.
    pub(super) cell: f64,
    /// The steps in which anchors are counted: along the surface, and across it.
    pub(super) anchors: [u8; 2],
}

/// A block whose header is looked for.
pub(super) struct Block<'s> {
    /// Its vertices.
    pub(super) places: &'s [DVec3],
    /// The middle of its group.
    pub(super) middle: DVec3,
    /// The squares of its normals.
    pub(super) normals: DMat3,
}

/// How large the cells of a block should be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Across the surface.
    pub(super) across: f64,
    /// How many times as large along it at most.
    pub(super) most_along: f64,
}

/// The numbers of two vertices are below this power of two, together.
pub(super) const WIDEST: u8 = 56;
/// Farther from the middle of its group no block is told.
const FARTHEST: f64 = (1 << 30) as f64;

/// Than they should be, cells may be by this: half of what the next width makes of them, and a step.
const LARGER: f64 = 1.3;

/// Eighths of an octave.
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
    /// For cells about so large across the surface: down to an eighth of it, and up to anything.
    pub(super) fn around(across: f64) -> Self {
        // Anchors on half cells across the surface, on every second along it: there are more of them there.
        Self { cell: across / 8.0, anchors: [4 * OCTAVE, 2 * OCTAVE] }
    }

    /// The size of a step.
    #[inline]
    pub(super) fn size(&self, step: u8) -> f64 {
        self.cell * EIGHTHS[usize::from(step % OCTAVE)] * (1u64 << (step / OCTAVE)) as f64
    }

    /// The greatest step no larger than that, or the least.
    fn step_below(&self, size: f64) -> u8 {
        let octave = floor_log2(size / self.cell).min(31) as u8 * OCTAVE;
        (octave..=octave + (OCTAVE - 1))
            .rev()
            .find(|&step| self.size(step) <= size)
            .unwrap_or(octave)
    }

    /// The width, step and anchor of cells about so large that reach over a range.
    fn fitted(&self, reach: [f64; 2], size: f64, anchor: f64) -> Option<(u8, u8, i32)> {
        let length = reach[1] - reach[0];
        let count = (length / size).max(1.0);
        // Twice the logarithm, rounded.
        let about = u8::try_from(floor_log2(count * count * std::f64::consts::SQRT_2)).ok()?;
        // Between anchors few cells may not reach far enough: then there are more, not larger ones.
        (about..=WIDEST).find_map(|width| {
            let count = numbers(width) as f64;
            let most = self.step_below(size * LARGER);
            // How large a single cell is makes no difference.
            let least = if count > 1.0 { self.step_below(length / count) } else { most };
            let fit = |step| Some((width, step, first(reach, count, self.size(step), anchor)?));
            (least..=most).find_map(fit)
        })
    }

    fn anchor(&self, axis: usize) -> f64 {
        self.size(self.anchors[usize::from(axis == 2)])
    }
}

/// The exponent of a number of at least 1; 0 of others. Not by a logarithm: that may differ between machines.
fn floor_log2(x: f64) -> u32 {
    if x >= 1.0 { (x.to_bits() >> 52) as u32 - 1023 } else { 0 }
}

/// How many numbers a vertex has along an axis, if two take so many bits.
///
/// 1, 1, 2, 2, 4, 5, 8, 11, 16, 22, 32, 45, …: half an octave each, and nothing is lost in whole bits.
#[inline]
pub(super) fn numbers(width: u8) -> u64 {
    (1u64 << width).isqrt()
}

impl Block<'_> {
    /// The frame in which cells of equal effect are fewest.
    pub(super) fn frame(&self, wanted: &Wanted) -> Frame {
        let best = |best: (f64, Frame), frame: Frame| {
            let cells = self.cells(frame.axes(), wanted);
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

    /// About how many cells there are.
    fn cells(&self, axes: [DVec3; 3], wanted: &Wanted) -> f64 {
        let sizes = self.sizes(axes, wanted);
        let count = |k: usize| {
            let [low, high] = self.reach(axes[k]);
            1.0 + (high - low) / sizes[k]
        };
        count(0) * count(1) * count(2)
    }

    /// How large cells should be along each axis: for the least error of so many they all have the same effect, and
    /// along an axis that is as the mean part of the normals there.
    fn sizes(&self, axes: [DVec3; 3], wanted: &Wanted) -> [f64; 3] {
        let parts = axes.map(|axis| axis.dot(self.normals * axis).max(0.0).sqrt());
        let along = |k: usize| {
            let is_flat = parts[k] * wanted.most_along <= parts[2];
            let times = if is_flat { wanted.most_along } else { (parts[2] / parts[k]).max(1.0) };
            wanted.across * times
        };
        [along(0), along(1), wanted.across]
    }

    fn reach(&self, axis: DVec3) -> [f64; 2] {
        self.places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &place| {
            let x = place.dot(axis);
            [low.min(x), high.max(x)]
        })
    }

    /// The header in a frame; `None` where it would take larger numbers than there are.
    pub(super) fn shape(&self, frame: Frame, units: &Units, wanted: &Wanted) -> Option<Shape> {
        let axes = frame.axes();
        let sizes = self.sizes(axes, wanted);
        let mut shape = Shape { frame, ..Shape::default() };
        for k in 0..3 {
            let middle = self.middle.dot(axes[k]);
            let reach = self.reach(axes[k]).map(|x| x - middle);
            let fitted = units.fitted(reach, sizes[k], units.anchor(k))?;
            (shape.widths[k], shape.steps[k], shape.anchors[k]) = fitted;
        }
        Some(shape)
    }
}

/// The anchor from which so many cells reach over a range; `None` where none does.
fn first([low, high]: [f64; 2], count: f64, cell: f64, anchor: f64) -> Option<i32> {
    let least = ((high - (count - 0.5) * cell) / anchor).ceil();
    let most = ((low + 0.5 * cell) / anchor).floor();
    let found = ((least + most) * 0.5).round().min(most);
    (least <= most && found.abs() < FARTHEST).then_some(found as i32)
}

impl Shape {
    /// The sides of a cell, and the middle of the first one from the middle of the group on.
    pub(super) fn cells(&self, units: &Units) -> ([DVec3; 3], DVec3) {
        let axes = self.frame.axes();
        let at = |k: usize| axes[k] * (f64::from(self.anchors[k]) * units.anchor(k));
        let first = at(0) + at(1) + at(2);
        ([0, 1, 2].map(|k| axes[k] * units.size(self.steps[k])), first)
    }

    /// How many bits two vertices take.
    pub(super) fn bits(&self) -> u32 {
        self.widths.iter().map(|&width| u32::from(width)).sum()
    }
}

/// About the direction of the greatest of squares.
fn greatest(squares: &DMat3) -> DVec3 {
    let longer = |a: DVec3, b: DVec3| if b.length_squared() > a.length_squared() { b } else { a };
    let mut along = longer(longer(squares.x_axis, squares.y_axis), squares.z_axis);
    for _ in 0..16 {
        // Of no squares any is as good.
        along = *squares * along.try_normalize().unwrap_or(DVec3::Z);
    }
    along.try_normalize().unwrap_or(DVec3::Z)
}
