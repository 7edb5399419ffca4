//! Faces that lie side by side brought near each other in memory.

use crate::cover::{Cell, Cover, Port};

/// The faces of a mesh in the order of their distance, in faces, from one of them.
pub(crate) struct Order {
    /// The faces, first to last.
    pub(crate) faces: Vec<u32>,
    /// The most faces that are at one distance.
    pub(crate) widest: usize,
}

impl Order {
    /// Breadth first from the first face of each component.
    ///
    /// A run of this order that is longer than `widest` has neighbours only in the runs before and after.
    pub(crate) fn new(cover: &Cover) -> Self {
        let count = cover.cells.len();
        let mut faces = Vec::with_capacity(count);
        let mut reached = vec![false; count];
        let mut widest = 0;
        for first in 0..count {
            if std::mem::replace(&mut reached[first], true) {
                continue;
            }
            let mut ring = faces.len();
            faces.push(first as u32);
            while ring < faces.len() {
                let next = faces.len();
                widest = widest.max(next - ring);
                for at in ring..next {
                    for port in cover.cells[faces[at] as usize].across {
                        if !port.is_none() && !std::mem::replace(&mut reached[port.cell()], true) {
                            faces.push(port.cell() as u32);
                        }
                    }
                }
                ring = next;
            }
        }
        Self { faces, widest }
    }

    /// The things that belong to the faces, in this order.
    pub(crate) fn sorted<T: Copy>(&self, things: &[T]) -> Vec<T> {
        self.faces.iter().map(|&face| things[face as usize]).collect()
    }

    /// The cover of the faces in this order.
    pub(crate) fn sort(&self, cover: &Cover) -> Cover {
        let mut place = vec![0; self.faces.len()];
        for (at, &face) in self.faces.iter().enumerate() {
            place[face as usize] = at as u32;
        }
        let moved = |port: Port| match port.is_none() {
            true => port,
            false => Port::new(place[port.cell()] as usize, port.side()),
        };
        let cell = |cell: Cell| Cell { across: cell.across.map(moved), ..cell };
        Cover { cells: self.sorted(&cover.cells).into_iter().map(cell).collect() }
    }
}
