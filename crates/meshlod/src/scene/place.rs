//! Bounding box of a scene in world space, and scale of its instances.

use glam::{DMat3, DMat4, DVec3};
use meshlod_io::{Format, MeshInstance, Precision, Scene};
use meshlod_mesh::{Bounds, Mesh};
use meshlod_simplify::Digits;
use rayon::prelude::*;

/// Returns the bounding box of a scene in world space, without vertices that no face uses.
///
/// Equal to the box of [`Scene::flatten`], which is not built. Cost: linear in the vertices shown.
pub fn world_bounds(scene: &Scene) -> Bounds {
    let points = used_points(scene);
    let merged = |mut all: Bounds, own: Bounds| {
        all.merge(&own);
        all
    };
    let instances = scene.instances();
    let own = instances.par_iter().map(|shown| instance_bounds(shown, &points[shown.mesh]));
    own.reduce(|| Bounds::EMPTY, merged)
}

/// Returns the places that faces use of each mesh that a scene shows, in the space of the mesh.
pub(crate) fn used_points(scene: &Scene) -> Vec<Vec<DVec3>> {
    let mut points = vec![Vec::new(); scene.meshes.len()];
    let mut is_known = vec![false; scene.meshes.len()];
    for shown in scene.instances() {
        if std::mem::replace(&mut is_known[shown.mesh], true) {
            continue;
        }
        let mesh = &scene.meshes[shown.mesh].mesh;
        let places = mesh.positions.iter().zip(mesh.used_vertices());
        points[shown.mesh] = places.filter(|(_, used)| *used).map(|(at, _)| (*at).into()).collect();
    }
    points
}

/// Returns the bounding box, in world space, of an instance of a mesh with these points.
pub(crate) fn instance_bounds(shown: &MeshInstance, points: &[DVec3]) -> Bounds {
    let world = DMat4::from_cols_array_2d(&shown.transform);
    let mut bounds = Bounds::EMPTY;
    match world == DMat4::IDENTITY {
        true => points.iter().for_each(|at| bounds.add(at.to_array())),
        false => points.iter().for_each(|at| bounds.add(world.transform_point3(*at).to_array())),
    }
    bounds
}

/// Largest difference between the scales along axes, as a part of them, and cosine between axes of a
/// similarity.
const SIMILAR: f64 = 1e-6;

/// Returns the scale of an instance; `None` unless its transform is a similarity, maybe mirrored.
pub(crate) fn similarity(instance: &MeshInstance) -> Option<f64> {
    let linear = DMat3::from_mat4(DMat4::from_cols_array_2d(&instance.transform));
    let axes = [linear.x_axis, linear.y_axis, linear.z_axis];
    let scale = axes[0].length();
    if !(scale > 0.0 && scale.is_finite()) {
        return None;
    }
    let [x, y, z] = axes.map(|axis| axis / scale);
    let are_unit = [y, z].iter().all(|axis| (axis.length() - 1.0).abs() <= SIMILAR);
    let are_square = [x.dot(y), y.dot(z), z.dot(x)].iter().all(|cos| cos.abs() <= SIMILAR);
    (are_unit && are_square).then_some(scale)
}

/// Returns the number of faces that a scene shows, over all instances of its meshes.
pub(crate) fn shown_faces(scene: &Scene) -> usize {
    scene.instances().iter().map(|instance| scene.meshes[instance.mesh].mesh.faces.len()).sum()
}

/// Returns how far writing a level of a scene with these digits may move a point, at most, in world
/// units: by half a unit in the last place of its largest coordinate along each axis.
///
/// Covers coordinates in the space of a mesh, as glTF has them, and in world space.
pub fn rounding_of_level(scene: &Scene, digits: Digits) -> f64 {
    match digits {
        Digits::F64 => 0.0,
        Digits::F32 | Digits::Decimal => {
            rounding_in_meshes(scene).max(half_ulp(&world_bounds(scene)))
        }
    }
}

/// Returns how far writing a level of a scene with 32 bits may move a point, at most, in world units,
/// where nodes are kept: as [`rounding_of_level`], in the space of each mesh alone.
pub(crate) fn rounding_in_meshes(scene: &Scene) -> f64 {
    let own = |place: &MeshInstance| {
        length_scale(&place.transform) * half_ulp(&scene.meshes[place.mesh].mesh.bounds())
    };
    scene.instances().iter().map(own).fold(0.0, f64::max)
}

/// Returns how far rounding to 32 bits may move a vertex of a level of a mesh with these bounds.
fn half_ulp(bounds: &Bounds) -> f64 {
    let of_each = bounds.min.iter().chain(&bounds.max).filter(|x| x.is_finite());
    let reach = of_each.fold(0.0, |most: f64, x| most.max(x.abs()));
    BEYOND * 3f64.sqrt() * 0.5 * f64::from(f32::EPSILON) * reach
}

/// Returns the largest change of a coordinate, in world units, when a scene is written in a format and
/// read back, over all instances of its meshes: that along an axis of the mesh, as long as nodes make
/// it. Infinite for a coordinate that cannot be written.
pub fn shown_rounding(scene: &Scene, format: Format, precision: Precision) -> f64 {
    let precision = precision.of(scene.meshes.iter().map(|mesh| &mesh.mesh));
    let own: Vec<f64> = scene
        .meshes
        .iter()
        .map(|mesh| scene.mesh_rounding(&mesh.mesh, format, precision))
        .collect();
    let shown = scene.instances().into_iter().filter(|place| own[place.mesh] > 0.0);
    shown.map(|place| length_scale(&place.transform) * own[place.mesh]).fold(0.0, f64::max)
}

