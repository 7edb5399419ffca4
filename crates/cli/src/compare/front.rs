//! The side of a mesh that its pictures show.

use meshlod::Mesh;
use meshlod::picture::{Camera, PictureError, Style, View, render};

use crate::page::style::{OwnedPaint, normals_of};

/// Width and height of the pictures that are compared, in pixels.
const SIDE: u32 = 256;

/// Ratio of detail from which on the other side is shown. Of the shared meshes spot, Max Planck and
/// the armadillo of 52,000 faces, all seen from behind before, have 1.20 to 1.32. A fish that would
/// show its tail has 1.14, and most that look at the viewer have less than 1.
const CLEARLY_MORE: f64 = 1.15;

/// Returns the view, from the opposite side if the mesh shows clearly more detail there.
///
/// No file says where its front is. Most models look along the axis that points at the viewer; of
/// others the picture tells, since a face has more to show than the back of a head.
pub fn facing(mesh: &Mesh, view: View) -> View {
    let other = View { direction: turned(view.direction, view.up), ..view };
    match (detail(mesh, &view), detail(mesh, &other)) {
        (Ok(seen), Ok(hidden)) if hidden > CLEARLY_MORE * seen => other,
        _ => view,
    }
}

/// Returns a direction after half a turn about the axis `up`, of unit length.
fn turned(direction: [f64; 3], up: [f64; 3]) -> [f64; 3] {
    let along: f64 = direction.iter().zip(up).map(|(d, u)| d * u).sum();
    std::array::from_fn(|axis| 2.0 * along * up[axis] - direction[axis])
}

/// Returns how much neighbouring pixels of a shaded picture differ, in all.
fn detail(mesh: &Mesh, view: &View) -> Result<f64, PictureError> {
    let style = Style {
        size: [SIDE; 2],
        paint: OwnedPaint::CLAY.as_paint(),
        normals: normals_of(mesh),
        ..Style::default()
    };
    let picture = render(mesh, &Camera::fit_mesh(mesh, view), &style)?;
    let shade = |x, y| i64::from(picture.pixel(x, y)[1]);
    let pixels = (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).map(move |x| (x, y)));
    let differences = pixels.map(|(x, y)| {
        let here = shade(x, y);
        (here - shade(x + 1, y)).abs() + (here - shade(x, y + 1)).abs()
    });
    Ok(differences.sum::<i64>() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use meshlod::mesh::VertexId;
    use meshlod::picture::UpAxis;

    /// A cube with bumps on one side: ahead along z, or behind if `sign` is -1.
    fn face_along_z(sign: f64) -> Mesh {
        let mut mesh = meshlod::samples::cube(4_800);
        let half = mesh.positions.iter().map(|p| p[2]).fold(0.0, f64::max);
        for p in mesh.positions.iter_mut().filter(|p| p[2] == half) {
            p[2] += 0.1 * half * (9.0 * p[0] / half).sin() * (9.0 * p[1] / half).sin();
        }
        if sign < 0.0 {
            for p in &mut mesh.positions {
                *p = [-p[0], p[1], -p[2]];
            }
        }
        mesh
    }

    #[test]
    fn the_side_with_a_face_is_shown() {
        let view = View::three_quarter(UpAxis::Y);
        let ahead = facing(&face_along_z(1.0), view);
        assert_eq!(ahead.direction, view.direction);
        let [x, y, z] = view.direction;
        assert_eq!(facing(&face_along_z(-1.0), view).direction, [-x, y, -z]);
    }

    #[test]
    fn shared_models_look_at_the_viewer() {
        let view = View::three_quarter(UpAxis::Y);
        let models = [
            ("spot.obj", true),
            ("max-planck-25k.off", true),
            ("homer.obj", false),
            ("suzanne.obj", false),
        ];
        for (name, turns) in models {
            let Some(path) = meshlod_fixtures::shared_mesh(name) else { continue };
            let mesh = meshlod::read(path, &meshlod::ReadOptions::default()).unwrap().into_mesh();
            assert_eq!(facing(&mesh, view).direction != view.direction, turns, "{name}");
        }
    }

    #[test]
    fn without_a_clear_front_the_view_stays() {
        for up in [UpAxis::Y, UpAxis::Z] {
            let view = View::three_quarter(up);
            for mesh in [meshlod::samples::cube(12), Mesh::default()] {
                assert_eq!(facing(&mesh, view).direction, view.direction);
            }
        }
        let flat = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            faces: vec![[0, 1, 2].map(VertexId)],
            ..Mesh::default()
        };
        let view = View::three_quarter(UpAxis::Y);
        assert_eq!(facing(&flat, view).direction, view.direction);
    }
}
