//! Choice of the place that each mesh of a scene has in its levels.

use glam::{DMat3, DMat4, DVec3};
use meshlod_io::Scene;

/// Transform by which a mesh is put into world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    pub transform: [[f64; 4]; 4],
    /// True if this is the transform of the only node that shows the mesh.
    pub is_only: bool,
}

/// Largest ratio of the greatest stretch of a transform to the least that can be undone.
const MAX_STRETCH_RATIO: f64 = 1e6;
/// Relative difference that counts as none.
const SAME: f64 = 1e-9;

/// Chooses a placement for each mesh of a scene; `None` for those that it does not show.
///
/// It is the transform of the node that shows the mesh largest, the first of equals. Where another
/// node stretches it more along some axis, the placement is enlarged about the middle of the mesh
/// by as much. So **no instance is larger along any direction than the placed mesh**, and no error
/// there is larger. A mesh that every node makes flat is placed by scale alone.
///
/// Cost: linear.
pub(super) fn placements(scene: &Scene) -> Vec<Option<Placement>> {
    let mut shown: Vec<Vec<DMat4>> = vec![Vec::new(); scene.meshes.len()];
    for instance in scene.instances() {
        shown[instance.mesh].push(DMat4::from_cols_array_2d(&instance.transform));
    }
    let placed = shown.iter().zip(&scene.meshes).map(|(transforms, mesh)| {
        let bounds = mesh.mesh.bounds();
        let middle = (DVec3::from(bounds.min) + DVec3::from(bounds.max)) * 0.5;
        (!transforms.is_empty()).then(|| placement(transforms, middle))
    });
    placed.collect()
}

fn placement(transforms: &[DMat4], middle: DVec3) -> Placement {
    let stretches: Vec<f64> = transforms.iter().map(|&t| stretch(t)).collect();
    let can_be_undone = |i: usize| {
        let back = transforms[i].inverse();
        let ratio = stretches[i] * stretch(back);
        back.is_finite() && ratio.is_finite() && ratio <= MAX_STRETCH_RATIO
    };
    let usable: Vec<usize> = (0..transforms.len()).filter(|&i| can_be_undone(i)).collect();
    let most = usable.iter().map(|&i| stretches[i]).fold(0.0, f64::max);
    let Some(&base) = usable.iter().find(|&&i| stretches[i] >= most * (1.0 - SAME)) else {
        let most = stretches.iter().copied().fold(0.0, f64::max);
        let scale = if most > 0.0 && most.is_finite() { most } else { 1.0 };
        let transform = DMat4::from_scale(DVec3::splat(scale)).to_cols_array_2d();
        return Placement { transform, is_only: false };
    };
    let back = transforms[base].inverse();
    let excess = transforms.iter().map(|&t| stretch(t * back)).fold(1.0, f64::max);
    if excess <= 1.0 + SAME || !middle.is_finite() {
        let transform = transforms[base].to_cols_array_2d();
        return Placement { transform, is_only: transforms.len() == 1 };
    }
    let enlarged = DMat4::from_translation(middle)
        * DMat4::from_scale(DVec3::splat(excess))
        * DMat4::from_translation(-middle);
    let transform = (transforms[base] * enlarged).to_cols_array_2d();
    Placement { transform, is_only: false }
}

/// Returns a bound of how much a transform stretches any vector. It is exact for rotations with one
/// scale, and for axes scaled apart.
pub(super) fn stretch(transform: DMat4) -> f64 {
    let linear = DMat3::from_mat4(transform);
    // The greatest sum of a row bounds the greatest eigenvalue.
    let squared = (linear.transpose() * linear).to_cols_array_2d();
    let sums = squared.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>());
    sums.fold(0.0, f64::max).sqrt()
}

#[cfg(test)]
mod tests {
    use meshlod_io::Node;
    use meshlod_samples as samples;

    use super::*;

    /// A scene that shows a torus with each of these transforms.
    fn scene(transforms: &[DMat4]) -> Scene {
        let mut scene = Scene::from_mesh("torus", samples::torus(100));
        let node =
            |t: &DMat4| Node { transform: t.to_cols_array_2d(), mesh: Some(0), ..Node::default() };
        scene.nodes = transforms.iter().map(node).collect();
        scene.roots = (0..transforms.len()).collect();
        scene
    }

    fn scaled(x: f64, y: f64, z: f64) -> DMat4 {
        DMat4::from_translation(DVec3::new(7.0, 0.0, 1.0))
            * DMat4::from_rotation_y(0.7)
            * DMat4::from_scale(DVec3::new(x, y, z))
    }

    #[test]
    fn the_largest_instance_is_the_one_placed() {
        let transforms = [scaled(1.0, 1.0, 1.0), scaled(3.0, 3.0, 3.0), scaled(3.0, 3.0, 3.0)];
        let placed = placements(&scene(&transforms))[0].unwrap();
        assert_eq!(placed.transform, transforms[1].to_cols_array_2d());
        assert!(!placed.is_only && placements(&scene(&transforms[..1]))[0].unwrap().is_only);
        assert_eq!(placements(&scene(&[])), [None]);
    }

    #[test]
    fn no_instance_stretches_what_is_placed() {
        let transforms = [
            scaled(1.0, 4.0, 1.0),
            scaled(3.0, -0.5, 3.0),
            DMat4::from_rotation_x(1.0) * scaled(0.0, 2.0, 5.0),
        ];
        for count in 1..=3 {
            let placed = placements(&scene(&transforms[..count]))[0].unwrap();
            let back = DMat4::from_cols_array_2d(&placed.transform).inverse();
            for t in &transforms[..count] {
                assert!(stretch(*t * back) <= 1.0 + 1e-8, "{count}: {}", stretch(*t * back));
            }
        }
    }

    #[test]
    fn what_cannot_be_undone_is_not_applied() {
        for flat in [scaled(2.0, 0.0, 1.0), scaled(1.0, 1e-9, 1.0), scaled(0.0, 0.0, 0.0)] {
            let placed = placements(&scene(&[flat]))[0].unwrap();
            let placed = DMat4::from_cols_array_2d(&placed.transform);
            assert!(placed.determinant().abs() > 0.5, "{placed}");
            assert!(stretch(flat) <= stretch(placed) * (1.0 + 1e-9));
        }
        let both = placements(&scene(&[scaled(9.0, 0.0, 9.0), scaled(1.0, 1.0, 1.0)]))[0].unwrap();
        assert!(DMat4::from_cols_array_2d(&both.transform).determinant() > 0.5);
    }
}
