//! Integer shear transforms that lay a block flat and upright, so that it spans fewer cells.
//!
//! Along the axis closest to the normal, a quadratic height field is subtracted from each vertex;
//! along the other two, the block is sheared. Each lifting step depends only on coordinates that it
//! leaves alone, so it is undone exactly [BE92].

use super::search::{BEND, SLOPE, Search, axes, centre};

/// Shear transform of a block, with the box of the result. Everything is relative to the middle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ShearTransform {
    /// Axis `w` that is flattened; `u` and `v` along the block follow it in cyclic order.
    pub(super) axis: u8,
    /// Slopes in units of 1 / [`SLOPE`]: of `v` subtracted from `u`, of `u` then from `v`, of `u`
    /// and `v` from `w`.
    pub(super) slopes: [i8; 4],
    /// Bends in units of 1 / [`BEND`]: of `u²`, `uv` and `v²` subtracted from `w`, divided by the
    /// spans of `u`, `u` and `v`.
    pub(super) bends: [i8; 3],
    /// Middle of the block, along `u`, `v` and `w`.
    pub(super) middle: [i32; 3],
    /// Number of cells spanned along each axis, as a code of [`span`].
    pub(super) spans: [u8; 3],
}

/// Vertices that share one number, so that less than a bit is lost for all of them.
pub(super) const TUPLE: usize = 4;

impl ShearTransform {
    /// Finds the transform with the fewest bits, with or without bends. Cells must be at least 0
    /// and below [`MAX_CELLS`].
    pub(super) fn of(cells: &[[i32; 3]], is_bent: bool) -> Self {
        // Around the middle of its box, every block fits without shears.
        let plain = Self::default().centred(cells).unwrap_or_default();
        let sheared = (0..3).filter_map(|axis| {
            let at = Search::new(cells, axis, is_bent).best();
            Self { axis, slopes: at.slopes(), bends: at.bends(), ..Self::default() }.centred(cells)
        });
        sheared.fold(plain, |best, one| if one.volume() < best.volume() { one } else { best })
    }

    /// Moves the middle to where the box is smallest, and sets the spans.
    fn centred(mut self, cells: &[[i32; 3]]) -> Option<Self> {
        let of = centre(cells);
        let middle = axes(self.axis).map(|axis| of[axis]);
        let mut best = None::<Self>;
        let mut at = middle;
        for _ in 0..TRIES {
            let Some(fitted) = self.fitted(cells, at) else { break };
            if best.is_none_or(|best| fitted.volume() < best.volume()) {
                best = Some(fitted);
            }
            // Bends are relative to spans.
            self.spans = fitted.spans;
            let [low, high] = fitted.reach(cells);
            let by = [0, 1, 2].map(|k| (low[k] + high[k] + 1).div_euclid(2));
            let v = by[1] + shear(self.slopes[1], by[0]);
            let u = by[0] + shear(self.slopes[0], v);
            let w = by[2] + shear(self.slopes[2], u) + shear(self.slopes[3], v);
            let next = [(0, u), (1, v), (2, w)].map(|(k, by)| at[k] + by as i32);
            if next == at || next.iter().any(|&x| !(0..MAX_CELLS).contains(&x)) {
                break;
            }
            at = next;
        }
        best
    }

    /// Sets the middle, and the spans around it; `None` if one is too large.
    fn fitted(mut self, cells: &[[i32; 3]], middle: [i32; 3]) -> Option<Self> {
        self.middle = middle;
        for k in 0..3 {
            // The last axis depends on the spans of the others.
            let [low, high] = self.reach(cells);
            self.spans[k] = span_code((-2 * low[k]).max(2 * high[k] + 1).max(1) as u64)?;
        }
        Some(self)
    }

    /// Returns the least and greatest transformed coordinates.
    fn reach(&self, cells: &[[i32; 3]]) -> [[i64; 3]; 2] {
        let cells = cells.iter().map(|&cell| self.transformed(cell));
        cells.fold([[0; 3]; 2], |[low, high], x| {
            [[0, 1, 2].map(|k| low[k].min(x[k])), [0, 1, 2].map(|k| high[k].max(x[k]))]
        })
    }

    fn volume(&self) -> u64 {
        self.spans.map(span).into_iter().product()
    }

    /// Returns how many vertices share a number, and its number of bits.
    pub(super) fn tuple(&self) -> (usize, u32) {
        let volume = u128::from(self.volume());
        let bits = |most: u128| u128::BITS - (most - 1).leading_zeros();
        // A single vertex always has fewer than 64 bits.
        match volume.checked_pow(TUPLE as u32) {
            Some(most) => (TUPLE, bits(most)),
            None => (1, bits(volume)),
        }
    }

    /// Returns the number of bits of this many vertices.
    pub(super) fn bits(&self, vertices: usize) -> usize {
        let (size, bits) = self.tuple();
        vertices.div_ceil(size) * bits as usize
    }

    /// Packs the cells of a tuple into one number.
    pub(super) fn number(&self, cells: &[[i32; 3]]) -> u128 {
        let volume = u128::from(self.volume());
        cells.iter().rev().fold(0, |number, &cell| {
            let cell = self.transformed(cell);
            let [u, v, w] = self.spans.map(span);
            let digit = |k: usize| (cell[k] + span(self.spans[k]) as i64 / 2) as u64;
            debug_assert!(digit(0) < u && digit(1) < v && digit(2) < w);
            number * volume + u128::from(digit(0) + u * (digit(1) + v * digit(2)))
        })
    }

