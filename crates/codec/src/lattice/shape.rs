//! How the vertices of a block lie on the lattice: sheared flat, and how far they reach then.
//!
//! Most blocks are nearly plane. Along the axis that is closest to the normal, each vertex loses the whole part of
//! where the plane is above it: integers in, integers out, so nothing is lost [BE92]. What is left spans a
//! few cells.

/// How a block is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Shape {
    /// The axis that is sheared by the two others; those follow it, in cyclic order.
    pub(super) axis: u8,
    /// How much of the first other axis, and of the second, is taken off the sheared one; how much of the
    /// second off the first. In parts of [`SLOPE`].
    pub(super) slopes: [i8; 3],
    /// The least of each, along the two other axes and the sheared one, after shearing.
    pub(super) least: [i32; 3],
    /// As many cells each spans, as a code of [`span`].
    pub(super) spans: [u8; 3],
}

const SLOPE: i32 = 32;
/// Slopes have so many bits, with a sign.
pub(super) const SLOPE_BITS: u32 = 7;
const STEEPEST: i32 = (1 << (SLOPE_BITS - 1)) - 1;

impl Shape {
    /// The one of the shapes tried that takes the fewest bits. Cells are at least 0 and at most `most`, which is
    /// below [`MOST_CELLS`], along each axis; so are all leasts.
    pub(super) fn of(cells: &[[i32; 3]], most: [i32; 3]) -> Self {
        let plain = Self::fitted(cells, 0, [0; 3]);
        let sheared = (0..3).map(|axis| Self::fitted(cells, axis, slopes(cells, axis)));
        let is_told = |shape: &Self| {
            let axes = axes(shape.axis);
            (0..3).all(|k| (0..=most[axes[k]]).contains(&shape.least[k]))
        };
        let told = sheared.flatten().filter(is_told);
        // Within so few cells a plain one fits.
        let plain = plain.unwrap_or_default();
        told.fold(plain, |best, shape| if shape.bits() < best.bits() { shape } else { best })
    }

    /// Around sheared cells; `None` where they span too much.
    fn fitted(cells: &[[i32; 3]], axis: u8, slopes: [i8; 3]) -> Option<Self> {
        let mut shape = Self { axis, slopes, least: [0; 3], spans: [0; 3] };
        // What an axis is sheared by is known before it.
        for k in [1, 0, 2] {
            let along = |&cell: &[i32; 3]| shape.sheared(cell)[k];
            let least = cells.iter().map(along).min().unwrap_or(0);
            let most = cells.iter().map(along).max().unwrap_or(0);
            shape.spans[k] = span_code((i64::from(most) - i64::from(least) + 1) as u64)?;
            shape.least[k] = least;
        }
        Some(shape)
    }

    /// How many bits a vertex takes.
    #[inline]
    pub(super) fn bits(&self) -> u32 {
        let [u, v, w] = self.spans.map(span);
        // All numbers below u·v·w.
        u64::BITS - (u * v * w - 1).leading_zeros()
    }

    /// A cell of the block as one number.
    pub(super) fn number(&self, cell: [i32; 3]) -> u64 {
        let cell = self.sheared(cell);
        let [u, v, w] = [0, 1, 2].map(|k| (cell[k] - self.least[k]) as u64);
        u + span(self.spans[0]) * (v + span(self.spans[1]) * w)
    }

    /// The cell of a number.
    #[inline]
    pub(super) fn cell(&self, number: u64) -> [i32; 3] {
        let [first, second, _] = self.spans.map(span);
        let digits = [number % first, number / first % second, number / first / second];
        let [u, v, w] = [0, 1, 2].map(|k| digits[k] as i32 + self.least[k]);
        let u = u + shear(self.slopes[2], v - self.least[1]);
        let w = w + self.height(u, v);
        let mut cell = [0; 3];
        let [along_u, along_v, along_w] = axes(self.axis);
        (cell[along_u], cell[along_v], cell[along_w]) = (u, v, w);
        cell
    }

    /// Along the two other axes and the sheared one.
    fn sheared(&self, cell: [i32; 3]) -> [i32; 3] {
        let [u, v, w] = axes(self.axis).map(|axis| cell[axis]);
        [u - shear(self.slopes[2], v - self.least[1]), v, w - self.height(u, v)]
    }

    /// How high the plane is.
    #[inline]
    fn height(&self, u: i32, v: i32) -> i32 {
        let [first, second, _] = self.slopes;
        shear(first, u - self.least[0]) + shear(second, v - self.least[1])
    }
}

/// The two other axes in cyclic order, and the sheared one.
#[inline]
pub(super) fn axes(sheared: u8) -> [usize; 3] {
    let axis = usize::from(sheared);
    [(axis + 1) % 3, (axis + 2) % 3, axis % 3]
}

