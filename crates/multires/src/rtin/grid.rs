//! Arithmetic of the hierarchy: which vertices and triangles exist, and what depends on what.
//!
//! The field lies in the corner of a square with 2ᵏ cells a side. Two triangles halve the square,
//! and each triangle is bisected from its right angle to the middle of its hypotenuse, down to half
//! cells.

use std::cmp::Ordering;

/// A vertex of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct GridPoint {
    pub(crate) column: u32,
    pub(crate) row: u32,
}

/// Half of a square, counter-clockwise where columns advance to the right and rows upwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RightTriangle {
    /// Vertex at the right angle, whose insertion created the triangle.
    pub(crate) apex: GridPoint,
    /// Ends of the hypotenuse. Inserting its midpoint removes the triangle.
    pub(crate) ends: [GridPoint; 2],
}

/// Triangles around a vertex at its insertion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Diamond {
    /// Ends of the hypotenuse with the vertex at its middle.
    pub(crate) ends: [GridPoint; 2],
    /// Right angles on both sides of the hypotenuse; only one at the side of the square.
    pub(crate) apexes: [Option<GridPoint>; 2],
}

/// Position of a triangle relative to the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    Inside,
    Across,
    Outside,
}

/// Size of a field, with at least two vertices each way and fewer than 2³¹ in all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grid {
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    /// Number of cells along a side of the square.
    pub(crate) side: u32,
}

impl Grid {
    /// Returns `None` if the number of vertices is out of range.
    pub(crate) fn new(columns: u32, rows: u32) -> Option<Self> {
        let count = columns.checked_mul(rows)?;
        let fits = columns >= 2 && rows >= 2 && count < 1 << 31;
        fits.then(|| Self { columns, rows, side: (columns.max(rows) - 1).next_power_of_two() })
    }

    pub(crate) fn count(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    #[inline]
    pub(crate) fn holds(&self, GridPoint { column, row }: GridPoint) -> bool {
        column < self.columns && row < self.rows
    }

    #[inline]
    pub(crate) fn index(&self, GridPoint { column, row }: GridPoint) -> usize {
        row as usize * self.columns as usize + column as usize
    }

    pub(crate) fn place(&self, index: usize) -> GridPoint {
        let index = index as u32;
        GridPoint { column: index % self.columns, row: index / self.columns }
    }

    /// Returns the number of bisections from the halves of the square to half cells.
    pub(crate) fn depth(&self) -> u32 {
        2 * self.side.ilog2()
    }

    /// Returns the halves of the square.
    pub(crate) fn roots(&self) -> [RightTriangle; 2] {
        let side = self.side;
        let at = |column, row| GridPoint { column, row };
        let ends = [at(side, side), at(0, 0)];
        [
            RightTriangle { apex: at(side, 0), ends },
            RightTriangle { apex: at(0, side), ends: [ends[1], ends[0]] },
        ]
    }

    /// Returns the triangles around a vertex at its insertion, or `None` at the corners of the
    /// square.
    #[inline]
    pub(crate) fn diamond(&self, place: GridPoint) -> Option<Diamond> {
        let GridPoint { column, row } = place;
        let any = column | row;
        let step = any & any.wrapping_neg();
        if any == 0 || step == self.side {
            return None;
        }
        let at = |column, row| GridPoint { column, row };
        if column & row & step != 0 {
            // In the middle of a cell of twice the step. Cells halved along the rising and along
            // the falling diagonal alternate as on a chessboard.
            let rising = [at(column - step, row - step), at(column + step, row + step)];
            let falling = [at(column + step, row - step), at(column - step, row + step)];
            let is_rising = (column ^ row) & (2 * step) == 0;
            let (ends, apexes) = if is_rising { (rising, falling) } else { (falling, rising) };
            return Some(Diamond { ends, apexes: apexes.map(Some) });
        }
        // In the middle of a side, between two cells or at the side of the square.
        let (across, along) = if column & step != 0 { (step, 0) } else { (0, step) };
        // The coordinate in which the apexes differ.
        let beside = if column & step != 0 { row } else { column };
        let before = at(column.wrapping_sub(along), row.wrapping_sub(across));
        let after = at(column + along, row + across);
        Some(Diamond {
            ends: [at(column - across, row - along), at(column + across, row + along)],
            apexes: [(beside > 0).then_some(before), (beside < self.side).then_some(after)],
        })
    }

    /// Returns the vertices of the field that a vertex depends on.
    #[inline]
    pub(crate) fn parents(&self, place: GridPoint) -> impl Iterator<Item = GridPoint> + use<> {
        let grid = *self;
        let apexes = self.diamond(place).map_or([None; 2], |diamond| diamond.apexes);
        apexes.into_iter().flatten().filter(move |&apex| grid.holds(apex))
    }

    /// Returns the vertices of the field that depend on a vertex: those in the middle of the
    /// hypotenuses of the triangles that it creates.
    #[inline]
    pub(crate) fn dependents(&self, place: GridPoint) -> impl Iterator<Item = GridPoint> + use<> {
        let grid = *self;
        let coarse = self.diamond(place).into_iter().flat_map(|diamond| diamond.coarse());
        let created = coarse.flat_map(|triangle| triangle.halves());
        let at = created.filter(|half| !half.is_finest()).map(|half| middle(half.ends));
        at.filter(move |&at| grid.holds(at))
    }

    /// Returns the number of bisections before a vertex is inserted, which must not be a corner of
    /// the square.
    pub(crate) fn depth_of(&self, GridPoint { column, row }: GridPoint) -> u32 {
        let finer = (column | row).trailing_zeros();
        let is_side = (column & row) >> finer & 1 == 0;
        self.depth() - 2 * (finer + 1) + u32::from(is_side)
    }

    /// Returns the number of triangles that an insertion adds, if none of them lies across the
    /// border.
    #[inline]
    pub(crate) fn created_faces(&self, GridPoint { column, row }: GridPoint) -> usize {
        let is_border =
            column == 0 || row == 0 || column + 1 == self.columns || row + 1 == self.rows;
        if is_border { 1 } else { 2 }
    }

    /// Returns the position of a triangle relative to the field.
    #[inline]
    pub(crate) fn extent(&self, triangle: &RightTriangle) -> Extent {
        let corners = triangle.corners();
        let [right, top] = [self.columns - 1, self.rows - 1];
        if corners.iter().all(|p| p.column <= right && p.row <= top) {
            return Extent::Inside;
        }
        // Two disjoint convex polygons are separated by a side of one of them: here by a side of
        // the field or a falling hypotenuse.
        let is_outside = corners.iter().all(|p| p.column >= right)
            || corners.iter().all(|p| p.row >= top)
            || corners.iter().all(|p| p.column + p.row >= right + top);
        if is_outside { Extent::Outside } else { Extent::Across }
    }

    /// Returns the vertices of the field inserted after `depth` bisections, row by row: middles of
    /// cells for even depths, middles of their sides for odd ones.
    pub(crate) fn inserted_at(&self, depth: u32) -> impl Iterator<Item = GridPoint> + use<> {
        let step = self.side >> (depth / 2 + 1);
        let is_side = depth % 2 == 1;
        let Self { columns, rows, .. } = *self;
        let first_row = if is_side { 0 } else { step };
        let between_rows = if is_side { step } else { 2 * step };
        (first_row..rows).step_by(between_rows as usize).flat_map(move |row| {
            let first = if is_side && row & step != 0 { 0 } else { step };
            let along = (first..columns).step_by(2 * step as usize);
            along.map(move |column| GridPoint { column, row })
        })
    }
}

impl Diamond {
    /// Returns the triangles that the insertion removes.
    pub(crate) fn coarse(&self) -> impl Iterator<Item = RightTriangle> + use<> {
        let [a, b] = self.ends;
        self.apexes.into_iter().flatten().map(move |apex| {
            let is_left = RightTriangle { apex, ends: [a, b] }.turn() > 0;
            RightTriangle { apex, ends: if is_left { [a, b] } else { [b, a] } }
        })
    }

