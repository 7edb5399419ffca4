//! Positions of the nodes: arbitrary in 12 bytes each, or on a lattice of 65,536 cells a side in 6.

/// Position of each node, in stored units.
#[derive(Clone, Debug)]
pub(super) enum StoredPositions {
    Float(Vec<[f32; 3]>),
    Lattice {
        /// Side of a lattice cell.
        side: f32,
        cells: Vec<[i16; 3]>,
    },
}

/// Finest lattice step: `f32` is exact for its multiples as far out as nodes are.
const STEP: f32 = 1.0 / (1 << 23) as f32;

impl StoredPositions {
    #[inline]
    pub(super) fn at(&self, node: u32) -> [f32; 3] {
        match self {
            Self::Float(places) => places[node as usize],
            // Exact: the product is the number that was divided.
            Self::Lattice { side, cells } => cells[node as usize].map(|x| f32::from(x) * side),
        }
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Self::Float(places) => places.len(),
            Self::Lattice { cells, .. } => cells.len(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Float(places) => size_of_val(&places[..]),
            Self::Lattice { cells, .. } => size_of_val(&cells[..]),
        }
    }

    /// Returns the positions on the coarsest lattice that contains them all, or `None` if that has
    /// too many cells.
    pub(super) fn compacted(&self) -> Option<Self> {
        let Self::Float(places) = self else { return Some(self.clone()) };
        let mut side = 0u32;
        for &x in places.iter().flatten() {
            let steps = x / STEP;
            if steps.fract() != 0.0 || steps.abs() > (1 << 24) as f32 {
                return None;
            }
            side = greatest_common_divisor(side, steps.abs() as u32);
        }
        let side = side.max(1) as f32 * STEP;
        let cell = |x: f32| {
            let cell = x / side;
            (i16::MIN as f32..=i16::MAX as f32).contains(&cell).then_some(cell as i16)
        };
        let cells = places.iter().map(|&[x, y, z]| Some([cell(x)?, cell(y)?, cell(z)?]));
        Some(Self::Lattice { side, cells: cells.collect::<Option<_>>()? })
    }
}

fn greatest_common_divisor(mut a: u32, mut b: u32) -> u32 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattice_positions_come_back_exactly() {
        let places = vec![[0.75, -0.375, 0.0], [-0.1875, 0.5625, 12.0 * STEP]];
        let compact = StoredPositions::Float(places.clone()).compacted();
        assert!(compact.is_none(), "12 steps and three quarters are too far apart");
        let places = vec![[0.75, -0.375, 0.0], [-0.1875, 0.5625, 1200.0 * 48.0 * STEP]];
        let compact = StoredPositions::Float(places.clone()).compacted().unwrap();
        assert_eq!(compact.bytes(), 12);
        assert_eq!([0, 1].map(|node| compact.at(node)).to_vec(), places);
    }

    #[test]
    fn positions_off_any_lattice_are_not_compacted() {
        for x in [0.1 * STEP, 3.0, f32::NAN, f32::INFINITY] {
            assert!(StoredPositions::Float(vec![[0.0, x, 0.5]]).compacted().is_none(), "{x}");
        }
        let nowhere = StoredPositions::Float(vec![[0.0; 3]]).compacted().unwrap();
        assert_eq!(nowhere.at(0), [0.0; 3]);
    }
}