/// A slope times a number, rounded down: the same on every machine.
#[inline]
fn shear(slope: i8, by: i32) -> i32 {
    ((i64::from(slope) * i64::from(by)) >> SLOPE.trailing_zeros()) as i32
}

/// The slopes of the plane closest to the cells along an axis, and how much of the second other axis goes with
/// the first.
fn slopes(cells: &[[i32; 3]], axis: u8) -> [i8; 3] {
    let axes = axes(axis);
    let count = cells.len().max(1) as f64;
    let mean = axes.map(|k| cells.iter().map(|cell| f64::from(cell[k])).sum::<f64>() / count);
    let mut sums = [[0.0; 3]; 3];
    for cell in cells {
        let away = [0, 1, 2].map(|i| f64::from(cell[axes[i]]) - mean[i]);
        for i in 0..3 {
            for j in 0..3 {
                sums[i][j] += away[i] * away[j];
            }
        }
    }
    let [[uu, uv, uw], [_, vv, vw], _] = sums;
    let det = uu * vv - uv * uv;
    let flat = |x: f64, by: f64| if by > 0.0 { x / by } else { 0.0 };
    let plane = if det > 1e-9 * uu * vv {
        [(uw * vv - vw * uv) / det, (vw * uu - uw * uv) / det]
    } else {
        [flat(uw, uu), 0.0]
    };
    [plane[0], plane[1], flat(uv, vv)].map(|slope| {
        let steps = (slope * f64::from(SLOPE)).round();
        // NaN is not expected, and would be no slope.
        steps.clamp(f64::from(-STEEPEST), f64::from(STEEPEST)) as i8
    })
}

/// Spans of four bits of mantissa and four of exponent: at most a sixteenth more than need be.
pub(super) const SPAN_BITS: u32 = 8;

/// How many cells a code spans.
#[inline]
pub(super) fn span(code: u8) -> u64 {
    let (exponent, mantissa) = (u32::from(code >> 4), u64::from(code & 15));
    match exponent {
        0 => mantissa + 1,
        _ => (mantissa + 17) << (exponent - 1),
    }
}

/// The code of the least span of at least so many cells.
fn span_code(cells: u64) -> Option<u8> {
    (0..=u8::MAX).find(|&code| span(code) >= cells)
}

/// What a plain block can span in any case.
pub(super) const MOST_CELLS: i32 = 1 << 19;

#[cfg(test)]
mod tests {
    use super::*;

    const MOST: [i32; 3] = [MOST_CELLS - 1; 3];

    fn slanted() -> Vec<[i32; 3]> {
        let at = |i: i32| [i % 8 * 9 + 300, i / 8 * 11 + 4000];
        (0..64).map(at).map(|[u, v]| [u, v, 2000 + (3 * u - 2 * v) / 5 + (u ^ v) % 2]).collect()
    }

    #[test]
    fn every_cell_comes_back() {
        for turn in 0..3 {
            let mut cells = slanted();
            cells.iter_mut().for_each(|cell| cell.rotate_left(turn));
            let shape = Shape::of(&cells, MOST);
            let plain = Shape::fitted(&cells, 0, [0; 3]).unwrap();
            assert!(shape.bits() + 3 < plain.bits(), "{shape:?}");
            for &cell in &cells {
                assert!(shape.number(cell) >> shape.bits() == 0);
                assert_eq!(shape.cell(shape.number(cell)), cell);
            }
        }
    }

    #[test]
    fn leasts_stay_where_the_mesh_is() {
        // Sheared back to its first vertex, it would lie below all of the mesh.
        let cells: Vec<_> = (0..32).map(|i| [i, 20 - i / 2, (31 - i) / 2]).collect();
        let shape = Shape::of(&cells, [31, 20, 15]);
        let axes = axes(shape.axis);
        assert!((0..3).all(|k| (0..=[31, 20, 15][axes[k]]).contains(&shape.least[k])), "{shape:?}");
        assert!(cells.iter().all(|&cell| shape.cell(shape.number(cell)) == cell));
    }

    #[test]
    fn one_cell_takes_no_bits_and_the_widest_blocks_fit() {
        let shape = Shape::of(&[[7, 3, 1 << 18]; 3], MOST);
        assert_eq!((shape.bits(), shape.cell(0)), (0, [7, 3, 1 << 18]));
        let wide = [[0; 3], MOST];
        let shape = Shape::of(&wide, MOST);
        assert!(wide.iter().all(|&cell| shape.cell(shape.number(cell)) == cell));
    }

    #[test]
    fn spans_are_in_order_and_little_more_than_need_be() {
        assert!((0..u8::MAX).all(|code| span(code) < span(code + 1)));
        for cells in (1..2000).chain([1 << 16, 1 << 19]) {
            let found = span(span_code(cells).unwrap());
            assert!(found >= cells && found * 16 <= cells * 17 + 16, "{cells}: {found}");
        }
        assert_eq!(span_code((1 << 19) + 1), None);
    }
}
