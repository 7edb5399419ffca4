//! Faces that no eye on one side of a member can see.

use glam::{DVec3, Vec3};
use meshlod_mesh::{Connectivity, Mesh, VertexId, face_components};

use crate::levels::directions::DirectionGrid;

/// Least distance of the eye for which facing chains hold, in body lengths. Nearer members need
/// the whole chain.
pub const NEAREST_FACING: f32 = 2.0;

/// Angle beyond its cell for which a facing chain holds: rounding, and the rim between the
/// directions that were tried, .3°.
const SLACK_RAD: f32 = 0.005;

/// Faces of a level that may be left out, depending on the direction.
pub(crate) struct HiddenFaces {
    /// Unit normal of each face, and its distance from the origin along it; `None` for faces that
    /// must stay.
    planes: Vec<Option<(DVec3, f64)>>,
}

impl HiddenFaces {
    /// Finds the faces of a level that may be hidden: all of closed components that face outwards.
    /// Their backs are never seen.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let hides = closed_components(mesh);
        let plane = |(&face, hides): (&[VertexId; 3], bool)| {
            let [a, b, c] = mesh.triangle(face);
            let normal = (b - a).cross(c - a).try_normalize()?;
            hides.then(|| (normal, normal.dot(a).min(normal.dot(b)).min(normal.dot(c))))
        };
        Self { planes: mesh.faces.iter().zip(hides).map(plane).collect() }
    }

    /// Returns true if the face turns its back to every eye within `half_angle_rad` of a direction,
    /// [`NEAREST_FACING`] or more away.
    ///
    /// An eye e sees the back if n·e < n·p. Among directions within the angle, n·e is greatest for
    /// the one that is nearest to n, and if that is negative, at the least distance.
    pub(crate) fn is_hidden(&self, face: usize, axis: Vec3, half_angle_rad: f32) -> bool {
        let Some((normal, offset)) = self.planes[face] else { return false };
        let angle = normal.angle_between(axis.as_dvec3()) - f64::from(half_angle_rad);
        let nearest = f64::from(NEAREST_FACING) * angle.cos();
        angle > std::f64::consts::FRAC_PI_2 && nearest < offset
    }

    /// Returns the triangles of a level that may be seen from a direction of the grid.
    pub(crate) fn seen_from(&self, directions: &DirectionGrid, cell: usize) -> Vec<usize> {
        let (axis, angle) = (directions.axis(cell), directions.half_angle_rad(cell) + SLACK_RAD);
        (0..self.planes.len()).filter(|&face| !self.is_hidden(face, axis, angle)).collect()
    }
}

/// Returns for every face whether its component is closed, consistently oriented, and encloses a
/// positive volume.
fn closed_components(mesh: &Mesh) -> Vec<bool> {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let (of_face, count) = face_components(&mesh.faces, mesh.positions.len());
    let mut volumes = vec![0.0; count];
    let mut closed = vec![connectivity.inconsistent_edges() == 0; count];
    for (&face, &component) in mesh.faces.iter().zip(&of_face) {
        let [a, b, c] = mesh.triangle(face);
        volumes[component as usize] += DVec3::dot(a, b.cross(c));
        let torn = |v: &VertexId| {
            let marks = connectivity.marks(*v);
            marks.boundary() || marks.non_manifold()
        };
        closed[component as usize] &= !face.iter().any(torn);
    }
    of_face.iter().map(|&c| closed[c as usize] && volumes[c as usize] > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// True if this eye sees the back of the face.
    fn shows_its_back(mesh: &Mesh, face: usize, eye: DVec3) -> bool {
        let [a, b, c] = mesh.triangle(mesh.faces[face]);
        (b - a).cross(c - a).dot(eye - a) <= 1e-12
    }

    #[test]
    fn what_is_left_out_shows_its_back_to_every_eye_of_the_cell() {
        let mut fish = meshlod_samples::fish(2_000);
        fish.positions.iter_mut().flatten().for_each(|x| *x *= 0.5);
        let (grid, hidden) = (DirectionGrid::new(12), HiddenFaces::new(&fish));
        let mut left_out = 0;
        for i in 0..500 {
            let z = 1.0 - (i as f32 + 0.5) / 250.0;
            let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
            let flat = (1.0 - z * z).sqrt();
            let direction = Vec3::new(flat * cos, flat * sin, z);
            let seen = hidden.seen_from(&grid, grid.cell(direction));
            let distance = NEAREST_FACING * [1.0, 1.5, 100.0][i % 3];
            let eye = (direction * distance).as_dvec3();
            let mut seen = seen.into_iter().peekable();
            for face in 0..fish.faces.len() {
                if seen.next_if_eq(&face).is_none() {
                    left_out += 1;
                    assert!(shows_its_back(&fish, face, eye), "face {face} from {direction}");
                }
            }
        }
        let share = left_out as f64 / (500 * fish.faces.len()) as f64;
        assert!(share > 0.3, "a fish hides much of itself: {share}");
    }

    #[test]
    fn open_and_inverted_surfaces_stay_whole() {
        let mut ball = meshlod_samples::sphere(500);
        let hidden = HiddenFaces::new(&ball);
        assert!(hidden.seen_from(&DirectionGrid::new(12), 0).len() < 400);
        ball.faces.iter_mut().for_each(|face| face.swap(1, 2));
        let seen = |ball: &Mesh| HiddenFaces::new(ball).seen_from(&DirectionGrid::new(12), 0).len();
        assert_eq!(seen(&ball), ball.faces.len());
        ball.faces.iter_mut().for_each(|face| face.swap(1, 2));
        ball.faces.pop();
        assert_eq!(seen(&ball), ball.faces.len());
    }
}
