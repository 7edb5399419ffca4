//! A scene ready to be simplified: its meshes are conditioned, unless their topology is to be kept.

use meshlod_io::Scene;
use meshlod_mesh::{
    Borders, ConditionOptions, Conditioned, Conditioning, Locks, Mesh, NearBorders, condition,
    near_borders,
};
use meshlod_simplify::{Options, Report, Simplifier, SimplifyError, Target, Topology};

use crate::locks;

/// Smallest number of near boundary edges that is worth mentioning.
const MANY_EDGES: usize = 100;

/// Smallest part of all boundary edges that is worth mentioning, as its reciprocal.
const MANY_PARTS: usize = 20;

/// A scene ready to be simplified, with the options for it.
///
/// With [`Topology::Free`] borders that lie on each other are sewn together, and non-manifold
/// vertices are split, so that their copies move and are contracted freely; see [`condition`]. With
/// [`Topology::Keep`] all meshes are simplified as they are. The scene itself does not change.
pub struct ConditionedScene<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) options: Options,
    /// Conditioned meshes; `None` for those that are simplified as they are.
    meshes: Vec<Option<Conditioned>>,
    /// Locks of each mesh of the scene.
    locks: Vec<Locks>,
    counts: Conditioning,
}

impl<'s> ConditionedScene<'s> {
    /// Conditions every mesh that the scene shows, with the given treatment of borders that lie on
    /// each other.
    ///
    /// `options.locks` number vertices through all meshes of the scene, mesh after mesh, see
    /// [`join_locks`](crate::join_locks). Vertices tied across two meshes are locked, since meshes
    /// are simplified independently.
    ///
    /// Cost: O(n log n), n = boundary and non-manifold edges, and linear in all else.
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
        let mut counts = Conditioning::default();
        let mut meshes = Vec::with_capacity(scene.meshes.len());
        for ((mesh, locks), copies) in scene.meshes.iter().zip(&locks).zip(copies) {
            let is_shown = copies > 0;
            let found = is_shown.then(|| conditioned(&mesh.mesh, locks, options, borders)).flatten();
            for _ in 0..if found.is_some() { copies } else { 0 } {
                counts += found.as_ref().map_or_else(Conditioning::default, |found| found.counts);
            }
            meshes.push(found);
        }
        Ok(Self { scene, options: options.clone(), meshes, locks, counts })
    }

    /// Returns what has been changed in the meshes of the scene, counting every instance.
    pub fn counts(&self) -> Conditioning {
        self.counts
    }

    /// Returns the smallest distance by which welding would join most of the boundary edges that
    /// lie near each other, and their number; `None` if they are few.
    ///
    /// Looks for distances of about a millionth to a ten-thousandth of the diagonal of the largest
    /// mesh. Edges that lie exactly on each other are not counted where they have been sewn.
    ///
    /// Cost: as for [`near_borders`], at three distances.
    pub fn near_borders(&self) -> Option<NearBorders> {
        let all = 0..self.meshes.len();
        let meshes: Vec<&Mesh> =
            all.map(|mesh| self.mesh(mesh)).filter(|mesh| mesh.validate().is_ok()).collect();
        let diagonal = meshes.iter().map(|mesh| mesh.bounds().diagonal()).fold(0.0, f64::max);
        let power = diagonal.log10().floor();
        if !power.is_finite() {
            return None;
        }
        let distances = [-6.0, -5.0, -4.0].map(|below| 10_f64.powf(power + below));
        let mut found = distances
            .map(|distance| NearBorders { distance, boundary_edges: 0, near_edges: 0 });
        for mesh in meshes {
            let of_mesh = near_borders(mesh, &distances);
            found.iter_mut().zip(&of_mesh).for_each(|(all, own)| all.add(own));
        }
        let most = found[2].near_edges;
        let is_many = most >= MANY_EDGES && most * MANY_PARTS >= found[2].boundary_edges;
        let enough = |found: &NearBorders| found.near_edges * 10 >= most * 9;
        found.into_iter().filter(|_| is_many).find(enough)
    }

    /// Returns a mesh as it is simplified.
    pub(crate) fn mesh(&self, mesh: usize) -> &Mesh {
        match &self.meshes[mesh] {
            Some(found) => &found.mesh,
            None => &self.scene.meshes[mesh].mesh,
        }
    }

    /// Returns the options for a mesh as it is simplified.
    pub(crate) fn options(&self, mesh: usize) -> Options {
        match &self.meshes[mesh] {
            Some(found) => options_of(found, &self.options),
            None => Options { locks: self.locks[mesh].clone(), ..self.options.clone() },
        }
    }

    /// Returns true if a mesh has been conditioned.
    pub(crate) fn is_conditioned(&self, mesh: usize) -> bool {
        self.meshes[mesh].is_some()
    }

    /// Returns the number of faces that the conditioning of a mesh has left out.
    pub(crate) fn duplicate_faces(&self, mesh: usize) -> usize {
        self.meshes[mesh].as_ref().map_or(0, |found| found.counts.duplicate_faces)
    }

    /// Returns a level of a mesh in the terms of the scene.
    pub(crate) fn rejoined(&self, mesh: usize, mut level: Mesh) -> Mesh {
        if let Some(found) = &self.meshes[mesh] {
            found.rejoin(&mut level);
        }
        level
    }
}

