//! Meshes of balls and capsules.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::Vec3;
use meshlod::mesh::{Mesh, VertexId};

/// Points around a capsule, and steps from a pole to the equator.
const AROUND: u32 = 48;
const STEPS: u32 = 12;

/// Builds the surface of all points within `radius` of a segment: a closed mesh that faces outwards.
///
/// A segment without length gives a ball.
pub(super) fn capsule([bottom, top]: [Vec3; 2], radius: f32) -> Mesh {
    let axis = (top - bottom).try_normalize().unwrap_or(Vec3::Y);
    let (side, other) = axis.any_orthonormal_pair();
    // Rings of the lower half and then of the upper one; the equator comes twice, once for each
    // end of the segment.
    let rings: Vec<(Vec3, f32)> = (1..=STEPS)
        .map(|step| (bottom, step as f32 / STEPS as f32 - 1.0))
        .chain((0..STEPS).map(|step| (top, step as f32 / STEPS as f32)))
        .collect();
    let mut positions = vec![bottom - axis * radius];
    for &(center, latitude) in &rings {
        let (height, width) = (latitude * FRAC_PI_2).sin_cos();
        positions.extend((0..AROUND).map(|i| {
            let (sin, cos) = (i as f32 / AROUND as f32 * TAU).sin_cos();
            center + radius * (axis * height + (side * cos + other * sin) * width)
        }));
    }
    positions.push(top + axis * radius);
    Mesh::new(
        positions.iter().map(|p| p.as_dvec3().to_array()).collect(),
        faces(rings.len() as u32),
    )
}

/// Returns the faces of a pole, rings of [`AROUND`] vertices, and another pole.
fn faces(rings: u32) -> Vec<[VertexId; 3]> {
    let vertex = |ring: u32, i: u32| VertexId(1 + ring * AROUND + i % AROUND);
    let (first, last) = (VertexId(0), VertexId(1 + rings * AROUND));
    let mut faces = Vec::new();
    for i in 0..AROUND {
        faces.push([first, vertex(0, i + 1), vertex(0, i)]);
        for ring in 0..rings - 1 {
            let [a, b] = [vertex(ring, i), vertex(ring, i + 1)];
            let [c, d] = [vertex(ring + 1, i), vertex(ring + 1, i + 1)];
            faces.extend([[a, b, d], [a, d, c]]);
        }
        faces.push([last, vertex(rings - 1, i), vertex(rings - 1, i + 1)]);
    }
    faces
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use meshlod::mesh::Connectivity;

    use super::*;

    #[test]
    fn capsules_are_closed_and_have_their_volume() {
        let ends = [Vec3::new(1.0, -2.0, 0.5), Vec3::new(2.0, 3.0, -1.0)];
        for (ends, length) in [(ends, ends[0].distance(ends[1])), ([Vec3::ONE; 2], 0.0)] {
            let mesh = capsule(ends, 0.8);
            mesh.validate().unwrap();
            let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
            assert!(connectivity.is_closed() && connectivity.inconsistent_edges() == 0);
            let tetrahedron = |&face: &[VertexId; 3]| {
                let [a, b, c] = mesh.triangle(face);
                DVec3::dot(a, b.cross(c)) / 6.0
            };
            let volume: f64 = mesh.faces.iter().map(tetrahedron).sum();
            let exact = f64::from(TAU / 2.0 * 0.64 * (length + 0.8 * 4.0 / 3.0));
            assert!((volume / exact - 1.0).abs() < 0.02, "{volume} of {exact}");
        }
    }
}
