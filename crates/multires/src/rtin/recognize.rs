//! Recognition of meshes that are height fields.

use std::cmp::Ordering;

use meshlod_mesh::{FaceId, Mesh, MeshError, VertexId};
use thiserror::Error;

use super::bytes::MAX_COORDINATE;
use super::field::{Fit, GridPlacement, HeightField};
use super::grid::{Grid, GridPoint};

/// Reason why a mesh cannot be read as a height field.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum HeightFieldError {
    /// The mesh is invalid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The vertices of the mesh do not line up in columns and rows along any axis.
    #[error(
        "the mesh is not a height field: seen along {axis}, its {vertices} vertices lie in {columns} columns \
         and {rows} rows; use contractions (`Forest`), which take any mesh"
    )]
    NoGrid {
        /// Axis along which the vertices come closest to a grid.
        axis: char,
        /// Number of columns seen along the axis.
        columns: usize,
        /// Number of rows seen along the axis.
        rows: usize,
        /// Number of vertices that faces use.
        vertices: usize,
    },
    /// A vertex is off the regular grid of the others.
    #[error(
        "{vertex} at {position:?} is {by:.3} steps off column {column}, row {row}: the spacing is not regular"
    )]
    OffGrid {
        /// The vertex that is off the grid.
        vertex: VertexId,
        /// Position of the vertex, in model units.
        position: [f64; 3],
        /// Grid column nearest to the vertex.
        column: u32,
        /// Grid row nearest to the vertex.
        row: u32,
        /// Distance of the vertex from the grid point, in columns or in rows, whichever is more.
        by: f64,
    },
    /// Two vertices are at the same grid point.
    #[error("{first} and {second} are both at column {column}, row {row}: weld them or remove one")]
    SamePoint {
        /// One of the two vertices.
        first: VertexId,
        /// The other of the two vertices.
        second: VertexId,
        /// Grid column of both vertices.
        column: u32,
        /// Grid row of both vertices.
        row: u32,
    },
    /// A grid point has no vertex.
    #[error(
        "the grid has a hole: no vertex at column {column}, row {row}, near {near:?}; fill it first"
    )]
    Hole {
        /// Grid column of the empty point.
        column: u32,
        /// Grid row of the empty point.
        row: u32,
        /// Position of the empty point in model units, with height 0.
        near: [f64; 3],
    },
    /// A face is not half of a grid cell.
    #[error("{0} is not half of a grid cell")]
    NotHalfCell(FaceId),
    /// A face is oriented against the first face of the mesh.
    #[error("{0} is oriented against {first}", first = FaceId(0))]
    FlippedFace(FaceId),
    /// A grid cell is not covered by two triangles that halve it.
    #[error(
        "the cell at column {column}, row {row} is not covered by its two halves: faces in it: {faces}"
    )]
    Cell {
        /// Grid column at which the cell starts.
        column: u32,
        /// Grid row at which the cell starts.
        row: u32,
        /// Number of faces in the cell.
        faces: usize,
    },
    /// The grid has too many points, or its coordinates are too large.
    #[error(
        "the grid is too large: at most 2^31 - 1 vertices with coordinates below 1e150 are supported"
    )]
    TooLarge,
}

/// Largest offset of a vertex from the grid, in steps. In a grid of metres a hundred kilometres
/// from the origin, rounding to `f32` moves coordinates by up to 0.004.
const MAX_OFFSET: f64 = 0.01;

impl HeightField {
    /// Builds a height field from a mesh whose vertices form a full grid of columns and rows seen
    /// along a coordinate axis, in any order, and whose faces halve the cells along either
    /// diagonal.
    ///
    /// The spacing may vary by a hundredth of a step, as rounded coordinates do; the points of the
    /// field are regular. Attributes and unused vertices are dropped.
    ///
    /// Cost: sorting the vertices.
    /// # Errors
    /// The first deviation found, with its place.
    pub fn from_mesh(mesh: &Mesh) -> Result<Self, HeightFieldError> {
        mesh.validate()?;
        let bounds = mesh.bounds();
        if bounds.min.iter().chain(&bounds.max).any(|x| x.abs() > MAX_COORDINATE)
            && !bounds.is_empty()
        {
            return Err(HeightFieldError::TooLarge);
        }
        let used = mesh.used_vertices();
        let ids: Vec<u32> = (0..used.len() as u32).filter(|&v| used[v as usize]).collect();
        let lines = [0, 1, 2].map(|axis| Lines::of(mesh, &ids, axis));
        let likely = |up: u8| {
            let [across, along, _] = GridPlacement::axes(up);
            let beside = lines[across].beside.max(lines[along].beside).max(MAX_OFFSET);
            (beside, (lines[across].count * lines[along].count).abs_diff(ids.len()))
        };
        let mut axes = [2, 1, 0];
        axes.sort_by(|&a, &b| likely(a).partial_cmp(&likely(b)).unwrap_or(Ordering::Equal));
        // If all axes fail, the error along the likeliest one is returned.
        let mut found =
            axes.into_iter().map(|up| FieldReader { mesh, ids: &ids, lines: &lines, up }.read());
        let first = found.next().expect("there are three");
        if first.is_ok() { first } else { found.find(Result::is_ok).unwrap_or(first) }
    }
}

