//! Vertex locks for the meshes of a scene, at the places where they meet in world space.

use std::collections::BTreeMap;

use glam::{DMat3, DMat4};
use meshlod_check::{ContactPolicy, LockOptions, LockReason, VertexLocks, locks};
use meshlod_io::{MeshInstance, Scene, SceneMesh};
use meshlod_mesh::{Labels, Lock, Mesh, VertexId, first_near};

/// Computes vertex locks for each mesh of a scene, at the places where its meshes meet in world
/// space.
///
/// A mesh shown by several nodes gets the strictest lock of all its instances. Vertices of two
/// nodes at the same position are locked in place of tied, since meshes are simplified
/// independently. So are vertices that rounding to 32 bits may have separated: those within 2^-22
/// of their largest coordinate. By [`ContactPolicy::Protect`] both are protected instead.
///
/// Meshes that no node shows stay free. So do instances that a transform flattens to a plane, a
/// line or a point, which would meet themselves everywhere, and instances with infinite
/// coordinates.
///
/// Cost: that of [`locks`] for [`Scene::flatten`].
pub fn scene_locks(scene: &Scene, options: &LockOptions) -> Vec<VertexLocks> {
    let vertices = |mesh: &SceneMesh| mesh.mesh.positions.len();
    let mut of_meshes: Vec<VertexLocks> =
        scene.meshes.iter().map(|mesh| VertexLocks::free(vertices(mesh))).collect();
    let world = World::of(scene);
    let flat = locks(&world.mesh, options);
    for (i, home) in world.homes.iter().enumerate() {
        of_meshes[home.mesh].hold(home.vertex, flat.locks.of_vertex[i], flat.reasons[i]);
    }
    for tie in &flat.locks.ties {
        let members: Vec<Home> = tie.iter().map(|v| world.homes[v.index()]).collect();
        let own = |home: &Home| scene.meshes[home.mesh].mesh.positions[home.vertex.index()];
        // Rounding in world space may move vertices together that are apart in their mesh.
        let is_one =
            |home: &Home| home.instance == members[0].instance && own(home) == own(&members[0]);
        if members.iter().all(is_one) {
            let tie = members.iter().map(|home| home.vertex).collect();
            of_meshes[members[0].mesh].locks.ties.push(tie);
        } else {
            members.iter().for_each(|home| hold(&mut of_meshes, home, Lock::Locked));
        }
    }
    if let Some(policy) = options.contacts {
        let lock = match policy {
            ContactPolicy::Protect => Lock::Protected,
            ContactPolicy::Tie | ContactPolicy::Exclude => Lock::Locked,
        };
        world.near_across_nodes().iter().for_each(|home| hold(&mut of_meshes, home, lock));
    }
    of_meshes.iter_mut().for_each(VertexLocks::resolve_ties);
    of_meshes
}

fn hold(of_meshes: &mut [VertexLocks], home: &Home, lock: Lock) {
    of_meshes[home.mesh].hold(home.vertex, lock, Some(LockReason::SharedPosition));
}

/// All instances of a scene in world space, without flattened ones.
struct World {
    mesh: Mesh,
    /// Origin of each vertex.
    homes: Vec<Home>,
}

/// A vertex of a mesh, in the instance of a node.
#[derive(Clone, Copy)]
struct Home {
    /// Index of the instance, as a node may show several.
    instance: usize,
    mesh: usize,
    vertex: VertexId,
}

/// Largest distance that rounding to 32 bits separates equal points by, relative to their largest
/// coordinate: one unit in the last place per axis, 2^-23, and 1.74 times that in space.
const ROUNDING: f64 = 1.0 / (1 << 22) as f64;

