//! Triangle strips built by meshoptimizer.

use meshlod::mesh::VertexId;
use meshlod::strip::Strips;
use meshopt::{optimize_vertex_cache_strip, stripify};

/// Builds triangle strips by meshoptimizer, with the faces in its vertex cache order for strips.
///
/// # Panics
/// If the library refuses its own order.
pub fn meshopt_strips(faces: &[[VertexId; 3]]) -> Strips {
    const RESTART: u32 = u32::MAX;
    let indices: Vec<u32> = faces.iter().flatten().map(|v| v.0).collect();
    let mut strips = Strips::default();
    let Some(most) = indices.iter().max() else { return strips };
    let count = *most as usize + 1;
    let ordered = optimize_vertex_cache_strip(&indices, count);
    let sequence = stripify(&ordered, count, RESTART).expect("indices are in range");
    for strip in sequence.split(|&index| index == RESTART) {
        strips.push(strip.iter().copied().map(VertexId));
    }
    strips
}

#[cfg(test)]
mod tests {
    use meshlod::samples;
    use meshlod::strip::{Difference, difference};

    use super::*;

    #[test]
    fn they_draw_the_faces() {
        let faces = samples::torus(500).faces;
        assert_eq!(difference(&meshopt_strips(&faces), &faces), Difference::default());
        assert!(meshopt_strips(&[]).is_empty());
    }
}
