//! Statistics of triangle strips.

use std::collections::VecDeque;

use meshlod_mesh::{VertexId, strip_triangles};

use crate::strips::Strips;

/// Statistics of triangle strips: the vertices and indices they send, and how well a vertex cache
/// serves them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StripStatistics {
    /// Number of triangles that the strips draw.
    pub triangles: usize,
    /// Number of vertices sent if each strip is drawn by a call of its own.
    pub vertices_sent: usize,
    /// Number of indices sent if all strips are drawn by one call with primitive restarts between
    /// them.
    pub indices_with_restart: usize,
    /// Number of indices sent if all strips are drawn by one call with degenerate triangles between
    /// them.
    pub indices_stitched: usize,
    /// Number of triangle strips.
    pub strips: usize,
    /// Number of degenerate triangles inside strips, one for each swap.
    pub swaps: usize,
    /// Number of strips that double their first vertex to start with the right winding.
    pub odd_starts: usize,
    /// Vertices transformed per triangle with a first-in, first-out cache of 16 entries; 0 without
    /// triangles.
    pub acmr16: f64,
    /// Vertices transformed per triangle with a first-in, first-out cache of 32 entries; 0 without
    /// triangles.
    pub acmr32: f64,
}

impl StripStatistics {
    /// Measures a list of triangle strips.
    ///
    /// Cost: linear, with 48 comparisons per vertex.
    pub fn new(strips: &Strips) -> Self {
        let triangles = strips.triangles().count();
        let nothing =
            |strip: &[VertexId]| strip.len().saturating_sub(2) - strip_triangles(strip).count();
        let odd_starts = strips.iter().filter(|strip| starts_odd(strip)).count();
        Self {
            triangles,
            vertices_sent: strips.vertices().len(),
            indices_with_restart: strips.vertices().len() + strips.len().saturating_sub(1),
            indices_stitched: strips.stitched().len(),
            strips: strips.len(),
            swaps: strips.iter().map(nothing).sum::<usize>() - odd_starts,
            odd_starts,
            acmr16: acmr(strips, 16),
            acmr32: acmr(strips, 32),
        }
    }
}

/// Returns whether a strip doubles its first vertex.
pub(crate) fn starts_odd(strip: &[VertexId]) -> bool {
    strip.len() > 2 && strip[0] == strip[1]
}

/// Returns the average cache miss ratio of strips: vertices transformed per triangle with a
/// first-in, first-out cache of `entries` vertices.
///
/// It is 0 without triangles.
pub fn acmr(strips: &Strips, entries: usize) -> f64 {
    let mut cache = VecDeque::new();
    let mut misses = 0_usize;
    for vertex in strips.vertices() {
        if !cache.contains(vertex) {
            misses += 1;
            cache.push_back(*vertex);
            if cache.len() > entries {
                cache.pop_front();
            }
        }
    }
    misses as f64 / strips.triangles().count().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_swaps_and_odd_starts_are_told_apart() {
        let mut strips = Strips::default();
        strips.push([0, 1, 2, 1, 3].map(VertexId));
        strips.push([4, 4, 5, 6].map(VertexId));
        let expected = StripStatistics {
            triangles: 3,
            vertices_sent: 9,
            indices_with_restart: 10,
            indices_stitched: 10,
            strips: 2,
            swaps: 1,
            odd_starts: 1,
            acmr16: 7.0 / 3.0,
            acmr32: 7.0 / 3.0,
        };
        assert_eq!(StripStatistics::new(&strips), expected);
    }

    #[test]
    fn what_came_first_goes_first() {
        let mut strips = Strips::default();
        strips.push([0, 1, 2, 0, 3, 0].map(VertexId));
        // With three entries 0 is still cached when it is repeated, but 3 evicts it all the same.
        let triangles = strips.triangles().count() as f64;
        assert_eq!(acmr(&strips, 3) * triangles, 5.0);
        assert_eq!(acmr(&strips, 4) * triangles, 4.0);
        assert_eq!(acmr(&Strips::default(), 16), 0.0);
    }
}
