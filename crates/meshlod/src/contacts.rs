//! Locks of what a scene shows, for the meshes that it is made of.

use meshlod_check::{LockOptions, LockReason, Locking, locks};
use meshlod_io::{Scene, SceneMesh};
use meshlod_mesh::{Lock, VertexId};

/// What must stay of each mesh of a scene, by where its meshes meet in the world.
///
/// A mesh that several nodes show is as little free as in any of its places. Vertices of two meshes
/// at one place are locked, since meshes move apart; those of one are tied. Meshes that no node shows
/// are free.
///
/// Cost: that of [`locks`] for [`Scene::flatten`].
pub fn scene_locks(scene: &Scene, options: &LockOptions) -> Vec<Locking> {
    let vertices = |mesh: &SceneMesh| mesh.mesh.positions.len();
    let mut of_meshes: Vec<Locking> =
        scene.meshes.iter().map(|mesh| Locking::free(vertices(mesh))).collect();
    let flat = locks(&scene.flatten(), options);
    let mut home = Vec::with_capacity(flat.reasons.len());
    for placement in scene.placements() {
        let count = of_meshes[placement.mesh].reasons.len();
        home.extend((0..count).map(|v| (placement.node, placement.mesh, VertexId::new(v))));
    }
    for (i, &(_, mesh, v)) in home.iter().enumerate() {
        let own = &mut of_meshes[mesh];
        own.hold(v, flat.locks.of_vertex[i], flat.reasons[i]);
    }
    for tie in &flat.locks.ties {
        let (node, mesh, _) = home[tie[0].index()];
        let members: Vec<_> = tie.iter().map(|v| home[v.index()]).collect();
        let own = &mut of_meshes[mesh].locks.ties;
        if members.iter().all(|member| member.0 == node) {
            own.push(members.iter().map(|member| member.2).collect());
            continue;
        }
        for (_, mesh, v) in members {
            of_meshes[mesh].hold(v, Lock::Locked, Some(LockReason::SharedPlace));
        }
    }
    of_meshes.iter_mut().for_each(Locking::settle_ties);
    of_meshes
}

#[cfg(test)]
mod tests {
    use meshlod_io::Node;
    use meshlod_mesh::{Mesh, sample};

    use super::*;

    const CONTACTS: LockOptions = LockOptions { contacts: true, boundary: Lock::Free };

    fn at(x: f64, mesh: usize) -> Node {
        let mut transform = Node::default().transform;
        transform[3][0] = x;
        Node { transform, mesh: Some(mesh), ..Node::default() }
    }

    fn scene(meshes: Vec<Mesh>, nodes: Vec<Node>) -> Scene {
        let meshes = meshes.into_iter().map(|mesh| SceneMesh { mesh, ..SceneMesh::default() });
        let roots = (0..nodes.len()).collect();
        Scene { meshes: meshes.collect(), nodes, roots, ..Scene::default() }
    }

    /// The unit square of two faces at z = 0.
    fn square() -> Mesh {
        let positions = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| [x, y, 0.0]);
        Mesh::new(positions.into(), [[0, 1, 2], [0, 2, 3]].map(|face| face.map(VertexId)).into())
    }

    #[test]
    fn meshes_that_cross_in_the_world_are_locked_there() {
        let balls = |x| {
            let meshes = vec![sample::sphere(500); 3];
            scene_locks(&scene(meshes, vec![at(0.0, 0), at(x, 1)]), &CONTACTS)
        };
        let locked = |of: &Locking| of.locks.of_vertex.contains(&Lock::Locked);
        assert_eq!(balls(1.5).iter().map(locked).collect::<Vec<_>>(), [true, true, false]);
        assert_eq!(balls(2.5).iter().map(locked).collect::<Vec<_>>(), [false; 3]);
    }

    #[test]
    fn a_mesh_shown_twice_is_held_wherever_it_is() {
        let held = scene_locks(&scene(vec![square()], vec![at(0.0, 0), at(1.0, 0)]), &CONTACTS);
        // Side by side: the right side of one at the left side of the other.
        assert_eq!(held[0].locks.of_vertex, [Lock::Locked; 4]);
        assert!(held[0].locks.ties.is_empty());
        assert_eq!(held[0].count(LockReason::SharedPlace), 4);
    }

    #[test]
    fn what_is_torn_within_one_mesh_is_tied() {
        let mut mesh = square();
        let mut other = square();
        other.positions.iter_mut().for_each(|p| p[0] += 1.0);
        mesh.faces.extend(other.faces.iter().map(|face| face.map(|v| VertexId(v.0 + 4))));
        mesh.positions.extend(other.positions);
        let held = scene_locks(&scene(vec![mesh], vec![at(5.0, 0)]), &CONTACTS);
        assert_eq!(held[0].locks.ties, [[1, 4], [2, 7]].map(|tie| tie.map(VertexId)));
        assert_eq!(held[0].locks.of_vertex, [Lock::Free; 8]);
    }
}
