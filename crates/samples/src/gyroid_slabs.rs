//! Gyroid of any size, slab by slab.

use std::convert::Infallible;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};

use crate::gyroid::LEVEL;
use crate::tetrahedra::{FieldLattice, Slab, march};

/// Cells of a period, about: enough for round tubes.
const CELLS: f64 = 24.0;
/// Faces are near `cells² * (INSIDE * periods³ + CAPS * periods²)`, where `cells` are those of a
/// period: fitted at 2 to 12 periods of 17 to 25 cells.
const INSIDE: f64 = 27.0;
const CAPS: f64 = 19.5;

/// One of the two labyrinths of the gyroid inside a cube of whole periods: a closed, connected
/// surface, for meshes that are larger than memory.
///
/// It differs from [`gyroid`](crate::gyroid()): that one has three periods of ever smaller faces in a
/// ball, and keeps only its largest piece. Here more faces mean more periods. The labyrinth is cut
/// where a period begins, which leaves one piece at any size, and the edges of the cuts are sharp.
///
/// Memory: about 100 bytes for each of the cells of two layers, 300 MB at 2,000,000,000 faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GyroidSlabs {
    periods: usize,
    /// Cells of a period.
    cells: usize,
}

impl GyroidSlabs {
    /// Creates the gyroid of about this many faces, within 10 % from 200,000 on; at least two
    /// periods of 12 cells.
    pub fn new(faces: usize) -> Self {
        let of_period = INSIDE * CELLS * CELLS;
        let periods = (faces as f64 / of_period).cbrt().round().max(2.0);
        let of_cell = INSIDE * periods.powi(3) + CAPS * periods.powi(2);
        let cells = (faces as f64 / of_cell).sqrt().round().max(12.0);
        Self { periods: periods as usize, cells: cells as usize }
    }

    /// Creates the gyroid of this many periods, each of at least eight `cells`: the fewer there are,
    /// the fewer faces it has for the same tunnels.
    pub fn with_periods(periods: usize, cells: usize) -> Self {
        Self { periods: periods.max(1), cells: cells.max(8) }
    }

    /// Counts the vertices and faces, which takes a pass over all cells.
    pub fn sizes(self) -> [u64; 2] {
        let mut sizes = [0, 0];
        let counted = self.march(false, |slab| {
            sizes[0] += u64::from(slab.vertices);
            sizes[1] += slab.faces.len() as u64;
            ControlFlow::<Infallible>::Continue(())
        });
        match counted {
            ControlFlow::Continue(()) => sizes,
        }
    }

    /// Hands on all vertices, some at a time, until an error.
    ///
    /// # Errors
    /// Errors of `take`.
    pub fn places<E>(self, mut take: impl FnMut(&[[f64; 3]]) -> Result<(), E>) -> Result<(), E> {
        result(self.march(true, |slab| control(take(&slab.places))))
    }

    /// Hands on all faces, some at a time, until an error.
    ///
    /// # Errors
    /// Errors of `take`.
    pub fn faces<E>(self, mut take: impl FnMut(&[[u32; 3]]) -> Result<(), E>) -> Result<(), E> {
        result(self.march(false, |slab| control(take(&slab.faces))))
    }

    /// Builds the whole mesh.
    pub fn mesh(self) -> Mesh {
        let mut mesh = Mesh::default();
        let places: Result<(), Infallible> = self.places(|some| {
            mesh.positions.extend(some);
            Ok(())
        });
        let faces: Result<(), Infallible> = self.faces(|some| {
            mesh.faces.extend(some.iter().map(|face| face.map(VertexId)));
            Ok(())
        });
        match (places, faces) {
            (Ok(()), Ok(())) => mesh,
        }
    }

    /// Goes through all slabs; their vertices have places if they are wanted.
    fn march<B>(
        self,
        wants_places: bool,
        take: impl FnMut(&Slab) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let cells = self.periods * self.cells + 1;
        // Half a cell is left free on all sides.
        let half = 1.0 - 1.0 / cells as f64;
        let scale = TAU * self.periods as f64 / (2.0 * half);
        let waves = |p: f64| ((p + half) * scale).sin_cos();
        let labyrinth = |[(sx, cx), (sy, cy), (sz, cz)]: [(f64, f64); 3]| {
            (sx * cy + sy * cz + sz * cx - LEVEL) / (1.4 * scale)
        };
        let in_box = |p: DVec3, field: f64| field.max(p.abs().max_element() - half);
        let table: Vec<(f64, f64)> =
            (0..=cells).map(|i| waves(crate::tetrahedra::coordinate(cells, i))).collect();
        let lattice = FieldLattice {
            cells,
            value: |point: [usize; 3], p| in_box(p, labyrinth(point.map(|i| table[i]))),
            field: |p: DVec3| in_box(p, labyrinth(p.to_array().map(waves))),
        };
        march(&lattice, wants_places, take)
    }
}

fn control<E>(result: Result<(), E>) -> ControlFlow<E> {
    match result {
        Ok(()) => ControlFlow::Continue(()),
        Err(error) => ControlFlow::Break(error),
    }
}

fn result<E>(flow: ControlFlow<E>) -> Result<(), E> {
    match flow {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(error) => Err(error),
    }
}