impl World {
    fn of(scene: &Scene) -> Self {
        let mut this = Self { mesh: Mesh::default(), homes: Vec::new() };
        let mut objects = Labels::default();
        for (instance, placed) in scene.instances().into_iter().enumerate() {
            let MeshInstance { mesh, transform, .. } = placed;
            let transform = DMat4::from_cols_array_2d(&transform);
            if flattens(&DMat3::from_mat4(transform)) {
                continue;
            }
            let own = &scene.meshes[mesh].mesh;
            let first = this.homes.len();
            let moved = own.positions.iter().map(|&p| transform.transform_point3(p.into()));
            let moved: Vec<[f64; 3]> = moved.map(Into::into).collect();
            if !moved.iter().flatten().all(|x| x.is_finite()) {
                continue;
            }
            this.mesh.positions.extend(moved);
            let placed = |face: &[VertexId; 3]| face.map(|v| VertexId::new(first + v.index()));
            this.mesh.faces.extend(own.faces.iter().map(placed));
            let base = objects.names.len() as u32;
            match &own.objects {
                Some(labels) => {
                    objects.names.extend_from_slice(&labels.names);
                    objects.of_face.extend(labels.of_face.iter().map(|label| base + label));
                }
                None => {
                    objects.names.push(String::new());
                    objects.of_face.resize(this.mesh.faces.len(), base);
                }
            }
            let vertices = (0..own.positions.len()).map(VertexId::new);
            this.homes.extend(vertices.map(|vertex| Home { instance, mesh, vertex }));
        }
        this.mesh.objects = Some(objects);
        this
    }

    /// Returns the vertices at the same position as one of another instance, up to rounding.
    fn near_across_nodes(&self) -> Vec<Home> {
        let mut across = Vec::new();
        let ends =
            [self.homes.first(), self.homes.last()].map(|home| home.map(|home| home.instance));
        if ends[0] == ends[1] {
            return across;
        }
        for (octave, homes) in self.by_octave() {
            let at = |&v: &usize| self.mesh.positions[v];
            let points: Vec<[f64; 3]> = homes.iter().map(at).collect();
            let near = first_near(&points, ROUNDING * f64::from_bits((octave + 1) << 52));
            let mut nodes: Vec<Option<usize>> = vec![None; homes.len()];
            let mut is_across = vec![false; homes.len()];
            for (&v, &place) in homes.iter().zip(&near) {
                let node = self.homes[v].instance;
                is_across[place as usize] |= *nodes[place as usize].get_or_insert(node) != node;
            }
            let held = homes.iter().zip(&near).filter(|(_, place)| is_across[**place as usize]);
            across.extend(held.map(|(&v, _)| self.homes[v]));
        }
        across
    }

    /// Groups the vertices that faces use by the exponent of their largest coordinate, which
    /// determines their rounding. Vertices close to the lower end of an octave are in the octave
    /// below too.
    fn by_octave(&self) -> BTreeMap<u64, Vec<usize>> {
        let used = self.mesh.used_vertices();
        let mut octaves: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        for (v, position) in self.mesh.positions.iter().enumerate().filter(|&(v, _)| used[v]) {
            let size = position.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let [own, below] = [size, size * (1.0 - 2.0 * ROUNDING)].map(|x| x.to_bits() >> 52);
            octaves.entry(own).or_default().push(v);
            if below != own {
                octaves.entry(below).or_default().push(v);
            }
        }
        octaves
    }
}

/// Returns true if a transform flattens volumes, up to rounding and whatever the lengths of its
/// axes.
fn flattens(linear: &DMat3) -> bool {
    let axes = [linear.x_axis, linear.y_axis, linear.z_axis].map(|axis| axis.normalize_or_zero());
    let [x, y, z] = axes;
    let volume = x.dot(y.cross(z)).abs();
    !linear.is_finite() || volume < 1e-12
}

#[cfg(test)]
mod tests {
    use meshlod_io::Node;
    use meshlod_mesh::Mesh;
    use meshlod_samples as samples;

    use super::*;

    const CONTACTS: LockOptions =
        LockOptions { contacts: Some(ContactPolicy::Tie), boundary: Lock::Free };

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
    fn meshes_that_cross_in_the_world_are_protected_there() {
        let balls = |x| {
            let meshes = vec![samples::sphere(500); 3];
            scene_locks(&scene(meshes, vec![at(0.0, 0), at(x, 1)]), &CONTACTS)
        };
        let held = |of: &VertexLocks| of.locks.of_vertex.contains(&Lock::Protected);
        assert_eq!(balls(1.5).iter().map(held).collect::<Vec<_>>(), [true, true, false]);
        assert_eq!(balls(2.5).iter().map(held).collect::<Vec<_>>(), [false; 3]);
    }