/// Regular lines, columns or rows, fitted to coordinates.
#[derive(Clone, Copy, Debug)]
struct Lines {
    count: usize,
    first: f64,
    step: f64,
    /// Greatest offset of a coordinate from its line, in steps.
    beside: f64,
}

impl Lines {
    /// Gaps of more than half the greatest one separate lines.
    fn of(mesh: &Mesh, ids: &[u32], axis: usize) -> Self {
        let mut coordinates: Vec<f64> =
            ids.iter().map(|&v| mesh.positions[v as usize][axis]).collect();
        coordinates.sort_unstable_by(f64::total_cmp);
        let gaps = || coordinates.windows(2).map(|pair| pair[1] - pair[0]);
        let widest = gaps().fold(0.0, f64::max);
        let between = gaps().filter(|&gap| gap > 0.5 * widest).count();
        let [first, last] =
            [coordinates.first(), coordinates.last()].map(|x| x.copied().unwrap_or(0.0));
        let step = (last - first) / between.max(1) as f64;
        let beside = |x: &f64| {
            let steps = (x - first) / step;
            (steps - steps.round()).abs()
        };
        let beside = coordinates.iter().map(beside).fold(0.0, f64::max);
        Self { count: between + 1, first, step, beside }
    }
}

/// Reads a mesh as a height field along one axis.
struct FieldReader<'m> {
    mesh: &'m Mesh,
    ids: &'m [u32],
    lines: &'m [Lines; 3],
    up: u8,
}

impl FieldReader<'_> {
    fn read(&self) -> Result<HeightField, HeightFieldError> {
        let [across, along, up] = GridPlacement::axes(self.up);
        let (columns, rows) = (self.lines[across].count, self.lines[along].count);
        let (points, vertices) = (columns * rows, self.ids.len());
        if columns < 2 || rows < 2 || points < vertices / 2 || points / 2 > vertices {
            let axis = ['x', 'y', 'z'][up];
            return Err(HeightFieldError::NoGrid { axis, columns, rows, vertices });
        }
        let grid = u32::try_from(columns).ok().zip(u32::try_from(rows).ok());
        let grid = grid.and_then(|(columns, rows)| Grid::new(columns, rows));
        let grid = grid.ok_or(HeightFieldError::TooLarge)?;
        let [x, y] = [self.lines[across], self.lines[along]];
        let mut placement = GridPlacement {
            up: self.up,
            looks_down: false,
            origin: [x.first, y.first],
            step: [x.step, y.step],
        };
        let (at, moved) = self.place(&grid, &placement)?;
        let missing = at.iter().position(Option::is_none);
        if let Some(place) = missing.map(|index| grid.place(index)) {
            let near = placement.point(place, 0.0).into();
            return Err(HeightFieldError::Hole { column: place.column, row: place.row, near });
        }
        let height = |v: &Option<VertexId>| v.map_or(0.0, |v| self.mesh.positions[v.index()][up]);
        let heights: Vec<f64> = at.iter().map(height).collect();
        let cells = Cells::of(self.mesh, &grid, &at)?;
        placement.looks_down = cells.look_down;
        let turned = cells.turned(&grid, &heights)?;
        Ok(HeightField { grid, placement, heights, fit: Fit { moved, turned, rounded: 0.0 } })
    }

    /// Returns the vertex at each grid point and the greatest offset.
    fn place(
        &self,
        grid: &Grid,
        placement: &GridPlacement,
    ) -> Result<(Vec<Option<VertexId>>, f64), HeightFieldError> {
        let [across, along, _] = GridPlacement::axes(self.up);
        let mut at = vec![None; grid.count()];
        let mut moved = 0f64;
        for vertex in self.ids.iter().map(|&v| VertexId(v)) {
            let position = self.mesh.positions[vertex.index()];
            let steps = [across, along]
                .map(|axis| (position[axis] - self.lines[axis].first) / self.lines[axis].step);
            let by = steps.map(|x| (x - x.round()).abs());
            let by = by[0].max(by[1]);
            let [column, row] = steps.map(|x| x.round() as u32);
            if by > MAX_OFFSET {
                return Err(HeightFieldError::OffGrid { vertex, position, column, row, by });
            }
            let place = GridPoint { column, row };
            let exact = placement.point(place, 0.0).to_array();
            let off = [across, along].map(|axis| position[axis] - exact[axis]);
            moved = moved.max(off[0].hypot(off[1]));
            if let Some(first) = at[grid.index(place)].replace(vertex) {
                return Err(HeightFieldError::SamePoint { first, second: vertex, column, row });
            }
        }
        Ok((at, moved))
    }
}

