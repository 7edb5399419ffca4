//! Where the nodes are: anywhere, in 12 bytes each, or on a lattice of 65,536 cells a side, in 6.

/// The place of each node, in stored units.
#[derive(Clone, Debug)]
pub(super) enum Places {
    Free(Vec<[f32; 3]>),
    Cells {
        /// The side of a cell.
        side: f32,
        cells: Vec<[i16; 3]>,
    },
}

/// What every place on a lattice is a multiple of, at the finest: as far out as nodes are, `f32` holds
/// each of them.
const STEP: f32 = 1.0 / (1 << 23) as f32;

impl Places {
    #[inline]
    pub(super) fn at(&self, node: u32) -> [f32; 3] {
        match self {
            Self::Free(places) => places[node as usize],
            // Exact: it is the number that it was made of.
            Self::Cells { side, cells } => cells[node as usize].map(|x| f32::from(x) * side),
        }
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Self::Free(places) => places.len(),
            Self::Cells { cells, .. } => cells.len(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Free(places) => size_of_val(&places[..]),
            Self::Cells { cells, .. } => size_of_val(&cells[..]),
        }
    }

    /// The same on the coarsest lattice that has all of them; `None` where that has too many cells.
    pub(super) fn narrowed(&self) -> Option<Self> {
        let Self::Free(places) = self else { return Some(self.clone()) };
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
        Some(Self::Cells { side, cells: cells.collect::<Option<_>>()? })
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
    fn what_lies_on_a_lattice_comes_back_exactly() {
        let places = vec![[0.75, -0.375, 0.0], [-0.1875, 0.5625, 12.0 * STEP]];
        let narrow = Places::Free(places.clone()).narrowed();
        assert!(narrow.is_none(), "12 steps and three quarters are too far apart");
        let places = vec![[0.75, -0.375, 0.0], [-0.1875, 0.5625, 1200.0 * 48.0 * STEP]];
        let narrow = Places::Free(places.clone()).narrowed().unwrap();
        assert_eq!(narrow.bytes(), 12);
        assert_eq!([0, 1].map(|node| narrow.at(node)).to_vec(), places);
    }

    #[test]
    fn what_lies_on_none_stays_as_it_is() {
        for x in [0.1 * STEP, 3.0, f32::NAN, f32::INFINITY] {
            assert!(Places::Free(vec![[0.0, x, 0.5]]).narrowed().is_none(), "{x}");
        }
        let nowhere = Places::Free(vec![[0.0; 3]]).narrowed().unwrap();
        assert_eq!(nowhere.at(0), [0.0; 3]);
    }
}