/// Returns the largest distance, in world units, by which a vertex differs between two levels of a
/// scene that have the same vertices: no point of one is farther from the other.
pub fn moved_at_most(scene: &Scene, before: &[Mesh], after: &[Mesh]) -> f64 {
    let moved = |place: &MeshInstance| {
        let [before, after] = [before, after].map(|level| &level[place.mesh].positions);
        let apart = |(a, b): (&[f64; 3], &[f64; 3])| DVec3::from(*a).distance(DVec3::from(*b));
        let most = before.iter().zip(after).map(apart).fold(0.0, f64::max);
        length_scale(&place.transform) * most
    };
    scene.instances().iter().map(moved).fold(0.0, f64::max)
}

/// Factor by which vertices of a level may lie farther out than those of its input.
const BEYOND: f64 = 1.1;

/// Returns world units per unit of each mesh, in its largest instance; 0 if no node shows it.
pub(crate) fn sizes(scene: &Scene) -> Vec<f64> {
    let mut sizes = vec![0.0f64; scene.meshes.len()];
    for place in scene.instances() {
        sizes[place.mesh] = sizes[place.mesh].max(length_scale(&place.transform));
    }
    sizes
}

/// Returns the largest factor by which a transform scales a length: its largest singular value.
///
/// Repeated squaring of MᵀM isolates the direction of that factor. Only plain arithmetic is used,
/// so that results are the same on every machine.
pub(crate) fn length_scale(transform: &[[f64; 4]; 4]) -> f64 {
    let linear = DMat3::from_mat4(DMat4::from_cols_array_2d(transform));
    let size = linear.to_cols_array().iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    if size == 0.0 || !size.is_finite() {
        return size;
    }
    let linear = linear * (1.0 / size);
    let square = linear.transpose() * linear;
    let mut power = square;
    for _ in 0..SQUARINGS {
        power = power * power;
        power *= 1.0 / trace(&power);
    }
    size * (trace(&(square * power)) / trace(&power)).sqrt()
}

/// Number of squarings: enough to separate singular values that differ by 1e-12.
const SQUARINGS: usize = 40;

fn trace(matrix: &DMat3) -> f64 {
    matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z
}

#[cfg(test)]
mod tests {
    use glam::DQuat;
    use meshlod_samples as samples;

    use super::*;

    fn scale(matrix: DMat4) -> f64 {
        length_scale(&matrix.to_cols_array_2d())
    }

    #[test]
    fn the_longest_axis_counts_however_turned() {
        let turn = DMat4::from_quat(DQuat::from_xyzw(0.1, 0.7, -0.3, 0.5).normalize());
        for axes in [[1.0, 1.0, 1.0], [-3.0, 3.0, 2.0], [0.0, 0.0, 1e-9], [1e200, 1.0, 1.0]] {
            let longest = axes.iter().fold(0.0, |most: f64, x: &f64| most.max(x.abs()));
            let found = scale(turn * DMat4::from_scale(axes.into()) * turn);
            assert!((found / longest - 1.0).abs() < 1e-12, "{found}, not {longest}");
        }
    }

    #[test]
    fn a_shear_lengthens_by_the_golden_ratio() {
        let mut shear = DMat4::IDENTITY;
        shear.y_axis.x = 1.0;
        assert!((scale(shear) - (1.0 + 5f64.sqrt()) / 2.0).abs() < 1e-12);
    }

    #[test]
    fn rounding_covers_what_single_precision_moves() {
        let mut scene = Scene::from_mesh("torus", samples::torus(500));
        let place =
            DMat4::from_translation(DVec3::splat(1e3)) * DMat4::from_scale(DVec3::splat(3.0));
        scene.nodes[0].transform = place.to_cols_array_2d();
        let before = vec![scene.meshes[0].mesh.clone()];
        let mut after = before.clone();
        after[0].positions.as_flattened_mut().iter_mut().for_each(|x| *x = f64::from(*x as f32));
        let moved = moved_at_most(&scene, &before, &after);
        assert!(moved > 0.0 && moved <= rounding_of_level(&scene, Digits::F32), "{moved}");
        let mut in_world = 0.0f64;
        for position in scene.flatten().positions {
            let short = position.map(|x| f64::from(x as f32));
            in_world = in_world.max(DVec3::from(short).distance(position.into()));
        }
        assert!(in_world > moved && in_world <= rounding_of_level(&scene, Digits::F32));
        assert_eq!(rounding_of_level(&scene, Digits::F64), 0.0);
    }

    #[test]
    fn odd_transforms_give_no_nan() {
        assert_eq!(scale(DMat4::ZERO), 0.0);
        assert_eq!(scale(DMat4::from_scale(DVec3::splat(f64::INFINITY))), f64::INFINITY);
    }

    #[test]
    fn the_world_box_is_that_of_the_flat_mesh() {
        let mut scene = Scene::from_mesh("torus", samples::torus(500));
        scene.meshes[0].mesh.positions.push([99.0; 3]);
        assert_eq!(world_bounds(&scene), scene.flatten().bounds());
        let turn = DQuat::from_xyzw(0.1, 0.7, -0.3, 0.5).normalize();
        scene.nodes[0].transform =
            DMat4::from_rotation_translation(turn, DVec3::ONE).to_cols_array_2d();
        assert_eq!(world_bounds(&scene), scene.flatten().bounds());
    }
}
