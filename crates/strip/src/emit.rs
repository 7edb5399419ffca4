//! Turns paths of faces into vertex sequences.

use meshlod_mesh::VertexId;

use crate::dual::{ends, next, previous};
use crate::dual_node::DualEdge;
use crate::path_cover::PathCover;
use crate::strips::Strips;
use crate::verify::has_three_corners;

impl PathCover {
    /// Builds the strips of the paths, in the order of their first nodes; `faces` are the faces of
    /// the cover. Faces that repeat a vertex are left out.
    pub(crate) fn strips(&self, faces: &[[VertexId; 3]]) -> Strips {
        let mut strips = Strips::default();
        let mut drawn = vec![false; self.nodes.len()];
        let mut strip = Vec::new();
        for node in 0..self.nodes.len() {
            if has_three_corners(&faces[node]) && self.is_end(node) && !drawn[node] {
                let far = self.draw(faces, node, &mut strip);
                drawn[far] = true;
                if self.better_end(node, far) == far {
                    strip.clear();
                    self.draw(faces, far, &mut strip);
                }
                strips.push(strip.drain(..));
            }
        }
        strips
    }

    /// Appends the strip of the path through a node to `strip`, which must be empty, as
    /// [`strips`](Self::strips) draws it. Returns an end of the path.
    pub(crate) fn draw_through(
        &self,
        faces: &[[VertexId; 3]],
        node: usize,
        strip: &mut Vec<VertexId>,
    ) -> usize {
        let end = self.end_of(node);
        let other = self.path(end).last().map_or(end, |(other, _)| other);
        let (first, last) = (end.min(other), end.max(other));
        self.draw(faces, self.better_end(first, last), strip);
        end
    }

    /// Returns the end from which a path is cheaper to draw, `end` if both cost the same.
    pub(crate) fn better_end(&self, end: usize, far: usize) -> usize {
        if self.starts_odd(end) && !self.starts_odd(far) { far } else { end }
    }

    /// Returns whether a strip that starts at this end of a path must double its first vertex.
    ///
    /// The second triangle drops the older of the two vertices it shares with the first, and so
    /// decides their order, which may not agree with the winding of the first triangle.
    pub(crate) fn starts_odd(&self, end: usize) -> bool {
        let entry = self.nodes[end].links.first().map(|side| self.nodes[end].across[side]);
        entry.is_some_and(|entry| self.turn(entry) == Some(Turn::Next))
    }

    /// Returns the turn of the path that enters by `entry`, `None` if it ends there.
    #[inline]
    pub(crate) fn turn(&self, entry: DualEdge) -> Option<Turn> {
        let onward = self.nodes[entry.node()].links.without(entry.side()).first()?;
        Some(if onward == next(entry.side()) { Turn::Next } else { Turn::Previous })
    }

    /// Appends the vertices of the path that ends at `end` to `strip`, whose length must be even.
    /// Returns the other end of the path.
    pub(crate) fn draw(
        &self,
        faces: &[[VertexId; 3]],
        end: usize,
        strip: &mut Vec<VertexId>,
    ) -> usize {
        let face = &faces[end];
        let Some(side) = self.nodes[end].links.first() else {
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
        let mut entry = self.nodes[end].across[side];
        loop {
            let face = &faces[entry.node()];
            let found = face[previous(entry.side())];
            let Some(turn) = self.turn(entry) else {
                strip.push(found);
                return entry.node();
            };
            // The older vertex is dropped unless it is repeated, which is a swap.
            let pivot = ends(face, entry.side())[usize::from(turn == Turn::Next)];
            if pivot == older {
                strip.push(older);
            }
            strip.push(found);
            older = pivot;
            entry = self.nodes[entry.node()].across[turn.side(entry)];
        }
    }
}

/// Direction in which a path leaves a node, relative to the side it entered by.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Turn {
    /// By the next side, about the last vertex of the entry side.
    Next,
    /// By the previous side, about the first vertex of the entry side.
    Previous,
}

impl Turn {
    /// Returns the side of departure for an entry.
    #[inline]
    pub(crate) fn side(self, entry: DualEdge) -> usize {
        if self == Self::Next { next(entry.side()) } else { previous(entry.side()) }
    }

    #[inline]
    pub(crate) fn other(self) -> Self {
        if self == Self::Next { Self::Previous } else { Self::Next }
    }
}
