//! Area and volume of all that a scene shows.

use glam::{DMat3, DMat4, DVec3};
use meshlod_io::{MeshInstance, Scene};
use meshlod_measure::{area, volume};
use meshlod_mesh::{Bounds, Connectivity, Mesh};

use super::place::{similarity, world_bounds};

/// Area and volume of all instances of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShownSizes {
    /// Total area of the faces.
    pub area: f64,
    /// Signed volume, as [`meshlod_measure::volume`] has it of the flattened scene.
    pub volume: f64,
}

/// Measures all that a scene shows, each mesh once if its instances have similar shapes.
///
/// Equal to the sizes of [`Scene::flatten`] but for rounding. Cost: linear in the faces of meshes
/// and in the number of instances; in the faces shown, where those are stretched.
pub fn shown_sizes(scene: &Scene) -> ShownSizes {
    let center = center(&world_bounds(scene));
    let mut known: Vec<Option<OwnSizes>> = vec![None; scene.meshes.len()];
    let mut all = ShownSizes::default();
    for shown in scene.instances() {
        let mesh = &scene.meshes[shown.mesh].mesh;
        if mesh.faces.is_empty() {
            continue;
        }
        let own = *known[shown.mesh].get_or_insert_with(|| OwnSizes::of(mesh));
        all.area += match similarity(&shown) {
            Some(scale) => scale * scale * own.area,
            None => stretched_area(mesh, &shown),
        };
        all.volume += own.volume_around(center, &shown);
    }
    all
}

/// Sizes of a mesh in its own space.
#[derive(Clone, Copy)]
struct OwnSizes {
    area: f64,
    /// Volume of the cones from the centre of the mesh.
    volume: f64,
    center: DVec3,
    /// Sum of the areas of the faces along their normals: zero if the surface is closed and all
    /// turn the same way.
    directed_area: DVec3,
}

impl OwnSizes {
    fn of(mesh: &Mesh) -> Self {
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let is_closed = connectivity.is_closed() && connectivity.inconsistent_edges() == 0;
        let directed = |face| {
            let [a, b, c] = mesh.triangle(face);
            0.5 * (b - a).cross(c - a)
        };
        Self {
            area: area(mesh),
            volume: volume(mesh),
            center: center(&mesh.bounds()),
            directed_area: match is_closed {
                true => DVec3::ZERO,
                false => mesh.faces.iter().map(|face| directed(*face)).sum(),
            },
        }
    }

    /// Returns the volume of the cones from a point in world space to the faces of an instance.
    fn volume_around(&self, point: DVec3, shown: &MeshInstance) -> f64 {
        let world = DMat4::from_cols_array_2d(&shown.transform);
        let linear = DMat3::from_mat4(world);
        let determinant = linear.determinant();
        let own = determinant.abs() * self.volume;
        if self.directed_area == DVec3::ZERO {
            return own;
        }
        // The cofactor matrix turns directed areas. A mirrored instance has its faces turned over.
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = linear;
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        let directed = (cofactors * self.directed_area) * determinant.signum();
        own + (world.transform_point3(self.center) - point).dot(directed) / 3.0
    }
}

fn center(bounds: &Bounds) -> DVec3 {
    (DVec3::from(bounds.min) + DVec3::from(bounds.max)) * 0.5
}

/// Returns the area of an instance in another shape than its mesh.
fn stretched_area(mesh: &Mesh, shown: &MeshInstance) -> f64 {
    let world = DMat4::from_cols_array_2d(&shown.transform);
    let moved = mesh.positions.iter().map(|at| world.transform_point3((*at).into()).to_array());
    area(&Mesh::new(moved.collect(), mesh.faces.clone()))
}

#[cfg(test)]
mod tests {
    use glam::DQuat;
    use meshlod_io::Node;
    use meshlod_samples as samples;

    use super::*;

    #[test]
    fn sizes_are_those_of_the_flat_mesh() {
        let turn = DQuat::from_xyzw(0.1, 0.7, -0.3, 0.5).normalize();
        let shapes = [[1.0; 3], [-2.0, 2.0, 2.0], [3.0, 1.0, -0.5], [0.5; 3], [1.0, 0.0, 1.0]];
        let mut odd = samples::torus(600);
        odd.faces.iter_mut().step_by(3).for_each(|face| face.swap(0, 1));
        for mesh in [samples::torus(600), samples::terrain(300), odd] {
            let mut scene = Scene::from_mesh("", mesh);
            scene.nodes = (0..)
                .zip(shapes)
                .map(|(i, shape)| {
                    let at = DVec3::new(f64::from(i), 2.0, -3.0);
                    let to = DMat4::from_scale_rotation_translation(shape.into(), turn, at);
                    Node { transform: to.to_cols_array_2d(), ..scene.nodes[0].clone() }
                })
                .collect();
            scene.roots = (0..shapes.len()).collect();
            let (found, flat) = (shown_sizes(&scene), scene.flatten());
            for [found, flat] in [[found.area, area(&flat)], [found.volume, volume(&flat)]] {
                assert!((found - flat).abs() < 1e-9 * flat.abs().max(1.0), "{found} {flat}");
            }
        }
    }
}
