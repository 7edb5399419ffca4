//! Checks that triangle strips draw the triangles they should.

use meshlod_mesh::VertexId;

use crate::strips::Strips;

/// Difference between the triangles that strips draw and those of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Difference {
    /// Number of triangles of the mesh that the strips do not draw.
    pub missing: usize,
    /// Number of triangles that the strips draw but the mesh does not have, or not as often.
    pub extra: usize,
}

/// Compares the triangles that `strips` draw with `faces`, as multisets of triangles up to
/// rotation.
///
/// Faces that repeat a vertex are ignored. Cost: O(n log n).
pub fn difference(strips: &Strips, faces: &[[VertexId; 3]]) -> Difference {
    let wanted = sorted(faces.iter().copied().filter(has_three_corners));
    let drawn = sorted(strips.triangles());
    let (mut w, mut d, mut both) = (0, 0, 0);
    while w < wanted.len() && d < drawn.len() {
        let order = wanted[w].cmp(&drawn[d]);
        w += usize::from(order.is_le());
        d += usize::from(order.is_ge());
        both += usize::from(order.is_eq());
    }
    Difference { missing: wanted.len() - both, extra: drawn.len() - both }
}

/// Sorts triangles, each rotated to begin with its lowest vertex.
fn sorted(triangles: impl Iterator<Item = [VertexId; 3]>) -> Vec<[VertexId; 3]> {
    let mut triangles: Vec<_> = triangles.map(lowest_first).collect();
    triangles.sort_unstable();
    triangles
}

/// Returns whether a face has three distinct vertices.
pub(crate) fn has_three_corners([a, b, c]: &[VertexId; 3]) -> bool {
    a != b && b != c && c != a
}

/// Rotates a triangle to begin with its lowest vertex.
pub(crate) fn lowest_first([a, b, c]: [VertexId; 3]) -> [VertexId; 3] {
    let lowest = a.min(b).min(c);
    if lowest == a {
        [a, b, c]
    } else if lowest == b {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_and_doubled_triangles_are_seen() {
        let faces = [[0, 1, 2], [2, 1, 3], [5, 5, 6]].map(|face: [u32; 3]| face.map(VertexId));
        let drawing = |vertices: &[u32]| {
            let mut strips = Strips::default();
            strips.push(vertices.iter().copied().map(VertexId));
            difference(&strips, &faces)
        };
        assert_eq!(drawing(&[0, 1, 2, 3]), Difference::default());
        assert_eq!(drawing(&[0, 0, 1, 2, 3]), Difference { missing: 2, extra: 2 }, "turned");
        assert_eq!(drawing(&[0, 1, 2]), Difference { missing: 1, extra: 0 });
        assert_eq!(
            drawing(&[0, 1, 2, 0, 1]),
            Difference { missing: 1, extra: 2 },
            "drawn three times"
        );
    }
}
