//! Coordinates relative to a centre, for meshes far from the origin, since glTF stores 32 bits.

use std::borrow::Cow;

use glam::DVec3;
use meshlod_mesh::Mesh;

use crate::gltf::write::levels::Level;
use crate::precision::fits_f32;
use crate::scene::{IDENTITY, Node, Scene};

/// Returns the scene and levels with meshes that do not fit in 32 bits moved to the origin; nodes
/// move them back.
///
/// The centre of a mesh is exact in 32 bits. A scene read from glTF stays unchanged.
pub(crate) fn localized<'a>(
    scene: &'a Scene,
    levels: &'a [Level],
) -> (Cow<'a, Scene>, Cow<'a, [Level]>) {
    let centres: Vec<Option<DVec3>> = match scene.source {
        Some(_) => Vec::new(),
        None => scene.meshes.iter().map(|mesh| centre(&mesh.mesh)).collect(),
    };
    if centres.iter().all(Option::is_none) {
        return (Cow::Borrowed(scene), Cow::Borrowed(levels));
    }
    let mut moved = scene.clone();
    let mut levels = levels.to_vec();
    for (index, centre) in centres.iter().enumerate() {
        let Some(centre) = *centre else { continue };
        move_by(&mut moved.meshes[index].mesh, -centre);
        let of_levels = levels.iter_mut().filter_map(|level| level.meshes.get_mut(index));
        of_levels.for_each(|mesh| move_by(mesh, -centre));
        (0..scene.nodes.len()).for_each(|node| show_at(&mut moved, node, index, centre));
    }
    (Cow::Owned(moved), Cow::Owned(levels))
}

/// Moves a mesh to its coordinates in a new glTF file; returns the offset back.
pub(crate) fn to_local(mesh: &mut Mesh) -> DVec3 {
    let centre = centre(mesh).unwrap_or_default();
    if centre != DVec3::ZERO {
        move_by(mesh, -centre);
    }
    centre
}

/// Returns the centre of the bounding box of a mesh that does not fit in 32 bits, rounded to a
/// whole number for large boxes; `None` at the origin, or beyond the range of 32 bits.
fn centre(mesh: &Mesh) -> Option<DVec3> {
    if fits_f32(mesh) {
        return None;
    }
    let bounds = mesh.bounds();
    let (min, max) = (DVec3::from(bounds.min), DVec3::from(bounds.max));
    let middle = min / 2.0 + max / 2.0;
    let middle = if (max - min).max_element() > 2.0 { middle.round() } else { middle };
    let exact = middle.to_array().map(|x| f64::from(x as f32));
    let centre = DVec3::from(exact);
    (centre.is_finite() && centre != DVec3::ZERO).then_some(centre)
}

fn move_by(mesh: &mut Mesh, offset: DVec3) {
    for position in &mut mesh.positions {
        *position = (DVec3::from(*position) + offset).to_array();
    }
}

/// Offsets a mesh shown by a node: by the node's own transform if it is free, else by a new child.
fn show_at(scene: &mut Scene, node: usize, mesh: usize, offset: DVec3) {
    if scene.nodes[node].mesh != Some(mesh) {
        return;
    }
    let mut transform = IDENTITY;
    transform[3][..3].copy_from_slice(&offset.to_array());
    if scene.nodes[node].transform == IDENTITY && scene.nodes[node].children.is_empty() {
        scene.nodes[node].transform = transform;
        return;
    }
    let child = scene.nodes.len();
    scene.nodes.push(Node { transform, mesh: Some(mesh), ..Node::default() });
    scene.nodes[node].mesh = None;
    scene.nodes[node].children.push(child);
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::grid;

    use super::*;
    use crate::{ReadOptions, Resolve, gltf};

    /// A grid of two centimetres in world coordinates.
    fn survey() -> Scene {
        let mut mesh = grid(8);
        for [x, y, z] in &mut mesh.positions {
            (*x, *y, *z) = (0.02 * *x + 500_000.37, 0.02 * *y + 5_400_000.5, 0.02 * *z + 100.0);
        }
        Scene::from_mesh("survey", mesh)
    }

    fn read_back(bytes: &[u8]) -> Scene {
        let none: Resolve<'_> = &mut |_| None;
        gltf::read(bytes, none, ReadOptions::default().weld).unwrap()
    }

    #[test]
    fn world_coordinates_come_back_to_a_micrometre() {
        let scene = survey();
        let back = read_back(&gltf::write_glb(&scene, &[]).unwrap());
        let [.., offset] = back.nodes[0].transform;
        assert!(offset.iter().all(|&x| f64::from(x as f32) == x), "{offset:?}");
        assert_eq!(offset[..2], [500_000.449_999_999_95, 5_400_000.5].map(|x| f64::from(x as f32)));
        let flat = back.flatten();
        assert_eq!(flat.faces, scene.meshes[0].mesh.faces);
        for (a, b) in flat.positions.iter().zip(&scene.meshes[0].mesh.positions) {
            assert!(DVec3::from(*a).distance((*b).into()) < 1e-6);
        }
    }

    #[test]
    fn levels_move_with_their_mesh_and_placed_nodes_get_a_child() {
        let mut scene = survey();
        let level = Level { meshes: vec![scene.meshes[0].mesh.clone()], screen_coverage: 0.5 };
        let (local, levels) = localized(&scene, std::slice::from_ref(&level));
        assert_eq!(levels[0].meshes[0].positions, local.meshes[0].mesh.positions);
        scene.nodes[0].transform[3][0] = 7.0;
        let (local, _) = localized(&scene, &[]);
        assert_eq!((local.nodes.len(), local.nodes[0].mesh), (2, None));
        let [a, b] = [&scene, &*local].map(Scene::flatten);
        for (a, b) in a.positions.iter().zip(&b.positions) {
            assert!(DVec3::from(*a).distance((*b).into()) < 1e-8);
        }
    }

    #[test]
    fn meshes_that_fit_stay() {
        let scene = Scene::from_mesh("", grid(3));
        assert!(matches!(localized(&scene, &[]).0, Cow::Borrowed(_)));
    }
}
