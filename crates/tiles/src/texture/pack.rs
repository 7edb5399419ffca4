//! Rectangles of texels, joined where that takes no more room, and packed on shelves.

/// Rectangle of texels, from the upper left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rectangle {
    /// Least x and y.
    pub low: [u32; 2],
    /// Greatest x and y, beyond the last texel.
    pub high: [u32; 2],
}

/// Rectangles side by side.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Packing {
    /// Width and height of all.
    pub size: [u32; 2],
    /// Place of the upper left of each.
    pub at: Vec<[u32; 2]>,
}

impl Rectangle {
    /// Returns the width and height.
    pub fn size(&self) -> [u32; 2] {
        [0, 1].map(|axis| self.high[axis] - self.low[axis])
    }

    fn union(&self, other: &Self) -> Self {
        Self {
            low: [0, 1].map(|axis| self.low[axis].min(other.low[axis])),
            high: [0, 1].map(|axis| self.high[axis].max(other.high[axis])),
        }
    }

    /// Returns the number of texels with a gutter on each side.
    fn area(&self, gutter: u32) -> u64 {
        self.size().into_iter().map(|side| u64::from(side + 2 * gutter)).product()
    }
}

/// Joins rectangles for as long as two of them take no less room than one around both. Returns the
/// rectangles that are left, and for each of the given ones which of these it is in.
///
/// Cost: a pass compares all pairs that overlap in x; a few passes are usual.
pub(super) fn join(rectangles: &[Rectangle], gutter: u32) -> (Vec<Rectangle>, Vec<usize>) {
    let mut left: Vec<Rectangle> = rectangles.to_vec();
    let mut of: Vec<usize> = (0..left.len()).collect();
    loop {
        let (next, moved) = join_once(&left, gutter);
        if next.len() == left.len() {
            return (left, of);
        }
        of.iter_mut().for_each(|index| *index = moved[*index]);
        left = next;
    }
}

/// Joins each rectangle with those after it, by their left sides, that are worth it.
fn join_once(rectangles: &[Rectangle], gutter: u32) -> (Vec<Rectangle>, Vec<usize>) {
    let mut order: Vec<usize> = (0..rectangles.len()).collect();
    order.sort_by_key(|&i| (rectangles[i].low, rectangles[i].high, i));
    let mut into: Vec<Option<usize>> = vec![None; rectangles.len()];
    let mut left = Vec::new();
    for first in 0..order.len() {
        if into[order[first]].is_some() {
            continue;
        }
        into[order[first]] = Some(left.len());
        let mut around = rectangles[order[first]];
        for &other in &order[first + 1..] {
            let next = rectangles[other];
            if next.low[0] > around.high[0] + 2 * gutter {
                break;
            }
            let union = around.union(&next);
            let apart = around.area(gutter) + next.area(gutter);
            if into[other].is_none() && union.area(gutter) <= apart {
                into[other] = Some(left.len());
                around = union;
            }
        }
        left.push(around);
    }
    (left, into.into_iter().flatten().collect())
}

/// Packs rectangles of these sizes on shelves, the highest first, in about a square.
pub(super) fn pack(sizes: &[[u32; 2]]) -> Packing {
    let area: u64 = sizes.iter().map(|&[width, height]| u64::from(width) * u64::from(height)).sum();
    let widest = sizes.iter().map(|size| size[0]).max().unwrap_or(0);
    let width = widest.max(area.isqrt() as u32);
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by_key(|&i| (std::cmp::Reverse([sizes[i][1], sizes[i][0]]), i));
    let mut packing = Packing { size: [0; 2], at: vec![[0; 2]; sizes.len()] };
    let (mut x, mut y, mut shelf) = (0, 0, 0);
    for i in order {
        let [wide, high] = sizes[i];
        if x > 0 && x + wide > width {
            (x, y) = (0, y + shelf);
        }
        if x == 0 {
            shelf = high;
        }
        packing.at[i] = [x, y];
        x += wide;
        packing.size = [packing.size[0].max(x), y + shelf];
    }
    packing
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn rectangle([left, top, width, height]: [u32; 4]) -> Rectangle {
        Rectangle { low: [left, top], high: [left + width, top + height] }
    }

    #[test]
    fn what_is_inside_or_nearly_so_is_joined() {
        let some = [[0, 0, 50, 50], [100, 0, 9, 9], [10, 10, 5, 5], [50, 0, 3, 50]].map(rectangle);
        let (left, of) = join(&some, 2);
        assert_eq!(left, [[0, 0, 53, 50], [100, 0, 9, 9]].map(rectangle));
        assert_eq!(of, [0, 1, 0, 0]);
    }

    #[test]
    fn a_cross_stays_two() {
        let cross = [[0, 45, 100, 10], [45, 0, 10, 100]].map(rectangle);
        assert_eq!(join(&cross, 2).0.len(), 2);
    }

    proptest! {
        #[test]
        fn joined_ones_hold_all_and_take_no_more_room(
            some in prop::collection::vec([0u32..300, 0u32..300, 1u32..90, 1u32..90], 0..40),
        ) {
            let some: Vec<Rectangle> = some.into_iter().map(rectangle).collect();
            let (left, of) = join(&some, 2);
            for (own, &of) in some.iter().zip(&of) {
                prop_assert_eq!(own.union(&left[of]), left[of]);
            }
            let area = |all: &[Rectangle]| all.iter().map(|own| own.area(2)).sum::<u64>();
            prop_assert!(area(&left) <= area(&some));
        }

        #[test]
        fn packed_ones_do_not_overlap(
            sizes in prop::collection::vec([1u32..90, 1u32..90], 0..60),
        ) {
            let packing = pack(&sizes);
            let mut is_taken = vec![false; packing.size.iter().map(|&side| side as usize).product()];
            for (&[width, height], at) in sizes.iter().zip(&packing.at) {
                for (x, y) in (at[1]..at[1] + height)
                    .flat_map(|y| (at[0]..at[0] + width).map(move |x| (x, y)))
                {
                    prop_assert!(x < packing.size[0] && y < packing.size[1]);
                    let texel = &mut is_taken[(y * packing.size[0] + x) as usize];
                    prop_assert!(!std::mem::replace(texel, true), "({x}, {y})");
                }
            }
        }
    }
}
