//! Signed distances from a mesh on a grid, so that a lookup costs the same for any mesh.

use std::fmt;

use glam::{DVec3, Vec3};
use meshlod::mesh::{FaceId, Mesh};
use meshlod::spatial::Bvh;
use rayon::prelude::*;

use crate::simulation::error::FieldError;
use crate::simulation::obstacle::ObstacleDistance;
use crate::simulation::range::FARTHEST;
use crate::simulation::sides::Sides;

/// Signed distances from a mesh, sampled on a regular grid and interpolated between its points.
///
/// Distances are negative inside a closed mesh and behind the faces of an open one such as a
/// terrain: on the back of the closest face. Beyond the grid, which is a little larger than the
/// mesh, the distance from the grid is added, so that the solid under a terrain is a few cells thick.
/// Solids thinner than a cell may vanish.
#[derive(Clone, PartialEq)]
pub struct DistanceField {
    origin: Vec3,
    cell: f32,
    /// Number of samples along each axis.
    size: [usize; 3],
    /// Signed distance at each sample; x varies fastest.
    distances: Vec<f32>,
}

/// Cells between the mesh and the border of the grid.
const MARGIN: f64 = 3.0;
/// Least cell in body lengths, for meshes without extent.
const LEAST_CELL: f64 = 1e-3;

impl DistanceField {
    /// Samples the signed distances from `mesh`, in body lengths.
    ///
    /// `resolution` is the number of cells along the mesh's longest side. Vertices at one position
    /// count as one. Cost: resolution³ closest points at most, in parallel.
    /// # Errors
    /// A resolution outside 2 to 256, and a mesh without faces, without area, with a position that
    /// is not finite or far away, or with an index out of range.
    pub fn new(mesh: &Mesh, resolution: u32) -> Result<Self, FieldError> {
        if !(2..=256).contains(&resolution) {
            return Err(FieldError::Resolution(resolution));
        }
        let bvh = Bvh::new(mesh)?;
        let bounds = mesh.bounds();
        let (lo, hi) = (DVec3::from(bounds.min), DVec3::from(bounds.max));
        if lo.abs().max(hi.abs()).max_element() > f64::from(FARTHEST) {
            return Err(FieldError::TooFar);
        }
        let sides = Sides::new(mesh).ok_or(FieldError::NoArea)?;
        let cell = ((hi - lo).max_element() / f64::from(resolution)).max(LEAST_CELL);
        let origin = (lo - MARGIN * cell).as_vec3();
        let size = ((hi - lo) / cell + 2.0 * MARGIN).ceil().to_array().map(|n| n as usize + 1);
        let mut field = Self { origin, cell: cell as f32, size, distances: Vec::new() };
        field.distances = field.sample(&bvh, &sides);
        Ok(field)
    }

    fn sample(&self, bvh: &Bvh, sides: &Sides) -> Vec<f32> {
        let [nx, ny, nz] = self.size;
        let mut distances = vec![0.0; nx * ny * nz];
        distances.par_chunks_mut(nx).enumerate().for_each(|(row, distances)| {
            let mut hint: Option<FaceId> = None;
            for (x, distance) in distances.iter_mut().enumerate() {
                let at = [x, row % ny, row / ny].map(|n| n as f32);
                let point = (self.origin + Vec3::from(at) * self.cell).as_dvec3();
                let closest = bvh.closest(point.to_array(), hint);
                hint = Some(closest.face);
                let length = closest.distance_squared.sqrt();
                let is_behind = sides.is_behind(point, &closest);
                *distance = if is_behind { -length } else { length } as f32;
            }
        });
        distances
    }

    /// Returns the interpolated signed distance at a point, and its gradient.
    pub fn distance(&self, point: Vec3) -> ObstacleDistance {
        let extent = Vec3::from(self.size.map(|n| (n - 1) as f32)) * self.cell;
        let inside = point.clamp(self.origin, self.origin + extent);
        let (distance, gradient) = self.interpolate(inside);
        let beyond = point - inside;
        let distance = distance + beyond.length();
        let outward = gradient.try_normalize().unwrap_or(Vec3::Y) + beyond / self.cell;
        ObstacleDistance { distance, outward: outward.try_normalize().unwrap_or(Vec3::Y) }
    }

