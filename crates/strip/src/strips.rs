//! Triangle strips: vertex sequences in which every three consecutive vertices form a triangle.

use meshlod_mesh::{VertexId, strip_triangles};

/// A list of triangle strips.
///
/// Every window of three vertices of a strip is a triangle; windows at odd positions have their
/// first two vertices exchanged, so that the winding is kept. A window that repeats a vertex draws
/// nothing. So a swap is a repeated vertex, and a strip that must begin with an odd triangle
/// repeats its first vertex.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Strips {
    vertices: Vec<VertexId>,
    /// End of each strip in `vertices`.
    ends: Vec<u32>,
}

impl Strips {
    /// Appends a triangle strip, given by its vertices; an empty one is ignored.
    pub fn push(&mut self, strip: impl IntoIterator<Item = VertexId>) {
        let start = self.vertices.len();
        self.vertices.extend(strip);
        if self.vertices.len() > start {
            self.ends.push(
                u32::try_from(self.vertices.len()).expect("strips hold fewer than 2^32 vertices"),
            );
        }
    }

    /// Returns the number of triangle strips in the list.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Returns true if the list has no triangle strips.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Returns the vertices of all strips, one strip after the other.
    pub fn vertices(&self) -> &[VertexId] {
        &self.vertices
    }

    /// Iterates over the strips, each as the sequence of its vertices.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[VertexId]> {
        let start = |strip: usize| if strip == 0 { 0 } else { self.ends[strip - 1] as usize };
        (0..self.ends.len())
            .map(move |strip| &self.vertices[start(strip)..self.ends[strip] as usize])
    }

    /// Iterates over the triangles that the strips draw, in drawing order and with their winding.
    pub fn triangles(&self) -> impl Iterator<Item = [VertexId; 3]> {
        self.iter().flat_map(strip_triangles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_second_triangle_is_turned_and_repeated_vertices_draw_nothing() {
        let mut strips = Strips::default();
        strips.push([0, 1, 2, 3].map(VertexId));
        strips.push([]);
        strips.push([4, 4, 5, 6].map(VertexId));
        let drawn: Vec<_> = strips.triangles().map(|t| t.map(|v| v.0)).collect();
        assert_eq!(drawn, [[0, 1, 2], [2, 1, 3], [5, 4, 6]]);
        assert_eq!(strips.len(), 2);
        assert_eq!(strips.vertices().len(), 8);
    }
}