    /// Returns all corners that exist.
    pub(crate) fn corners(&self) -> impl Iterator<Item = GridPoint> + use<> {
        self.ends.into_iter().chain(self.apexes.into_iter().flatten())
    }
}

impl RightTriangle {
    /// Returns the corners, the right angle first.
    #[inline]
    pub(crate) fn corners(&self) -> [GridPoint; 3] {
        [self.apex, self.ends[0], self.ends[1]]
    }

    /// Returns the two halves, with their right angles in the middle of the hypotenuse.
    #[inline]
    pub(crate) fn halves(&self) -> [Self; 2] {
        let (apex, [start, end]) = (middle(self.ends), self.ends);
        [Self { apex, ends: [self.apex, start] }, Self { apex, ends: [end, self.apex] }]
    }

    /// Returns true if it is half a cell, which is not bisected.
    #[inline]
    pub(crate) fn is_finest(&self) -> bool {
        (self.ends[0].column + self.ends[1].column) % 2 == 1
    }

    /// Returns the side of the right angle on which the hypotenuse lies, counter-clockwise from 0
    /// to 3: the triangles that one vertex creates have different ones.
    #[inline]
    pub(crate) fn side(&self) -> usize {
        let [a, b] = self.ends;
        let right =
            (u64::from(a.column) + u64::from(b.column)).cmp(&(2 * u64::from(self.apex.column)));
        let above = (u64::from(a.row) + u64::from(b.row)).cmp(&(2 * u64::from(self.apex.row)));
        match (right, above) {
            (Ordering::Greater, Ordering::Equal | Ordering::Greater) => 0,
            (Ordering::Less | Ordering::Equal, Ordering::Greater) => 1,
            (Ordering::Less, _) => 2,
            _ => 3,
        }
    }

    /// Returns twice the signed area, in cells.
    pub(crate) fn turn(&self) -> i64 {
        let from = |p: GridPoint| {
            let [column, row] = [p.column, p.row].map(i64::from);
            [column - i64::from(self.apex.column), row - i64::from(self.apex.row)]
        };
        let [[ax, ay], [bx, by]] = self.ends.map(from);
        ax * by - ay * bx
    }

    /// Returns the first and the last column within the triangle in a row that it meets.
    #[inline]
    pub(crate) fn columns(&self, row: u32) -> [u32; 2] {
        let [a, b, c] = self.corners();
        let (mut first, mut last) = (u32::MAX, 0);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let [low, high] = if from.row <= to.row { [from, to] } else { [to, from] };
            if row < low.row || row > high.row {
                continue;
            }
            // All sides are along rows, columns or diagonals.
            let up = row - low.row;
            let at = match low.column.cmp(&high.column) {
                _ if low.row == high.row => {
                    last = last.max(high.column);
                    first = first.min(high.column);
                    low.column
                }
                std::cmp::Ordering::Less => low.column + up,
                std::cmp::Ordering::Equal => low.column,
                std::cmp::Ordering::Greater => low.column - up,
            };
            first = first.min(at);
            last = last.max(at);
        }
        [first, last]
    }
}

/// Returns the midpoint.
#[inline]
pub(crate) fn middle([a, b]: [GridPoint; 2]) -> GridPoint {
    GridPoint { column: (a.column + b.column) / 2, row: (a.row + b.row) / 2 }
}