    /// Returns value and gradient of the trilinear interpolation at a point of the grid's box.
    fn interpolate(&self, point: Vec3) -> (f32, Vec3) {
        let at = ((point - self.origin) / self.cell).max(Vec3::ZERO).to_array();
        let corner: [usize; 3] = std::array::from_fn(|k| (at[k] as usize).min(self.size[k] - 2));
        let [x, y, z]: [f32; 3] = std::array::from_fn(|k| (at[k] - corner[k] as f32).min(1.0));
        let [nx, ny, _] = self.size;
        let first = (corner[2] * ny + corner[1]) * nx + corner[0];
        let pair = |at: usize| [self.distances[at], self.distances[at + 1]];
        let square = |at: usize| [pair(at), pair(at + nx)];
        let cube = [square(first), square(first + nx * ny)];
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        // One axis after the other; the gradient is the difference along each.
        let along_x = cube.map(|square| square.map(|[a, b]| mix(a, b, x)));
        let along_xy = along_x.map(|[a, b]| mix(a, b, y));
        let slope_x = cube.map(|square| square.map(|[a, b]| b - a)).map(|[a, b]| mix(a, b, y));
        let slope_y = along_x.map(|[a, b]| b - a);
        let gradient = Vec3::new(
            mix(slope_x[0], slope_x[1], z),
            mix(slope_y[0], slope_y[1], z),
            along_xy[1] - along_xy[0],
        );
        (mix(along_xy[0], along_xy[1], z), gradient / self.cell)
    }

    /// Moves the field together with its mesh.
    pub(super) fn translate(&mut self, by: Vec3) {
        self.origin += by;
    }

    /// Returns the length of a cell's side: the detail that the field resolves.
    pub fn cell(&self) -> f32 {
        self.cell
    }

    /// Returns centre and radius of a ball around all that is inside.
    pub(super) fn ball(&self) -> (Vec3, f32) {
        let half = Vec3::from(self.size.map(|n| (n - 1) as f32)) * self.cell * 0.5;
        // Under a terrain the solid ends where the distance from the grid is that of the mesh.
        let deepest = self.distances.iter().fold(0.0_f32, |deepest, d| deepest.max(-d));
        (self.origin + half, half.length() + deepest)
    }
}

impl fmt::Debug for DistanceField {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { origin, cell, size, .. } = self;
        write!(f, "DistanceField {{ origin: {origin}, cell: {cell}, size: {size:?} }}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use meshlod::mesh::VertexId;
    use meshlod::samples;

    #[test]
    fn the_field_of_a_ball_is_that_of_the_ball() {
        let mesh = samples::sphere(5000);
        let field = DistanceField::new(&mesh, 32).unwrap();
        let radius = mesh.bounds().max[0] as f32;
        for direction in [Vec3::X, Vec3::new(0.6, 0.0, -0.8), Vec3::new(-0.48, 0.6, 0.64)] {
            for far in [0.3, 0.9, 1.0, 1.1] {
                let found = field.distance(direction * far * radius);
                assert!((found.distance - (far - 1.0) * radius).abs() < 0.2 * field.cell());
                assert!(found.outward.dot(direction) > 0.95, "{found:?}");
            }
            // Beyond the grid the distance is no shorter than it should be.
            let found = field.distance(direction * 3.0 * radius);
            assert!((1.99..2.8).contains(&(found.distance / radius)), "{found:?}");
            assert!(found.outward.dot(direction) > 0.8, "{found:?}");
        }
    }

    #[test]
    fn under_a_terrain_is_inside() {
        let mut mesh = samples::terrain(2000);
        // Vertices of every face of their own: positions alone connect them.
        let faces = mesh.faces.iter().flatten().map(|v| mesh.positions[v.index()]).collect();
        mesh.faces =
            (0..mesh.faces.len()).map(|f| [0, 1, 2].map(|k| VertexId::new(3 * f + k))).collect();
        mesh.positions = faces;
        let field = DistanceField::new(&mesh, 64).unwrap();
        for face in mesh.faces.iter().step_by(17) {
            let [a, b, c] = mesh.triangle(*face);
            let (middle, normal) = ((a + b + c) / 3.0, (b - a).cross(c - a).normalize());
            let away = normal * f64::from(1.5 * field.cell());
            assert!(field.distance((middle + away).as_vec3()).distance > 0.0);
            assert!(field.distance((middle - away).as_vec3()).distance < 0.0);
        }
    }

    #[test]
    fn a_mesh_without_sides_is_refused() {
        let triangle = |b: [f64; 3]| {
            let positions = vec![[0.0; 3], b, [1.0, 0.0, 0.0]];
            Mesh::new(positions, vec![[VertexId(0), VertexId(1), VertexId(2)]])
        };
        assert_eq!(DistanceField::new(&triangle([2.0, 0.0, 0.0]), 8), Err(FieldError::NoArea));
        assert_eq!(
            DistanceField::new(&triangle([0.0, 1.0, 0.0]), 1),
            Err(FieldError::Resolution(1))
        );
        assert_eq!(DistanceField::new(&triangle([0.0, 1e7, 0.0]), 8), Err(FieldError::TooFar));
        assert!(matches!(DistanceField::new(&Mesh::default(), 8), Err(FieldError::Mesh(_))));
        let broken = triangle([0.0, f64::NAN, 0.0]);
        assert!(matches!(DistanceField::new(&broken, 8), Err(FieldError::Mesh(_))));
        assert!(DistanceField::new(&triangle([0.0, 1.0, 0.0]), 8).is_ok());
    }
}