/// Faces by grid cell.
struct Cells {
    /// A bit per cell corner left out by one of its faces: 1 and 2 in the first row, 4 and 8 in the
    /// second.
    left_out: Vec<u8>,
    /// Number of faces of each cell.
    faces: Vec<u8>,
    look_down: bool,
}

impl Cells {
    fn of(mesh: &Mesh, grid: &Grid, at: &[Option<VertexId>]) -> Result<Self, HeightFieldError> {
        let mut points = vec![GridPoint::default(); mesh.positions.len()];
        for (index, vertex) in at.iter().enumerate() {
            vertex.iter().for_each(|v| points[v.index()] = grid.place(index));
        }
        let mut left_out = vec![0; grid.count()];
        let mut faces = vec![0u8; grid.count()];
        let mut look_down = None;
        for (f, face) in mesh.faces.iter().enumerate() {
            let id = FaceId::new(f);
            let corners = face.map(|v| points[v.index()]);
            let half = Half::of(corners).ok_or(HeightFieldError::NotHalfCell(id))?;
            if *look_down.get_or_insert(half.looks_down) != half.looks_down {
                return Err(HeightFieldError::FlippedFace(id));
            }
            let cell = grid.index(half.cell);
            left_out[cell] |= 1 << half.left_out;
            faces[cell] = faces[cell].saturating_add(1);
        }
        Ok(Self { left_out, faces, look_down: look_down == Some(true) })
    }

    /// Returns the greatest change of height in the middle of a cell whose diagonal is flipped.
    fn turned(&self, grid: &Grid, heights: &[f64]) -> Result<f64, HeightFieldError> {
        let mut most = 0f64;
        for row in 0..grid.rows - 1 {
            for column in 0..grid.columns - 1 {
                let cell = grid.index(GridPoint { column, row });
                let faces = usize::from(self.faces[cell]);
                // The two halves leave out the ends of the other diagonal.
                let is_falling = match (self.left_out[cell], faces) {
                    (0b1001, 2) => true,
                    (0b0110, 2) => false,
                    _ => return Err(HeightFieldError::Cell { column, row, faces }),
                };
                if is_falling == ((column + row) % 2 == 0) {
                    let above = cell + grid.columns as usize;
                    let rising = heights[cell] + heights[above + 1];
                    let falling = heights[cell + 1] + heights[above];
                    most = most.max(0.5 * (rising - falling).abs());
                }
            }
        }
        Ok(most)
    }
}

/// A face as half of a cell.
struct Half {
    /// First corner of the cell.
    cell: GridPoint,
    /// Corner of the cell that the face leaves out: 0 and 1 in the first row, 2 and 3 in the
    /// second.
    left_out: u32,
    looks_down: bool,
}

impl Half {
    fn of(corners: [GridPoint; 3]) -> Option<Self> {
        let cell = GridPoint {
            column: corners.iter().map(|p| p.column).min()?,
            row: corners.iter().map(|p| p.row).min()?,
        };
        let mut there = 0u32;
        let mut numbers = [0; 3];
        for (number, corner) in numbers.iter_mut().zip(corners) {
            let [right, up] = [corner.column - cell.column, corner.row - cell.row];
            if right > 1 || up > 1 {
                return None;
            }
            *number = 2 * up + right;
            there |= 1 << *number;
        }
        // Three distinct corners.
        (there.count_ones() == 3).then(|| {
            let around = numbers.map(|n| [0, 1, 3, 2][n as usize]);
            let [second, third] = [1, 2].map(|k| (around[k] + 4 - around[0]) % 4);
            let left_out = (!there & 0b1111).trailing_zeros();
            Self { cell, left_out, looks_down: third < second }
        })
    }
}
