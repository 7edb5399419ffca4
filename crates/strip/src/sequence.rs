//! Index sequences that draw all triangle strips in one call.

use meshlod_mesh::VertexId;

use crate::measure::starts_odd;
use crate::strips::Strips;

impl Strips {
    /// Index that ends a triangle strip when 32-bit indices are drawn with primitive restart.
    pub const RESTART: u32 = u32::MAX;

    /// Returns the indices of all strips for one draw call, with [`Strips::RESTART`] between
    /// strips.
    pub fn with_restarts(&self) -> Vec<u32> {
        let mut indices = Vec::with_capacity(self.vertices().len() + self.len());
        for strip in self.iter() {
            if !indices.is_empty() {
                indices.push(Self::RESTART);
            }
            indices.extend(strip.iter().map(|vertex| vertex.0));
        }
        indices
    }

    /// Joins all strips into one by degenerate triangles, for use without primitive restart.
    ///
    /// Each joint costs two vertices, or three if the next strip would be turned.
    pub fn stitched(&self) -> Vec<VertexId> {
        let mut sequence: Vec<VertexId> =
            Vec::with_capacity(self.vertices().len() + 3 * self.len());
        for strip in self.iter() {
            let Some(&last) = sequence.last() else {
                sequence.extend(strip);
                continue;
            };
            // A strip that doubles its first vertex for parity may start at an odd position
            // instead.
            let odd = usize::from(starts_odd(strip));
            sequence.extend([last, strip[odd]]);
            if sequence.len() % 2 != odd {
                sequence.push(strip[odd]);
            }
            sequence.extend(&strip[odd..]);
        }
        sequence
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::{Difference, difference};

    fn three() -> Strips {
        let mut strips = Strips::default();
        for strip in [&[0, 1, 2, 3][..], &[4, 4, 5, 6, 7], &[8, 9, 10]] {
            strips.push(strip.iter().copied().map(VertexId));
        }
        strips
    }

    #[test]
    fn one_strip_draws_what_all_draw() {
        let triangles: Vec<_> = three().triangles().collect();
        let mut one = Strips::default();
        one.push(three().stitched());
        assert_eq!(difference(&one, &triangles), Difference::default());
        assert_eq!(one.vertices().len(), 4 + (3 + 4) + (3 + 3));
    }

    #[test]
    fn restarts_stand_between_strips_only() {
        let r = Strips::RESTART;
        assert_eq!(three().with_restarts(), [0, 1, 2, 3, r, 4, 4, 5, 6, 7, r, 8, 9, 10]);
        assert_eq!(Strips::default().with_restarts(), [0u32; 0]);
    }
}