    #[test]
    fn a_mesh_shown_twice_is_held_wherever_it_is() {
        let held = scene_locks(&scene(vec![square()], vec![at(0.0, 0), at(1.0, 0)]), &CONTACTS);
        // Side by side: the right side of one at the left side of the other.
        assert_eq!(held[0].locks.of_vertex, [Lock::Locked; 4]);
        assert!(held[0].locks.ties.is_empty());
        assert_eq!(held[0].count(LockReason::SharedPosition), 4);
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

    #[test]
    fn what_the_world_squeezes_is_free() {
        let ball = || scene(vec![samples::sphere(500)], vec![at(0.0, 0), at(9.0, 0)]);
        for scale in [[1.0, 1.0, 0.0], [0.0, 0.0, 0.0], [1e-30, 0.0, 1.0]] {
            let mut squeezed = ball();
            let turn = glam::DQuat::from_xyzw(0.1, 0.7, -0.3, 0.5).normalize();
            let flat = DMat4::from_scale(scale.into()) * DMat4::from_quat(turn);
            squeezed.nodes[1].transform = flat.to_cols_array_2d();
            assert_eq!(scene_locks(&squeezed, &CONTACTS), scene_locks(&ball(), &CONTACTS));
        }
        // What is only thin is there.
        let mut thin = scene(vec![samples::sphere(500)], vec![at(0.0, 0), at(0.5, 0)]);
        thin.nodes[1].transform[0][0] = 1e-6;
        thin.nodes[1].transform[1][1] = 1e-6;
        assert!(scene_locks(&thin, &CONTACTS)[0].locks.of_vertex.contains(&Lock::Protected));
    }

    #[test]
    fn borders_that_rounding_has_parted_are_locked() {
        let held = |x: f64, gap: f64| {
            let mut right = square();
            right.positions.iter_mut().for_each(|p| p[0] += gap);
            // Far away rounding is coarser; that is no matter here.
            let mut far = square();
            far.positions.iter_mut().for_each(|p| p[2] += 1e6);
            let nodes = vec![at(x, 0), at(x + 1.0, 1), at(0.0, 2)];
            let held = scene_locks(&scene(vec![square(), right, far], nodes), &CONTACTS);
            held.iter().map(|of| of.count(LockReason::SharedPosition)).collect::<Vec<_>>()
        };
        let ulp = f64::from(f32::EPSILON);
        assert_eq!(held(100.0, 64.0 * ulp), [2, 2, 0]);
        assert_eq!(held(100.0, 512.0 * ulp), [0, 0, 0]);
        // Of two octaves: the border is at 128, a little less and a little more.
        assert_eq!(held(127.0 - 32.0 * ulp, 64.0 * ulp), [2, 2, 0]);
        assert_eq!(held(1.0, ulp), [2, 2, 0]);
        assert_eq!(held(1.0, 64.0 * ulp), [0, 0, 0]);
    }

    #[test]
    fn what_goes_beyond_numbers_is_free() {
        let mut huge = scene(vec![square(), square()], vec![at(0.0, 0), at(0.0, 1)]);
        huge.nodes[1].transform[0][0] = f64::MAX;
        huge.nodes[1].transform[3][0] = f64::MAX;
        let held = scene_locks(&huge, &CONTACTS);
        assert!(held.iter().all(|of| of.locks.of_vertex == [Lock::Free; 4]));
    }

    #[test]
    fn what_only_the_world_brings_together_is_locked() {
        // Far away the two sides of the gap are one number.
        let mut mesh = square();
        let mut other = square();
        other.positions.iter_mut().for_each(|p| p[0] += 1.0 + 1e-9);
        mesh.faces.extend(other.faces.iter().map(|face| face.map(|v| VertexId(v.0 + 4))));
        mesh.positions.extend(other.positions);
        let held = &scene_locks(&scene(vec![mesh], vec![at(1e9, 0)]), &CONTACTS)[0];
        assert!(held.locks.ties.is_empty());
        assert_eq!(held.count(LockReason::SharedPosition), 4);
    }
}
