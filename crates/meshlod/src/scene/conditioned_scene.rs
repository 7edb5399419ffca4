//! Scenes ready to be simplified: their meshes conditioned, unless their topology is to be kept.

use meshlod_io::{Scene, SceneMesh};
use meshlod_mesh::{Borders, Conditioning, Mesh, NearBorders, is_balanced, near_borders};
use meshlod_simplify::{Options, SimplifyError, Target};

use crate::conditioned::{ConditionedMesh, FlatFaces};
use crate::scene::{locks, place};

/// Smallest number of near boundary edges that is worth mentioning.
const MANY_EDGES: usize = 100;

/// Smallest part of all boundary edges that is worth mentioning, as its reciprocal.
const MANY_PARTS: usize = 20;

/// A scene ready to be simplified, with the options for it.
///
/// With [`Topology::Free`] borders that lie on each other are sewn together, and non-manifold
/// vertices are split, so that their copies move and are contracted freely; see [`condition`]. With
/// [`Topology::Keep`] all meshes are simplified as they are. The scene itself does not change.
///
/// [`Topology::Free`]: crate::Topology::Free
/// [`Topology::Keep`]: crate::Topology::Keep
/// [`condition`]: meshlod_mesh::condition
pub struct ConditionedScene<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) options: Options,
    pub(crate) meshes: Vec<ConditionedMesh<'s>>,
    /// Number of nodes that show each mesh.
    pub(crate) copies: Vec<usize>,
}

impl<'s> ConditionedScene<'s> {
    /// Conditions every mesh that the scene shows, with the given treatment of borders that lie on
    /// each other.
    ///
    /// `options.locks` number vertices through all meshes of the scene, mesh after mesh, see
    /// [`join_locks`](crate::scene::join_locks). Vertices tied across two meshes are locked, since meshes
    /// are simplified independently.
    ///
    /// Cost: linear, with a sort of the boundary edges. Non-manifold vertices are split only when
    /// a simplifier finds some. A mesh with a single-sided material is simplified with
    /// [`Options::single_sided`].
    /// # Errors
    /// Locks of another length.
    pub fn new(
        scene: &'s Scene,
        options: &Options,
        borders: Borders,
    ) -> Result<Self, SimplifyError> {
        let locks = locks::split(scene, &options.locks)?;
        let mut copies = vec![0; scene.meshes.len()];
        scene.instances().iter().for_each(|placed| copies[placed.mesh] += 1);
        let parts = scene.meshes.iter().zip(locks).zip(&copies);
        let meshes = parts.map(|((mesh, locks), &copies)| {
            let single_sided = options.single_sided || has_single_sides(scene, mesh);
            let options = Options { locks, single_sided, ..options.clone() };
            ConditionedMesh::new(&mesh.mesh, options, (copies > 0).then_some(borders))
        });
        Ok(Self { scene, options: options.clone(), meshes: meshes.collect(), copies })
    }

    /// Gives the flats of every mesh as few faces as they need, without moving anything by more than
    /// an error, in world units.
    fn flatten_within(&mut self, error: f64) {
        let sizes = place::sizes(self.scene);
        for (mesh, size) in self.meshes.iter_mut().zip(sizes).filter(|(_, size)| *size > 0.0) {
            mesh.flatten_within(error / size);
        }
    }