/// Simplifies a mesh to a target number of faces or error, and returns the result with a report.
///
/// With [`Topology::Free`] the mesh is conditioned before, as a scene is: borders that lie on each
/// other are sewn together, and non-manifold vertices are split; see [`condition`]. The result
/// holds only what its faces use. If the target is out of reach, the mesh is reduced as far as the
/// rules allow, and the report says so and counts the reasons.
///
/// # Errors
/// The mesh, the target or an option is invalid, see [`SimplifyError`].
pub fn simplify(
    mesh: &Mesh,
    target: Target,
    options: &Options,
) -> Result<(Mesh, Report), SimplifyError> {
    let Some(found) = conditioned(mesh, &options.locks, options, Borders::Stitch) else {
        return meshlod_simplify::simplify(mesh, target, options);
    };
    let own = match target.valid()? {
        Target::Ratio(_) => Target::Faces(target.faces_of(mesh.faces.len())),
        target => target,
    };
    let mut simplifier = Simplifier::new(&found.mesh, &options_of(&found, options))?;
    let report = simplifier.run(own, &mut ())?;
    let mut level = simplifier.level();
    found.rejoin(&mut level);
    let duplicate_faces = report.duplicate_faces + found.counts.duplicate_faces;
    Ok((level, Report { input_faces: mesh.faces.len(), duplicate_faces, ..report }))
}

/// Conditions a mesh, unless its topology is to be kept. What is wrong with a mesh or its locks is
/// left to the simplifier to say.
fn conditioned(
    mesh: &Mesh,
    locks: &Locks,
    options: &Options,
    borders: Borders,
) -> Option<Conditioned> {
    let count = mesh.positions.len();
    let has_locks = locks.of_vertex.is_empty() || locks.of_vertex.len() == count;
    let is_tied = |v: &meshlod_mesh::VertexId| v.index() < count;
    let is_valid =
        has_locks && locks.ties.iter().flatten().all(is_tied) && mesh.validate().is_ok();
    if options.topology == Topology::Keep || !is_valid {
        return None;
    }
    condition(mesh, locks, &ConditionOptions { borders, lock_boundary: options.lock_boundary })
}

/// Returns the options for a conditioned mesh, whose locks include those of boundaries.
fn options_of(found: &Conditioned, options: &Options) -> Options {
    Options { locks: found.locks.clone(), lock_boundary: false, ..options.clone() }
}

#[cfg(test)]
mod tests;
