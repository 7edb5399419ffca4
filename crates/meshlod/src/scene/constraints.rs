//! Constraints on a simplification: what it must keep of a scene, whichever call does it.

use meshlod_check::{ContactPolicy, Fused, LockOptions};
use meshlod_io::Scene;
use meshlod_mesh::{Borders, Lock, Locks, Mesh, VertexId};
use meshlod_simplify::{Options, SimplifyError, Topology};

use crate::Bound;
use crate::scene::contacts::scene_locks;
use crate::scene::fuse::fuse_scene;
use crate::scene::locks::join_locks;
use crate::scene::place::world_bounds;

/// Constraints on a simplification: its topology, its boundaries, and vertices that stay.
///
/// They mean the same for every kind of output: a single level, a chain, a multiresolution file or
/// strips. First [`fuse`](Self::fuse) prepares the scene; then [`options`](Self::options) gives the
/// options for its meshes, or [`flatten`](Self::flatten) a single mesh with its options.
///
/// ```
/// use meshlod::check::ContactPolicy;
/// use meshlod::{Constraints, Options, Scene, Target, VertexLocking, samples, simplify};
///
/// let ground = Scene::from_mesh("ground", samples::terrain(4_000));
/// let locks = VertexLocking::Contacts(ContactPolicy::Exclude);
/// let constraints = Constraints { locks, lock_boundary: true, ..Constraints::default() };
/// let (ground, options) = constraints.flatten(ground, Options::default())?;
/// let (_, report) = simplify(&ground, Target::Ratio(0.25), &options)?;
/// assert!(report.held.locked > 0);
/// # Ok::<(), meshlod::SimplifyError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Constraints {
    /// Changes that are allowed to the topology of the surface.
    pub topology: Topology,
    /// Treatment of boundary edges that lie on each other.
    pub borders: Borders,
    /// Largest component that may vanish, by the diagonal of its bounding box; see
    /// [`Options::vanish_below`].
    pub vanish_below: Option<Bound>,
    /// True to unite closed components that intersect before anything else; see [`fuse_scene`].
    pub fuse: bool,
    /// True to lock every vertex of a boundary edge.
    pub lock_boundary: bool,
    /// Locks of single vertices.
    pub locks: VertexLocking,
}

/// Source of the locks of single vertices.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum VertexLocking {
    /// No vertex is locked.
    #[default]
    None,
    /// Vertices are held where components meet.
    Contacts(ContactPolicy),
    /// The locks of the meshes of the scene, in its order; meshes at the end may be left out.
    ///
    /// They number the vertices before anything is fused, so they do not go with
    /// [`Constraints::fuse`].
    Given(Vec<Locks>),
}

impl Constraints {
    /// Fuses the intersecting components of a scene, if that is asked for; see [`fuse_scene`].
    pub fn fuse(&self, scene: &mut Scene) -> Option<Fused> {
        self.fuse.then(|| fuse_scene(scene))
    }

    /// Adds the constraints to the options for the simplification of a scene; its locks number
    /// vertices through all meshes, see [`join_locks`].
    ///
    /// Cost: linear, or that of [`scene_locks`] for contacts.
    /// # Errors
    /// Locks that do not match the scene.
    pub fn options(&self, scene: &Scene, options: Options) -> Result<Options, SimplifyError> {
        let locks = join_locks(scene, &self.locks_of_meshes(scene))?;
        Ok(self.with_locks(locks, scene, options))
    }

    /// Merges a scene into one mesh in world space, and adds the constraints to the options for the
    /// simplification of that mesh.
    ///
    /// Cost: linear, or that of [`scene_locks`] for contacts.
    /// # Errors
    /// Locks that do not match the scene.
    pub fn flatten(
        &self,
        scene: Scene,
        options: Options,
    ) -> Result<(Mesh, Options), SimplifyError> {
        let locks = flat_locks(&scene, &self.locks_of_meshes(&scene))?;
        let options = self.with_locks(locks, &scene, options);
        Ok((scene.into_mesh(), options))
    }

    pub(crate) fn locks_of_meshes(&self, scene: &Scene) -> Vec<Locks> {
        match &self.locks {
            VertexLocking::None => Vec::new(),
            VertexLocking::Given(locks) => locks.clone(),
            VertexLocking::Contacts(policy) => {
                let contacts = LockOptions { contacts: Some(*policy), boundary: Lock::Free };
                scene_locks(scene, &contacts).into_iter().map(|held| held.locks).collect()
            }
        }
    }

