//! Which vertices and triangles there are and what needs what, by arithmetic of places alone.
//!
//! The field lies in the corner of a square with 2ᵏ cells a side. Two triangles halve the square, and
//! each triangle is halved from its right angle to the middle of its hypotenuse, down to half cells.

/// A place on the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct GridPoint {
    pub(crate) column: u32,
    pub(crate) row: u32,
}

/// Half of a square, counter-clockwise where columns go to the right and rows up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RightTriangle {
    /// At the right angle. Its insertion made the triangle.
    pub(crate) apex: GridPoint,
    /// The hypotenuse. What is inserted at its middle takes the triangle away.
    pub(crate) ends: [GridPoint; 2],
}

/// What lies around a vertex when it is inserted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Diamond {
    /// Of the hypotenuse in whose middle it is.
    pub(crate) ends: [GridPoint; 2],
    /// Of the triangles on both sides of that; one on the side of the square.
    pub(crate) apexes: [Option<GridPoint>; 2],
}

/// How much of a triangle lies in the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    Inside,
    Across,
    Outside,
}

/// A field of so many vertices, at least two each way and less than 2³¹ in all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grid {
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    /// The number of cells along a side of the square.
    pub(crate) side: u32,
}

impl Grid {
    /// None for more or fewer vertices than can be numbered.
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

    /// How often the halves of the square are halved until they are half cells.
    pub(crate) fn depth(&self) -> u32 {
        2 * self.side.ilog2()
    }

    /// The halves of the square.
    pub(crate) fn roots(&self) -> [RightTriangle; 2] {
        let side = self.side;
        let at = |column, row| GridPoint { column, row };
        let ends = [at(side, side), at(0, 0)];
        [
            RightTriangle { apex: at(side, 0), ends },
            RightTriangle { apex: at(0, side), ends: [ends[1], ends[0]] },
        ]
    }

    /// What lies around a vertex when it is inserted; none at the corners of the square.
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
            // In the middle of a cell of twice the step. Those halved along the rising diagonal and
            // along the falling one take turns, as on a chessboard.
            let rising = [at(column - step, row - step), at(column + step, row + step)];
            let falling = [at(column + step, row - step), at(column - step, row + step)];
            let is_rising = (column ^ row) & (2 * step) == 0;
            let (ends, apexes) = if is_rising { (rising, falling) } else { (falling, rising) };
            return Some(Diamond { ends, apexes: apexes.map(Some) });
        }
        // In the middle of a side, between two cells or at the side of the square.
        let (across, along) = if column & step != 0 { (step, 0) } else { (0, step) };
        // Where the apexes differ.
        let beside = if column & step != 0 { row } else { column };
        let before = at(column.wrapping_sub(along), row.wrapping_sub(across));
        let after = at(column + along, row + across);
        Some(Diamond {
            ends: [at(column - across, row - along), at(column + across, row + along)],
            apexes: [(beside > 0).then_some(before), (beside < self.side).then_some(after)],
        })
    }

    /// The vertices of the field that a vertex needs.
    #[inline]
    pub(crate) fn parents(&self, place: GridPoint) -> impl Iterator<Item = GridPoint> + use<> {
        let grid = *self;
        let apexes = self.diamond(place).map_or([None; 2], |diamond| diamond.apexes);
        apexes.into_iter().flatten().filter(move |&apex| grid.holds(apex))
    }

    /// How many halvings come before a vertex is inserted, which must not be a corner of the square.
    pub(crate) fn depth_of(&self, GridPoint { column, row }: GridPoint) -> u32 {
        let finer = (column | row).trailing_zeros();
        let is_side = (column & row) >> finer & 1 == 0;
        self.depth() - 2 * (finer + 1) + u32::from(is_side)
    }

    /// How many triangles more there are with a vertex that nothing across the border is at.
    #[inline]
    pub(crate) fn created_faces(&self, GridPoint { column, row }: GridPoint) -> usize {
        let is_border =
            column == 0 || row == 0 || column + 1 == self.columns || row + 1 == self.rows;
        if is_border { 1 } else { 2 }
    }

    /// How much of a triangle lies in the field.
    #[inline]
    pub(crate) fn extent(&self, triangle: &RightTriangle) -> Extent {
        let corners = triangle.corners();
        let [right, top] = [self.columns - 1, self.rows - 1];
        if corners.iter().all(|p| p.column <= right && p.row <= top) {
            return Extent::Inside;
        }
        // Between two convex sets that do not overlap is a side of one of them: here one of the field's,
        // or a falling hypotenuse.
        let is_outside = corners.iter().all(|p| p.column >= right)
            || corners.iter().all(|p| p.row >= top)
            || corners.iter().all(|p| p.column + p.row >= right + top);
        if is_outside { Extent::Outside } else { Extent::Across }
    }

    /// The vertices of the field that are inserted after so many halvings, row by row: middles of
    /// cells for even numbers, of their sides for odd ones.
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
    /// The triangles that an insertion takes away.
    pub(crate) fn coarse(&self) -> impl Iterator<Item = RightTriangle> + use<> {
        let [a, b] = self.ends;
        self.apexes.into_iter().flatten().map(move |apex| {
            let is_left = RightTriangle { apex, ends: [a, b] }.turn() > 0;
            RightTriangle { apex, ends: if is_left { [a, b] } else { [b, a] } }
        })
    }

    /// All its corners that are there.
    pub(crate) fn corners(&self) -> impl Iterator<Item = GridPoint> + use<> {
        self.ends.into_iter().chain(self.apexes.into_iter().flatten())
    }
}

impl RightTriangle {
    /// The right angle first.
    #[inline]
    pub(crate) fn corners(&self) -> [GridPoint; 3] {
        [self.apex, self.ends[0], self.ends[1]]
    }

    /// Twice its area, in cells.
    pub(crate) fn turn(&self) -> i64 {
        let from = |p: GridPoint| {
            let [column, row] = [p.column, p.row].map(i64::from);
            [column - i64::from(self.apex.column), row - i64::from(self.apex.row)]
        };
        let [[ax, ay], [bx, by]] = self.ends.map(from);
        ax * by - ay * bx
    }

    /// The first and the last of its columns in a row, which must meet it.
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

/// Half the way.
#[inline]
pub(crate) fn middle([a, b]: [GridPoint; 2]) -> GridPoint {
    GridPoint { column: (a.column + b.column) / 2, row: (a.row + b.row) / 2 }
}
