//! A mesh ready to be simplified: conditioned, unless its topology is to be kept.

use std::sync::OnceLock;

use meshlod_mesh::{
    Borders, ConditionOptions, Conditioned, Conditioning, Locks, Mesh, Search, condition,
};
use meshlod_simplify::{Options, Report, Simplifier, SimplifyError, Target, Topology, VolumeLoss};

use crate::bounded::run_within;

/// A mesh ready to be simplified, with the options for it.
pub(crate) struct ConditionedMesh<'m> {
    input: &'m Mesh,
    options: Options,
    /// Treatment of borders that lie on each other; `None` if the mesh is simplified as it is.
    borders: Option<Borders>,
    /// The mesh with its borders sewn, if there were any to sew.
    sewn: Option<Conditioned>,
    /// The mesh with all non-manifold vertices split too, once that has turned out to be needed.
    split: OnceLock<Option<Conditioned>>,
}

impl<'m> ConditionedMesh<'m> {
    /// Conditions a mesh at its borders, if a treatment for them is given and the topology need not
    /// be kept. What is wrong with a mesh or its locks is left to the simplifier to say.
    pub(crate) fn new(input: &'m Mesh, options: Options, borders: Option<Borders>) -> Self {
        let is_wanted = options.topology == Topology::Free
            && has_valid_locks(input, &options.locks)
            && input.validate().is_ok();
        let borders = borders.filter(|_| is_wanted);
        let mut this = Self { input, options, borders, sewn: None, split: OnceLock::new() };
        this.sewn = this.condition(Search::Unbalanced);
        this
    }

    fn condition(&self, search: Search) -> Option<Conditioned> {
        let lock_boundary = self.options.lock_boundary;
        let options = ConditionOptions { search, borders: self.borders?, lock_boundary };
        condition(self.input, &self.options.locks, &options)
    }

    /// Returns the conditioned mesh; `None` if the mesh is simplified as it is.
    fn conditioned(&self) -> Option<&Conditioned> {
        self.split.get().and_then(Option::as_ref).or(self.sewn.as_ref())
    }

    /// Returns what has been changed so far.
    pub(crate) fn counts(&self) -> Conditioning {
        self.conditioned().map_or_else(Conditioning::default, |found| found.counts)
    }

    /// Starts the simplification of the mesh. If non-manifold vertices turn up, they are split
    /// first.
    pub(crate) fn simplifier(
        &self,
        vanish_below: Option<f64>,
    ) -> Result<Simplifier<'_>, SimplifyError> {
        let first = self.start(vanish_below)?;
        let may_split = self.borders.is_some() && self.split.get().is_none();
        if !may_split || first.non_manifold_vertices() == 0 {
            return Ok(first);
        }
        match self.split.get_or_init(|| self.condition(Search::All)) {
            Some(_) => self.start(vanish_below),
            None => Ok(first),
        }
    }

    fn start(&self, vanish_below: Option<f64>) -> Result<Simplifier<'_>, SimplifyError> {
        let options = Options { vanish_below, ..self.options.clone() };
        match self.conditioned() {
            // The locks include those of boundaries.
            Some(found) => {
                let locks = found.locks.clone();
                let options = Options { locks, lock_boundary: false, ..options };
                Simplifier::new(&found.mesh, &options)
            }
            None => Simplifier::new(self.input, &options),
        }
    }

    /// Returns the current level in terms of the input, and notes in `loss` what it was repaid.
    pub(crate) fn settled_level(&self, simplifier: &Simplifier<'_>, loss: &mut VolumeLoss) -> Mesh {
        let mut level = simplifier.settled_level(loss);
        if let Some(found) = self.conditioned() {
            found.rejoin(&mut level);
        }
        level
    }
}

#[cfg(feature = "io")]
impl ConditionedMesh<'_> {
    /// Returns the mesh as it is simplified.
    pub(crate) fn mesh(&self) -> &Mesh {
        self.conditioned().map_or(self.input, |found| &found.mesh)
    }

    /// Returns the locks of the mesh as it is simplified.
    pub(crate) fn locks(&self) -> &Locks {
        self.conditioned().map_or(&self.options.locks, |found| &found.locks)
    }
}

/// Simplifies a mesh to a target number of faces or error, and returns the result with a report.
///
/// With [`Topology::Free`] the mesh is conditioned before, as a scene is: borders that lie on each
/// other are sewn together, and non-manifold vertices are split; see [`condition`]. The result
/// holds only what its faces use. If the target is out of reach, the mesh is reduced as far as the
/// rules allow, and the report says so and counts the reasons.
///
/// A [`Target::Error`] is proved: no point of the result is farther from the mesh, and no point of
/// the mesh farther from the result, in exact arithmetic on the positions in memory. Writing them
/// as 32-bit floats rounds them; `jobs::simplify` proves what is written. The [proof](Report::proof) in the report says so, or what holds
/// instead where an error as small as the rounding of positions is out of reach.
///
/// # Errors
/// The mesh, the target or an option is invalid, see [`SimplifyError`].
pub fn simplify(
    mesh: &Mesh,
    target: Target,
    options: &Options,
) -> Result<(Mesh, Report), SimplifyError> {
    let ready = ConditionedMesh::new(mesh, options.clone(), Some(Borders::Stitch));
    let own = match target.valid()? {
        Target::Ratio(_) => Target::Faces(target.faces_of(mesh.faces.len())),
        target => target,
    };
    let mut simplifier = ready.simplifier(options.vanish_below)?;
    let report = match own {
        Target::Error(error) => {
            let again = Some((&ready, options.vanish_below));
            run_within(again, &mut simplifier, error, &mut ())?
        }
        own => simplifier.run(own, &mut ())?,
    };
    let duplicate_faces = report.duplicate_faces + ready.counts().duplicate_faces;
    let mut report = Report { input_faces: mesh.faces.len(), duplicate_faces, ..report };
    Ok((ready.settled_level(&simplifier, &mut report.volume), report))
}

/// Returns true if locks are for the vertices of a mesh.
fn has_valid_locks(mesh: &Mesh, locks: &Locks) -> bool {
    let count = mesh.positions.len();
    let of_all = locks.of_vertex.is_empty() || locks.of_vertex.len() == count;
    of_all && locks.ties.iter().flatten().all(|v| v.index() < count)
}

#[cfg(all(test, feature = "io"))]
mod tests;
