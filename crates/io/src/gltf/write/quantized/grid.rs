//! Grid that the positions of a mesh are quantized to.

use meshlod_mesh::Bounds;

/// Uniform grid that the positions of a mesh are quantized to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct QuantizationGrid {
    /// Corner of the first cell, representable in `f32`.
    pub origin: [f64; 3],
    /// Side of a cell, representable in `f32`.
    pub cell: f64,
    /// Largest cell index per axis.
    pub most: u16,
}

impl QuantizationGrid {
    /// Builds the grid with that many bits over the points; `None` if it is not representable in
    /// `f32`.
    pub fn over<'a>(points: impl Iterator<Item = &'a [f64; 3]>, bits: u32) -> Option<Self> {
        let bounds = Bounds::of(points);
        let origin = bounds.min.map(|x| f64::from(rounded_down(x)));
        let longest = (0..3).map(|axis| bounds.max[axis] - origin[axis]).fold(0.0, f64::max);
        let most = ((1u32 << bits) - 1) as u16;
        // Rounded up, so that the farthest point is still inside the grid.
        let cell = -f64::from(rounded_down(-longest / f64::from(most)));
        let cell = if longest == 0.0 { 1.0 } else { cell };
        let sound = origin.iter().all(|x| x.abs() <= f64::from(f32::MAX))
            && (f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX)).contains(&cell);
        sound.then_some(Self { origin, cell, most })
    }

    /// Returns the grid cell nearest to a point, as an index per axis.
    pub fn quantized(&self, point: [f64; 3]) -> [u16; 3] {
        let most = f64::from(self.most);
        std::array::from_fn(|axis| {
            ((point[axis] - self.origin[axis]) / self.cell).round().clamp(0.0, most) as u16
        })
    }

    /// Returns the point that a grid cell stands for, in model units.
    pub fn place(&self, cell: [u16; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| self.origin[axis] + f64::from(cell[axis]) * self.cell)
    }
}

/// Returns the largest `f32` not above `x`.
fn rounded_down(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_at_most_half_a_cell_away_on_each_axis() {
        let points = [[-1.0, 2.0, 1e6], [0.3, 2.1, 1e6 + 7.0], [0.1, 2.05, 1e6 + 3.3]];
        for bits in [1, 8, 11, 16] {
            let grid = QuantizationGrid::over(points.iter(), bits).unwrap();
            assert!(f64::from(grid.cell as f32) == grid.cell);
            for point in points {
                let place = grid.place(grid.quantized(point));
                for axis in 0..3 {
                    let off = (place[axis] - point[axis]).abs();
                    assert!(off <= 0.5 * grid.cell * (1.0 + 1e-9), "{bits} bits: {off}");
                }
            }
        }
    }

    #[test]
    fn what_no_node_can_scale_has_no_grid() {
        let of = |points: &[[f64; 3]]| QuantizationGrid::over(points.iter(), 1);
        assert!(of(&[[0.0; 3], [1e-60, 0.0, 0.0]]).is_none());
        assert!(of(&[[-3e38, 0.0, 0.0], [3e38, 0.0, 0.0]]).is_none());
        assert!(of(&[[1e39, 0.0, 0.0]]).is_none());
        assert_eq!(of(&[[3.0; 3]]).map(|grid| grid.place([0; 3])), Some([3.0; 3]));
    }
}
