//! Properties of the RTIN.

mod cuts;
mod files;
mod levels;
mod meshes;
mod oracle;

use meshlod_mesh::{Mesh, VertexId};

use super::{HeightField, Rtin};
use crate::tests::walks::Dice;

/// Squares of 2ᵏ cells and other sizes.
const SIZES: [[u32; 2]; 9] =
    [[2, 2], [3, 3], [5, 5], [9, 9], [2, 9], [6, 4], [7, 12], [17, 11], [12, 17]];

/// A field as a mesh, with heights along an axis, faces that look along it or against it, and
/// random diagonals.
struct Sample {
    size: [u32; 2],
    up: usize,
    looks_down: bool,
    seed: u64,
}

impl Sample {
    fn new(size: [u32; 2]) -> Self {
        Self { size, up: 2, looks_down: false, seed: 7 }
    }

    /// Heights are multiples of 1/64 with a few plains, steps are 1 and 1/2.
    fn mesh(&self) -> Mesh {
        let [columns, rows] = self.size;
        let mut dice = Dice(self.seed);
        let mut mesh = Mesh::default();
        for row in 0..rows {
            for column in 0..columns {
                let height = (200.0 * dice.roll()).floor() / 64.0;
                let height = if (column / 4 + row / 4) % 3 == 1 { 1.0 } else { height };
                let mut point = [0.0; 3];
                point[(self.up + 1) % 3] = 10.0 + f64::from(column);
                point[(self.up + 2) % 3] = 0.5 * f64::from(row) - 3.0;
                point[self.up] = height;
                mesh.positions.push(point);
            }
        }
        for cell in (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |c| row * columns + c)) {
            let [a, b, c, d] = [cell, cell + 1, cell + columns + 1, cell + columns];
            let halves =
                if dice.roll() < 0.5 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            mesh.faces.extend(halves.map(|half| half.map(VertexId)));
        }
        if self.looks_down {
            mesh.faces.iter_mut().for_each(|face| face.swap(0, 1));
        }
        mesh
    }

    fn field(&self) -> HeightField {
        HeightField::from_mesh(&self.mesh()).unwrap()
    }

    fn model(&self) -> Rtin {
        Rtin::new(&self.field())
    }
}
