//! Surface area and enclosed volume of a mesh.

use glam::DVec3;
use meshlod_mesh::{Frame, Mesh, VertexId};
use meshlod_spatial::CompensatedSum;

/// Computes the total area of the faces, in square model units; 0 for a mesh without faces.
///
/// Indices must be in range and positions finite. Infinite only if the area exceeds `f64`.
/// Cost: O(faces).
pub fn area(mesh: &Mesh) -> f64 {
    let frame = Frame::of(&mesh.bounds());
    let sum: CompensatedSum =
        local_triangles(mesh, frame).map(|triangle| triangle_area(&triangle)).collect();
    frame.model_squared(sum.value())
}

/// Computes the signed volume of the mesh in cubic model units, positive if faces point outwards
/// and 0 without faces.
///
/// For a closed mesh this is the enclosed volume, each region weighted by its winding number. For
/// an open mesh it is the volume of the cones from the centre of the bounding box to the faces.
/// Accurate to about 1e-15 of the volume of the box, wherever the mesh lies. Indices must be in
/// range and positions finite. Cost: O(faces).
pub fn volume(mesh: &Mesh) -> f64 {
    let frame = Frame::of(&mesh.bounds());
    // From edges, not corners: the product of two long corner vectors of a small face would lose
    // most of its digits.
    let sum: CompensatedSum =
        local_triangles(mesh, frame).map(|[a, b, c]| a.dot((b - a).cross(c - a))).collect();
    frame.model_squared(sum.value() / 6.0) / frame.scale()
}

fn local_triangles(mesh: &Mesh, frame: Frame) -> impl Iterator<Item = [DVec3; 3]> {
    let at = move |v: VertexId| frame.local(mesh.positions[v.index()]);
    // `map` over an array is not inlined.
    mesh.faces.iter().map(move |&[a, b, c]| [at(a), at(b), at(c)])
}

pub(crate) fn triangle_area([a, b, c]: &[DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{cube, moved, scaled, sphere, tetrahedron};

    fn close(found: f64, expected: f64, relative: f64) {
        assert!((found / expected - 1.0).abs() <= relative, "{found}, not {expected}");
    }

    #[test]
    fn closed_forms_of_small_solids() {
        assert_eq!((volume(&cube()), area(&cube())), (1.0, 6.0));
        assert_eq!(volume(&tetrahedron()), 1.0 / 6.0);
        close(area(&tetrahedron()), 1.5 + 3f64.sqrt() / 2.0, 1e-15);
    }

    #[test]
    fn a_sphere_of_many_faces_comes_near_the_round_one() {
        let sphere = sphere(200, 2.0);
        let round = std::f64::consts::PI * 4.0;
        close(volume(&sphere), round * 8.0 / 3.0, 5e-4);
        close(area(&sphere), round * 4.0, 5e-4);
        assert!(volume(&sphere) < round * 8.0 / 3.0);
    }

    #[test]
    fn turned_inside_out_the_volume_is_negative() {
        let mut mesh = cube();
        mesh.faces.iter_mut().for_each(|face| face.reverse());
        assert_eq!(volume(&mesh), -1.0);
    }

    #[test]
    fn far_away_nothing_changes() {
        // On a grid of 2^-20 the translation itself is exact.
        let mut near = sphere(100, 2.0);
        for x in near.positions.iter_mut().flatten() {
            *x = (*x * 1_048_576.0).round() / 1_048_576.0;
        }
        let far = moved(&near, 1_048_576.0);
        close(volume(&far), volume(&near), 2e-15);
        close(area(&far), area(&near), 2e-15);
    }

    #[test]
    fn one_part_in_ten_to_the_thirteen_shows() {
        // Moving a vertex along the area vector of its one-ring changes the volume by a third of
        // that vector's length per unit.
        let mut mesh = sphere(200, 1.0);
        let before = volume(&mesh);
        let vertex = mesh.faces[mesh.faces.len() / 2][0];
        let ring = mesh.faces.iter().filter(|face| face.contains(&vertex));
        let vector: DVec3 =
            ring.map(|&face| mesh.triangle(face)).map(|[a, b, c]| (b - a).cross(c - a) * 0.5).sum();
        let wanted = 1e-12 * before;
        let step = vector * (3.0 * wanted / vector.length_squared());
        let position = &mut mesh.positions[vertex.index()];
        *position = (DVec3::from(*position) + step).into();
        close(volume(&mesh) - before, wanted, 0.01);
    }

    #[test]
    fn any_size_that_a_float_holds_is_measured() {
        for size in [1e-90, 1e90] {
            close(volume(&scaled(&cube(), size)), size * size * size, 1e-14);
            close(area(&scaled(&cube(), size)), 6.0 * size * size, 1e-14);
        }
        assert_eq!(volume(&scaled(&cube(), 1e200)), f64::INFINITY);
    }

    #[test]
    fn nothing_has_no_size() {
        assert_eq!((area(&Mesh::default()), volume(&Mesh::default())), (0.0, 0.0));
    }
}
