//! From paths of faces to the vertices that draw them.

use meshlod_mesh::VertexId;

use crate::cover::{Cover, Port};
use crate::dual::{ends, next, previous};
use crate::strips::Strips;
use crate::verify::has_three_corners;

impl Cover {
    /// The strips of the paths, in the order of their first cells; `faces` are those the cover is of. Faces that
    /// repeat a vertex are left out.
    pub(crate) fn strips(&self, faces: &[[VertexId; 3]]) -> Strips {
        let mut strips = Strips::default();
        let mut drawn = vec![false; self.cells.len()];
        let mut strip = Vec::new();
        for cell in 0..self.cells.len() {
            if has_three_corners(&faces[cell]) && self.is_end(cell) && !drawn[cell] {
                let far = self.draw(faces, cell, &mut strip);
                drawn[far] = true;
                if self.better_end(cell, far) == far {
                    strip.clear();
                    self.draw(faces, far, &mut strip);
                }
                strips.push(strip.drain(..));
            }
        }
        strips
    }

    /// Which of the two ends of a path to draw it from, so that it costs least; the first, if either will do.
    pub(crate) fn better_end(&self, end: usize, far: usize) -> usize {
        if self.starts_odd(end) && !self.starts_odd(far) { far } else { end }
    }

    /// Whether a strip that starts at this end of a path has to say its first vertex twice.
    ///
    /// The second triangle drops the older of the two vertices it shares with the first, and so decides in which
    /// order they come; the winding of the first triangle may not agree with that order.
    pub(crate) fn starts_odd(&self, end: usize) -> bool {
        let entry = self.cells[end].links.first().map(|side| self.cells[end].across[side]);
        entry.is_some_and(|entry| self.turn(entry) == Some(Turn::Next))
    }

    /// Where the path that comes in through `entry` goes on; nowhere, if it ends there.
    #[inline]
    pub(crate) fn turn(&self, entry: Port) -> Option<Turn> {
        let onward = self.cells[entry.cell()].links.without(entry.side()).first()?;
        Some(if onward == next(entry.side()) { Turn::Next } else { Turn::Previous })
    }

    /// Puts the vertices of the path that ends in `end` behind those of `strip`, which are even in number. The other
    /// end of the path.
    pub(crate) fn draw(
        &self,
        faces: &[[VertexId; 3]],
        end: usize,
        strip: &mut Vec<VertexId>,
    ) -> usize {
        let face = &faces[end];
        let Some(side) = self.cells[end].links.first() else {
            strip.extend(face);
            return end;
        };
        let apex = face[previous(side)];
        let [mut older, mut newer] = ends(face, side);
        strip.push(apex);
        if self.starts_odd(end) {
            strip.push(apex);
            (older, newer) = (newer, older);
        }
        strip.extend([older, newer]);
        let mut entry = self.cells[end].across[side];
        loop {
            let face = &faces[entry.cell()];
            let found = face[previous(entry.side())];
            let Some(turn) = self.turn(entry) else {
                strip.push(found);
                return entry.cell();
            };
            // The older vertex is dropped, unless it is said once more: a swap.
            let pivot = ends(face, entry.side())[usize::from(turn == Turn::Next)];
            if pivot == older {
                strip.push(older);
            }
            strip.push(found);
            older = pivot;
            entry = self.cells[entry.cell()].across[turn.side(entry)];
        }
    }
}

/// Which side a path leaves a cell by.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Turn {
    /// The side after the one it came in by: it turns about the last vertex of that one.
    Next,
    /// The side before: it turns about the first vertex of that one.
    Previous,
}

impl Turn {
    /// The side it leaves by, having come in by `entry`.
    #[inline]
    pub(crate) fn side(self, entry: Port) -> usize {
        if self == Self::Next { next(entry.side()) } else { previous(entry.side()) }
    }

    #[inline]
    pub(crate) fn other(self) -> Self {
        if self == Self::Next { Self::Previous } else { Self::Next }
    }
}
