//! Meshes of levels taken back from where they were placed into their own space.

use glam::DMat4;
use meshlod_io::transform;
use meshlod_mesh::Mesh;

/// Part of the terms that a coordinate is the sum of below which it is a rounding error: 16 times the
/// rounding of an `f64`.
const NOTHING: f64 = 16.0 * f64::EPSILON;

/// Moves a mesh from where it was placed into its own space; `None` if there is no way back.
///
/// With `exact`, the levels have the placed positions bit for bit. A vertex whose own coordinates were
/// `f32`s, as they are in glTF, then comes back with these, although an inverse rounds: the `f32`s next
/// to what it gives are taken if they are placed at the same bits. That ends where a coordinate is so
/// small beside the size of the placed mesh or its distance from the origin, about 2^-28 of it, that
/// several `f32`s are placed there: then it is off by less than that can tell.
pub(super) fn take_back(mesh: &mut Mesh, placement: [[f64; 4]; 4], exact: bool) -> Option<()> {
    let placement = DMat4::from_cols_array_2d(&placement);
    if placement == DMat4::IDENTITY {
        return is_finite(mesh).then_some(());
    }
    let back = placement.inverse();
    let placed = if exact { mesh.positions.clone() } else { Vec::new() };
    transform(mesh, &back.to_cols_array_2d());
    for (own, placed) in mesh.positions.iter_mut().zip(placed) {
        *own = nearest_f32s(*own, placed, &placement, &back).unwrap_or(*own);
    }
    (back.is_finite() && is_finite(mesh)).then_some(())
}

/// Returns the `f32`s next to a position that are placed at the bits of `placed`, if they are.
fn nearest_f32s(
    own: [f64; 3],
    placed: [f64; 3],
    placement: &DMat4,
    back: &DMat4,
) -> Option<[f64; 3]> {
    let terms = terms(back, placed);
    let with_zeros: [f64; 3] = std::array::from_fn(|k| {
        if own[k].abs() <= NOTHING * terms[k] { 0.0 } else { f64::from(own[k] as f32) }
    });
    let without = own.map(|x| f64::from(x as f32));
    let is_it = |found: &[f64; 3]| {
        let there = placement.transform_point3((*found).into()).to_array();
        there.map(f64::to_bits) == placed.map(f64::to_bits)
    };
    [with_zeros, without].into_iter().find(is_it)
}

/// Sums the sizes of the terms that make up each coordinate of a transformed point.
fn terms(by: &DMat4, point: [f64; 3]) -> [f64; 3] {
    let [x, y, z, w] = [by.x_axis, by.y_axis, by.z_axis, by.w_axis].map(|a| a.truncate().abs());
    let [a, b, c] = point.map(f64::abs);
    (x * a + y * b + z * c + w).to_array()
}

fn is_finite(mesh: &Mesh) -> bool {
    mesh.positions.as_flattened().iter().all(|x| x.is_finite())
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};
    use meshlod_samples as samples;

    use super::*;

    /// Rounds a mesh to `f32`, and to 0 what is too small beside it to come back.
    fn short(mut mesh: Mesh) -> Mesh {
        let shortened = |x: f64| if x.abs() < 1e-8 { 0.0 } else { f64::from(x as f32) };
        mesh.positions.as_flattened_mut().iter_mut().for_each(|x| *x = shortened(*x));
        mesh
    }

    #[test]
    fn positions_in_single_precision_come_back_to_the_bit() {
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
        let places = [
            DMat4::from_scale(DVec3::splat(0.01)),
            DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2),
            DMat4::from_scale_rotation_translation(DVec3::new(3.0, -0.2, 1.0), turn, DVec3::ONE),
            DMat4::from_translation(DVec3::new(10.3, -20.7, 5.1)),
        ];
        let mut inexact = 0;
        // Many coordinates of a sphere and of a torus are 0.
        for mesh in [samples::sphere(800), samples::torus(900), samples::knot(1000)].map(short) {
            for place in places.map(|place| place.to_cols_array_2d()) {
                let mut placed = mesh.clone();
                transform(&mut placed, &place);
                let mut rounded = placed.clone();
                take_back(&mut placed, place, true).unwrap();
                assert_eq!((&placed.positions, &placed.faces), (&mesh.positions, &mesh.faces));
                take_back(&mut rounded, place, false).unwrap();
                inexact += usize::from(rounded.positions != mesh.positions);
            }
        }
        assert!(inexact >= 6, "the inverse alone is as good for {inexact} of 12");
    }

    #[test]
    fn what_was_no_f32_is_taken_back_by_the_inverse() {
        let mesh = samples::knot(500);
        let place = DMat4::from_rotation_y(0.7).to_cols_array_2d();
        let mut placed = mesh.clone();
        transform(&mut placed, &place);
        take_back(&mut placed, place, true).unwrap();
        for (new, old) in placed.positions.iter().zip(&mesh.positions) {
            assert!(DVec3::from(*new).distance(DVec3::from(*old)) < 1e-14);
        }
        assert!(take_back(&mut placed, [[0.0; 4]; 4], true).is_none());
    }
}