    fn with_locks(&self, locks: Locks, scene: &Scene, options: Options) -> Options {
        let Self { topology, lock_boundary, .. } = *self;
        let length = |bound: Bound| bound.length(world_bounds(scene).diagonal());
        let vanish_below = self.vanish_below.map(length);
        Options { topology, vanish_below, lock_boundary, locks, ..options }
    }
}

/// Returns the locks of the vertices of a flattened scene, from those of its meshes.
fn flat_locks(scene: &Scene, of_meshes: &[Locks]) -> Result<Locks, SimplifyError> {
    // Refuses what does not match, and locks ties of vertices that are apart.
    let joined = join_locks(scene, of_meshes)?;
    if joined == Locks::default() {
        return Ok(joined);
    }
    let of_meshes = crate::scene::locks::split(scene, &joined)?;
    let mut flat = Locks::default();
    for placed in scene.instances() {
        let (own, base) = (&of_meshes[placed.mesh], flat.of_vertex.len());
        flat.of_vertex.extend_from_slice(&own.of_vertex);
        let moved = |tie: &Vec<VertexId>| {
            tie.iter().map(|v| VertexId::new(base + v.index())).collect::<Vec<_>>()
        };
        flat.ties.extend(own.ties.iter().map(moved));
    }
    Ok(flat)
}

#[cfg(test)]
mod tests {
    use meshlod_io::{Node, SceneMesh};
    use meshlod_samples as samples;

    use super::*;

    /// A scene that shows one torus twice, with a sphere between the two.
    fn scene() -> Scene {
        let meshes = [samples::torus(100), samples::sphere(100)];
        let meshes = meshes.map(|mesh| SceneMesh { mesh, ..SceneMesh::default() }).to_vec();
        let node = |(i, mesh): (usize, usize)| {
            let mut node = Node { mesh: Some(mesh), ..Node::default() };
            node.transform[3][0] = 100.0 * i as f64;
            node
        };
        let nodes: Vec<Node> = [0, 1, 0].into_iter().enumerate().map(node).collect();
        Scene { meshes, roots: vec![0, 1, 2], nodes, ..Scene::default() }
    }

    #[test]
    fn locks_follow_the_vertices_of_every_instance() {
        let scene = scene();
        let count = |mesh: usize| scene.meshes[mesh].mesh.positions.len();
        let mut of_vertex = vec![Lock::Free; count(0)];
        of_vertex[3] = Lock::Locked;
        let given = vec![Locks { of_vertex, ties: Vec::new() }];
        let locks = VertexLocking::Given(given);
        let constraints = Constraints { locks, ..Constraints::default() };
        let (mesh, options) = constraints.flatten(scene.clone(), Options::default()).unwrap();
        assert_eq!(options.locks.of_vertex.len(), mesh.positions.len());
        let locked = (0..mesh.positions.len())
            .filter(|&v| options.locks.of(VertexId::new(v)) == Lock::Locked);
        assert_eq!(locked.collect::<Vec<_>>(), [3, count(0) + count(1) + 3]);
        let joined = constraints.options(&scene, Options::default()).unwrap().locks;
        assert_eq!(joined.of_vertex.len(), count(0) + count(1));
    }

    #[test]
    fn locks_of_another_scene_are_refused() {
        let given = vec![Locks { of_vertex: vec![Lock::Locked; 7], ties: Vec::new() }];
        let locks = VertexLocking::Given(given);
        let constraints = Constraints { locks, ..Constraints::default() };
        assert!(constraints.options(&scene(), Options::default()).is_err());
        assert!(constraints.flatten(scene(), Options::default()).is_err());
    }

    #[test]
    fn every_constraint_reaches_the_options() {
        let constraints = Constraints {
            topology: Topology::Keep,
            vanish_below: Some(Bound::Length(2.0)),
            lock_boundary: true,
            ..Constraints::default()
        };
        let options = constraints.options(&scene(), Options::default()).unwrap();
        assert_eq!((options.topology, options.vanish_below), (Topology::Keep, Some(2.0)));
        assert!(options.lock_boundary && options.locks == Locks::default());
    }
}
