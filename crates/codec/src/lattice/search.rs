//! Search for the shears and bends of a block.

pub(super) const SLOPE: i64 = 64;
/// Bits of slopes across a block, with sign; slopes along it are coarser.
pub(super) const SLOPE_BITS: u32 = 7;
pub(super) const COARSE_BITS: u32 = 5;
pub(super) const COARSE: i8 = 1 << (SLOPE_BITS - COARSE_BITS);
pub(super) const BEND: i64 = 64;
pub(super) const BEND_BITS: u32 = 6;
const MAX_SLOPE: i32 = (1 << (SLOPE_BITS - 1)) - 1;
const MAX_BEND: i32 = (1 << (BEND_BITS - 1)) - 1;

/// Search for slopes and bends, without rounding.
pub(super) struct Search {
    /// Coordinates along `u`, `v` and `w`, from about the middle on.
    cells: Vec<[f64; 3]>,
    /// Approximate half spans of `u` and `v`.
    half: [f64; 2],
    /// Four slopes and three bends.
    at: [i32; 7],
    is_bent: bool,
}

impl Search {
    pub(super) fn new(cells: &[[i32; 3]], axis: u8, is_bent: bool) -> Self {
        let (axes, centre) = (axes(axis), centre(cells));
        let away = |cell: &[i32; 3]| axes.map(|k| f64::from(cell[k] - centre[k]));
        let cells: Vec<_> = cells.iter().map(away).collect();
        let half = [0, 1].map(|k| cells.iter().fold(1.0, |most: f64, x| most.max(x[k].abs())));
        let mut this = Self { cells, half, at: [0; 7], is_bent };
        let [a, b] = this.plane().map(|slope| (slope * SLOPE as f64).round());
        // Steep or undefined planes are clamped: another axis does better.
        (this.at[2], this.at[3]) = (a as i32, b as i32);
        this.at = this.at.map(|x| x.clamp(-MAX_SLOPE, MAX_SLOPE));
        this
    }

    /// Fits a plane by least squares and returns its slopes.
    fn plane(&self) -> [f64; 2] {
        let mean =
            |k: usize| self.cells.iter().map(|x| x[k]).sum::<f64>() / self.cells.len() as f64;
        let mean = [mean(0), mean(1), mean(2)];
        let product = |i: usize, j: usize| {
            self.cells.iter().map(|x| (x[i] - mean[i]) * (x[j] - mean[j])).sum::<f64>()
        };
        let (uu, uv, vv) = (product(0, 0), product(0, 1), product(1, 1));
        let (uw, vw) = (product(0, 2), product(1, 2));
        let det = uu * vv - uv * uv;
        if det > 1e-9 * uu * vv {
            [(uw * vv - vw * uv) / det, (vw * uu - uw * uv) / det]
        } else {
            [if uu > 0.0 { uw / uu } else { 0.0 }, 0.0]
        }
    }

    /// Changes one parameter at a time as long as the volume shrinks.
    pub(super) fn best(mut self) -> Self {
        let mut smallest = self.volume();
        for step in [16, 8, 4, 2, 1, 2, 1] {
            for number in 0..if self.is_bent { 7 } else { 4 } {
                let least_step = if number < 2 { i32::from(COARSE) } else { 1 };
                let by = step.max(least_step);
                for by in [-by, by] {
                    let was = self.at[number];
                    let most = if number < 4 { MAX_SLOPE } else { MAX_BEND };
                    let most = most / least_step * least_step;
                    self.at[number] = (was + by).clamp(-most, most);
                    let volume = self.volume();
                    if volume < smallest {
                        smallest = volume;
                    } else {
                        self.at[number] = was;
                    }
                }
            }
        }
        self
    }

    fn volume(&self) -> f64 {
        let [s, r, a, b] = [0, 1, 2, 3].map(|k| f64::from(self.at[k]) / SLOPE as f64);
        let bend = |k: usize, half: f64| f64::from(self.at[k]) / (BEND as f64 * 2.0 * half);
        let [uu, uv, vv] = [bend(4, self.half[0]), bend(5, self.half[0]), bend(6, self.half[1])];
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &[u, v, w] in &self.cells {
            let w = w - a * u - b * v - u * (uu * u + uv * v) - vv * v * v;
            let u = u - s * v;
            for (k, x) in [u, v - r * u, w].into_iter().enumerate() {
                low[k] = low[k].min(x);
                high[k] = high[k].max(x);
            }
        }
        (0..3).map(|k| high[k] - low[k] + 1.0).product()
    }

    pub(super) fn slopes(&self) -> [i8; 4] {
        [0, 1, 2, 3].map(|k| self.at[k] as i8)
    }

    pub(super) fn bends(&self) -> [i8; 3] {
        [4, 5, 6].map(|k| self.at[k] as i8)
    }
}

/// Returns the axes `u`, `v` and `w`, given the flattened one.
pub(super) fn axes(flattened: u8) -> [usize; 3] {
    let axis = usize::from(flattened);
    [(axis + 1) % 3, (axis + 2) % 3, axis % 3]
}

/// Returns the middle of the bounding box, rounded up.
pub(super) fn centre(cells: &[[i32; 3]]) -> [i32; 3] {
    [0, 1, 2].map(|k| {
        let along = cells.iter().map(|cell| cell[k]);
        let [low, high] = [along.clone().min(), along.max()].map(|end| end.unwrap_or(0));
        high - (high - low) / 2
    })
}