    /// Unpacks one cell of a tuple.
    pub(super) fn cell(&self, number: u128, at: usize) -> [i64; 3] {
        let volume = u128::from(self.volume());
        // Below the volume, which is below 2^58.
        let own = (number / volume.pow(at as u32) % volume) as u64;
        let [first, second, third] = self.spans.map(span);
        let away = |digit: u64, span: u64| digit as i64 - span as i64 / 2;
        let v = away(own / first % second, second);
        let u = away(own % first, first);
        let v = v + shear(self.slopes[1], u);
        let u = u + shear(self.slopes[0], v);
        let w = away(own / first / second, third) + self.height(u, v);
        let mut cell = [0; 3];
        for (k, axis) in axes(self.axis).into_iter().enumerate() {
            cell[axis] = i64::from(self.middle[k]) + [u, v, w][k];
        }
        cell
    }

    /// Transforms a cell.
    fn transformed(&self, cell: [i32; 3]) -> [i64; 3] {
        let axes = axes(self.axis);
        let [u, v, w] = [0, 1, 2].map(|k| i64::from(cell[axes[k]]) - i64::from(self.middle[k]));
        let w = w - self.height(u, v);
        let u = u - shear(self.slopes[0], v);
        [u, v - shear(self.slopes[1], u), w]
    }

    /// Returns the height to subtract from `w`.
    fn height(&self, u: i64, v: i64) -> i64 {
        let [uu, uv, vv] = self.bends.map(i64::from);
        let plane = shear(self.slopes[2], u) + shear(self.slopes[3], v);
        if self.bends == [0; 3] {
            return plane;
        }
        let [across_u, across_v, _] = self.spans.map(|code| BEND * span(code) as i64);
        plane + (u * (uu * u + uv * v)).div_euclid(across_u) + (vv * v * v).div_euclid(across_v)
    }
}

/// Limit on moves of the middle.
const TRIES: usize = 6;

/// Multiplies by a slope, rounding down, which is the same on every machine.
fn shear(slope: i8, by: i64) -> i64 {
    (i64::from(slope) * by).div_euclid(SLOPE)
}

/// Decodes a span: four bits of mantissa and four of exponent, at most a sixteenth more than
/// needed.
pub(super) fn span(code: u8) -> u64 {
    let (exponent, mantissa) = (u32::from(code >> 4), u64::from(code & 15));
    match exponent {
        0 => mantissa + 1,
        _ => (mantissa + 17) << (exponent - 1),
    }
}

/// Returns the code of the least span of at least `cells`.
fn span_code(cells: u64) -> Option<u8> {
    (0..=u8::MAX).find(|&code| span(code) >= cells)
}

/// Number of cells that a plain block can always span.
pub(super) const MAX_CELLS: i32 = 1 << 19;

#[cfg(test)]
mod tests {
    use super::*;

    /// Bent piece of a slanted plane, sheared along itself.
    fn slanted() -> Vec<[i32; 3]> {
        let at = |i: i32| [i % 8 * 9 + i / 8 * 5 + 300, i / 8 * 11 + 4000];
        let height =
            |u: i32, v: i32| 2000 + (3 * u - 2 * v) / 5 + (u - 340).pow(2) / 60 + (u ^ v) % 2;
        (0..64).map(at).map(|[u, v]| [u, v, height(u, v)]).collect()
    }

    #[test]
    fn every_cell_comes_back_and_shears_shrink_the_box() {
        for turn in 0..3 {
            let mut cells = slanted();
            cells.iter_mut().for_each(|cell| cell.rotate_left(turn));
            let boxed = ShearTransform::default().centred(&cells).unwrap();
            let [plain, bent] = [false, true].map(|is_bent| ShearTransform::of(&cells, is_bent));
            assert!(plain.volume() * 2 < boxed.volume(), "{plain:?}");
            assert!(bent.volume() * 2 < plain.volume(), "{bent:?}");
            for transform in [boxed, plain, bent] {
                let (size, bits) = transform.tuple();
                for tuple in cells.chunks(size) {
                    let number = transform.number(tuple);
                    assert!(number >> bits == 0);
                    let back = |at| transform.cell(number, at).map(|x| x as i32);
                    assert!(tuple.iter().enumerate().all(|(at, &cell)| back(at) == cell));
                }
            }
        }
    }

    #[test]
    fn one_cell_takes_no_bits_and_the_widest_blocks_fit() {
        let transform = ShearTransform::of(&[[7, 3, 1 << 18]; 3], true);
        assert_eq!((transform.bits(3), transform.cell(0, 2)), (0, [7, 3, 1 << 18]));
        let wide = [[0; 3], [MAX_CELLS - 1; 3], [0, MAX_CELLS - 1, 0]];
        let transform = ShearTransform::of(&wide, true);
        for cell in wide {
            assert_eq!(transform.cell(transform.number(&[cell]), 0), cell.map(i64::from));
        }
    }

    #[test]
    fn spans_increase_and_are_hardly_larger_than_needed() {
        assert!((0..u8::MAX).all(|code| span(code) < span(code + 1)));
        for cells in (1..2000).chain([1 << 16, 1 << 19]) {
            let found = span(span_code(cells).unwrap());
            assert!(found >= cells && found * 16 <= cells * 17 + 16, "{cells}: {found}");
        }
        assert_eq!(span_code((1 << 19) + 1), None);
    }
}
