//! Shape quality of triangles.

use glam::DVec3;
use meshlod_mesh::Mesh;
use meshlod_spatial::CompensatedSum;

/// Number of bins of the triangle quality histogram.
pub const QUALITY_BINS: usize = 10;

/// Quality at or below which a triangle's area is only rounding error.
const DEGENERATE: f64 = 1e-15;

/// Statistics of the shape quality of triangles: 1 for an equilateral triangle, 0 for a degenerate
/// one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Quality {
    /// Number of triangles with a quality below 0.1, from 0.1 to 0.2 and so on; the last bin
    /// includes 1.
    pub histogram: [usize; QUALITY_BINS],
    /// Lowest quality of any triangle.
    pub min: f64,
    /// Mean quality of all triangles.
    pub mean: f64,
    /// Number of degenerate triangles, whose area is zero up to rounding. The histogram includes
    /// them.
    pub degenerate: usize,
}

/// Computes shape quality statistics of all triangles; `None` for a mesh without faces.
///
/// Indices must be in range and positions finite. Cost: O(faces).
pub fn quality(mesh: &Mesh) -> Option<Quality> {
    if mesh.faces.is_empty() {
        return None;
    }
    let mut all = Quality { histogram: [0; QUALITY_BINS], min: 1.0, mean: 0.0, degenerate: 0 };
    let mut sum = CompensatedSum::default();
    for &face in &mesh.faces {
        let quality = triangle_quality(mesh.triangle(face));
        let bin = (quality * QUALITY_BINS as f64) as usize;
        all.histogram[bin.min(QUALITY_BINS - 1)] += 1;
        all.min = all.min.min(quality);
        all.degenerate += usize::from(quality <= DEGENERATE);
        sum.add(quality);
    }
    all.mean = sum.value() / mesh.faces.len() as f64;
    Some(all)
}

/// Returns 4√3 times the area over the sum of the squared edge lengths, in [0, 1].
fn triangle_quality([a, b, c]: [DVec3; 3]) -> f64 {
    // Halved first, then scaled to size 1, so that no finite triangle overflows.
    let [a, b, c] = [a * 0.5, b * 0.5, c * 0.5];
    let edges = [b - a, c - b, a - c];
    let size = edges.iter().map(|edge| edge.abs().max_element()).fold(0.0, f64::max);
    if size == 0.0 {
        return 0.0;
    }
    let [ab, bc, ca] = edges.map(|edge| edge / size);
    let squares = ab.length_squared() + bc.length_squared() + ca.length_squared();
    (2.0 * 3f64.sqrt() * ab.cross(ca).length() / squares).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{cube, plane, scaled};

    #[test]
    fn equilateral_is_best_and_flat_is_worst() {
        let third = DVec3::new(0.5, 0.75f64.sqrt(), 0.0);
        assert!(triangle_quality([DVec3::ZERO, DVec3::X, third]) > 1.0 - 1e-15);
        assert_eq!(triangle_quality([DVec3::ZERO, DVec3::X, DVec3::X * 0.5]), 0.0);
        assert_eq!(triangle_quality([DVec3::Y; 3]), 0.0);
    }

    #[test]
    fn half_squares_are_all_alike_at_any_size() {
        let half_square = 3f64.sqrt() / 2.0;
        for size in [1e-300, 1.0, 1e308] {
            let quality = quality(&scaled(&cube(), size)).unwrap();
            assert_eq!((quality.histogram[8], quality.degenerate), (12, 0));
            assert!((quality.min - half_square).abs() < 1e-15);
            assert!((quality.mean - half_square).abs() < 1e-15);
        }
    }

    #[test]
    fn degenerate_faces_are_counted() {
        let mut mesh = plane(2, 0.0);
        mesh.faces[3][1] = mesh.faces[3][0];
        let quality = quality(&mesh).unwrap();
        assert_eq!((quality.degenerate, quality.min, quality.histogram[0]), (1, 0.0, 1));
    }

    #[test]
    fn no_faces_have_no_quality() {
        assert_eq!(quality(&Mesh::default()), None);
    }
}