    /// Gives flats as few faces as they need before a run to a target: before an error those that are
    /// within it, before a number of faces those that are exact, if as many are left as are wanted or
    /// down to a quarter. From there on a run by itself moves nothing, either, and leaves as many as were
    /// wanted.
    ///
    /// Cost: O(n log n), n = faces; before a number of faces only of meshes where a sample shows flats.
    pub fn flatten_before(&mut self, target: Target) {
        if let Target::Error(error) = target {
            return self.flatten_within(error);
        }
        let counts = self.meshes.iter().zip(&self.copies);
        let all: usize = counts.map(|(mesh, copies)| copies * mesh.face_count()).sum();
        let faces = target.faces_of(all);
        let mut needs = vec![None; self.meshes.len()];
        let mut left = 0;
        for (i, mesh) in self.meshes.iter_mut().enumerate().filter(|(i, _)| self.copies[*i] > 0) {
            let most = faces.saturating_sub(left) / self.copies[i];
            needs[i] = mesh.needs(most);
            left += self.copies[i] * needs[i].unwrap_or_else(|| mesh.face_count());
        }
        // Faces that are there twice may have gone since.
        let counts = self.meshes.iter().zip(&self.copies);
        let all = counts.map(|(mesh, copies)| copies * mesh.face_count()).sum();
        if !FlatFaces::may_be_worth(left, all, faces) {
            return;
        }
        let flat = self.meshes.iter_mut().zip(needs).filter(|(_, needs)| needs.is_some());
        flat.for_each(|(mesh, _)| mesh.flatten_within(0.0));
        let is_worth = |flats: FlatFaces| flats.are_worth(all, faces);
        if !self.flat_faces().is_some_and(is_worth) {
            self.meshes.iter_mut().for_each(ConditionedMesh::keep_flats);
        }
    }

    /// Returns what became of the flats of the scene, counting every instance; `None` if nothing was
    /// [flattened](Self::flatten_before).
    pub fn flat_faces(&self) -> Option<FlatFaces> {
        if self.meshes.iter().all(|mesh| mesh.flats().is_none()) {
            return None;
        }
        let mut all = FlatFaces::default();
        for (mesh, copies) in self.meshes.iter().zip(&self.copies) {
            let (gone, needed) =
                mesh.flats().map_or((0, mesh.face_count()), |f| (f.gone, f.needed));
            all.gone += copies * gone;
            all.needed += copies * needed;
        }
        Some(all)
    }

    /// Returns how many faces that are there twice had been left out before flats went, counting every
    /// instance.
    pub fn duplicates_before_flats(&self) -> usize {
        let all = self.meshes.iter().zip(&self.copies);
        all.map(|(mesh, copies)| copies * mesh.duplicates_before_flats()).sum()
    }

    /// Returns what has been changed so far in the meshes of the scene, counting every instance.
    pub fn counts(&self) -> Conditioning {
        let mut all = Conditioning::default();
        for (mesh, &copies) in self.meshes.iter().zip(&self.copies) {
            (0..copies).for_each(|_| all += mesh.counts());
        }
        all
    }

    /// Returns the smallest distance by which welding would join most of the boundary edges that
    /// lie near each other, and their number; `None` if they are few.
    ///
    /// Looks for distances of about a millionth to a ten-thousandth of the diagonal of the largest
    /// mesh. Edges that lie exactly on each other are not counted where they have been sewn.
    ///
    /// Cost: as for [`near_borders`], at three distances.
    pub fn near_borders(&self) -> Option<NearBorders> {
        let valid = |mesh: &&Mesh| mesh.validate().is_ok();
        let meshes: Vec<&Mesh> =
            self.meshes.iter().map(ConditionedMesh::mesh).filter(valid).collect();
        // A mesh without a boundary has nothing near.
        if meshes.iter().all(|mesh| is_balanced(mesh)) {
            return None;
        }
        let diagonal = meshes.iter().map(|mesh| mesh.bounds().diagonal()).fold(0.0, f64::max);
        let power = diagonal.log10().floor();
        if !power.is_finite() {
            return None;
        }
        let distances = [-6.0, -5.0, -4.0].map(|below| 10_f64.powf(power + below));
        let none = |distance| NearBorders { distance, boundary_edges: 0, near_edges: 0 };
        let mut found = distances.map(none);
        for mesh in meshes {
            let of_mesh = near_borders(mesh, &distances);
            found.iter_mut().zip(&of_mesh).for_each(|(all, own)| all.add(own));
        }
        let most = found.iter().map(|found| found.near_edges).max()?;
        let is_many = most >= MANY_EDGES && most * MANY_PARTS >= found[0].boundary_edges;
        let enough = |found: &NearBorders| found.near_edges * 10 >= most * 9;
        found.into_iter().filter(|_| is_many).find(enough)
    }
}

/// Returns true if a face of a mesh has a material that is seen from its front only.
fn has_single_sides(scene: &Scene, mesh: &SceneMesh) -> bool {
    mesh.materials.iter().flatten().any(|&material| !scene.materials[material].is_double_sided)
}
