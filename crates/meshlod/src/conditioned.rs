//! A mesh ready to be simplified: conditioned, unless its topology is to be kept.

use std::sync::OnceLock;

use meshlod_mesh::{
    Borders, ConditionOptions, Conditioned, Conditioning, Locks, Mesh, Search, condition,
};
use meshlod_simplify::{
    FlatOptions, Flattened, Options, Report, Simplifier, SimplifyError, Target, Topology,
    VolumeLoss, flat_needs, flat_part, flatten,
};

use crate::bounded::{Tightness, run_within};

/// Part of the largest coordinate by which what is flat may be off: rounding to 32 bits moves planes
/// and lines in any direction by less.
const FLAT: f64 = 1.0 / (1 << 20) as f64;

/// Faces that flats have lost and need, in a mesh or in all meshes of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FlatFaces {
    /// Number of faces that went, since what is flat can do without them.
    pub gone: usize,
    /// Number of faces that the shape needs: the fewest with the same corners of flats.
    pub needed: usize,
}

impl FlatFaces {
    /// Returns true if flats should go before a run from `all` faces, to some number of them. A run to
    /// fewer than they leave would start with their long thin faces, which makes some levels worse
    /// (docs/notes/kernel.md).
    pub(crate) fn are_worth(self, all: usize, target: usize) -> bool {
        let left = all - self.gone;
        Self::may_be_worth(left, all, target) && target < AMPLE * left
    }

    /// Returns true if flats may be worth it that leave this many faces of `all`, or more.
    pub(crate) fn may_be_worth(left: usize, all: usize, target: usize) -> bool {
        WORTH * (all - left.min(all)) >= all && left <= target
    }
}

/// Part of the faces that must be flat, by a sample, for flats to go before a run to a number of
/// faces.
const FLAT_PART: f64 = 1.0 / 32.0;

/// Part of the faces, one in this many, that have to go with the flats before such a run.
const WORTH: usize = 16;

/// Multiple of the faces that flats leave, from which on a run by itself moves nothing, either, and
/// leaves as many as were asked for.
const AMPLE: usize = 4;

/// A mesh ready to be simplified, with the options for it.
pub(crate) struct ConditionedMesh<'m> {
    input: &'m Mesh,
    options: Options,
    /// Treatment of borders that lie on each other; `None` if the mesh is simplified as it is.
    borders: Option<Borders>,
    /// The mesh with its borders sewn, if there were any to sew.
    sewn: Option<Conditioned>,
    /// That mesh with as few faces as its flats need, if that has been asked for.
    flat: Option<Flattened>,
    /// That mesh with all non-manifold vertices split, once that has turned out to be needed.
    split: OnceLock<Option<Conditioned>>,
}

/// A mesh with the constraints on its vertices.
#[derive(Clone, Copy)]
struct Held<'c> {
    mesh: &'c Mesh,
    locks: &'c Locks,
    lock_boundary: bool,
}

impl<'c> Held<'c> {
    fn of(conditioned: &'c Conditioned) -> Self {
        // The locks include those of boundaries.
        Self { mesh: &conditioned.mesh, locks: &conditioned.locks, lock_boundary: false }
    }

    fn condition(&self, borders: Borders, search: Search) -> Option<Conditioned> {
        let options = ConditionOptions { search, borders, lock_boundary: self.lock_boundary };
        condition(self.mesh, self.locks, &options)
    }

    fn flat_options(&self, tolerance: f64) -> FlatOptions<'c> {
        FlatOptions { locks: self.locks, lock_boundary: self.lock_boundary, tolerance }
    }
}

impl<'m> ConditionedMesh<'m> {
    /// Conditions a mesh at its borders, if a treatment for them is given and the topology need not
    /// be kept. What is wrong with a mesh or its locks is left to the simplifier to say.
    pub(crate) fn new(input: &'m Mesh, options: Options, borders: Option<Borders>) -> Self {
        let is_wanted = options.topology == Topology::Free
            && has_valid_locks(input, &options.locks)
            && input.validate().is_ok();
        let borders = borders.filter(|_| is_wanted);
        let (sewn, flat) = (None, None);
        let mut this = Self { input, options, borders, sewn, flat, split: OnceLock::new() };
        this.sewn =
            this.borders.and_then(|borders| this.unsplit().condition(borders, Search::Unbalanced));
        this
    }

    /// Gives the flats of the mesh as few faces as they need, without moving the surface by more
    /// than an error, in units of the mesh.
    pub(crate) fn flatten_within(&mut self, error: f64) {
        if !has_valid_locks(self.input, &self.options.locks) || self.input.validate().is_err() {
            return;
        }
        let tolerance = error.min(FLAT * self.largest_coordinate());
        let flattened = |this: &Self| {
            let whole = this.unsplit();
            flatten(whole.mesh, &whole.flat_options(tolerance))
        };
        let mut flat = flattened(self);
        // Within a tolerance copies at one place would move apart.
        if flat.is_crowded && tolerance == 0.0 && self.split_all() {
            flat = flattened(self);
        }
        self.flat = Some(flat);
    }

    /// Returns how many faces the mesh needs for its flats, without moving anything, or once it is more
    /// than `most`, a lower bound; `None` if a sample shows none.
    pub(crate) fn needs(&mut self, most: usize) -> Option<usize> {
        let is_valid =
            has_valid_locks(self.input, &self.options.locks) && self.input.validate().is_ok();
        if !is_valid || flat_part(self.input) < FLAT_PART {
            return None;
        }
        let needs = |this: &Self| {
            let whole = this.unsplit();
            flat_needs(whole.mesh, &whole.flat_options(0.0), most)
        };
        let mut found = needs(self);
        if found.is_crowded && self.split_all() {
            found = needs(self);
        }
        Some(found.faces)
    }

    /// Conditions the mesh at all its vertices, if that is wanted: sheets on the same vertices are not
    /// found otherwise. Returns true if that has changed anything.
    fn split_all(&mut self) -> bool {
        let whole = self.borders.and_then(|borders| self.held().condition(borders, Search::All));
        let is_changed = whole.is_some();
        self.sewn = whole.or_else(|| self.sewn.take());
        is_changed
    }

    /// Returns the number of faces of the mesh with its flats as they were.
    pub(crate) fn face_count(&self) -> usize {
        self.sewn.as_ref().map_or(self.input, |sewn| &sewn.mesh).faces.len()
    }

    /// Undoes what has been done to flats.
    pub(crate) fn keep_flats(&mut self) {
        self.flat = None;
    }

    /// Returns the largest coordinate: one that the mesh has, or would have if the origin were in its
    /// middle, since nothing has been rounded to 32 bits if its coordinates have more.
    fn largest_coordinate(&self) -> f64 {
        let bounds = self.input.bounds();
        let is_rounded = |&x: &f64| x == f64::from(x as f32);
        if !self.input.positions.as_flattened().iter().all(is_rounded) {
            return bounds.diagonal() / 2.0;
        }
        bounds.min.into_iter().chain(bounds.max).map(f64::abs).fold(0.0, f64::max)
    }

    /// Returns what became of the flats of the mesh; `None` if that has not been asked for.
    pub(crate) fn flats(&self) -> Option<FlatFaces> {
        let Flattened { mesh, needed_faces, .. } = self.flat.as_ref()?;
        let before = self.face_count();
        let left = mesh.as_ref().map_or(before, |mesh| mesh.faces.len());
        Some(FlatFaces { gone: before - left, needed: *needed_faces })
    }

    /// Returns how far the surface has moved before it is simplified.
    pub(crate) fn moved(&self) -> f64 {
        self.flat.as_ref().map_or(0.0, |flat| flat.moved)
    }

    /// Returns the mesh as it came in.
    fn held(&self) -> Held<'_> {
        let Options { locks, lock_boundary, .. } = &self.options;
        Held { mesh: self.input, locks, lock_boundary: *lock_boundary }
    }

    /// Returns the mesh before non-manifold vertices are split.
    fn unsplit(&self) -> Held<'_> {
        let sewn = self.sewn.as_ref().map_or(self.held(), Held::of);
        let flat = self.flat.as_ref().and_then(|flat| flat.mesh.as_ref());
        Held { mesh: flat.unwrap_or(sewn.mesh), ..sewn }
    }

    /// Returns the mesh as it is simplified.
    fn whole(&self) -> Held<'_> {
        self.split.get().and_then(Option::as_ref).map_or_else(|| self.unsplit(), Held::of)
    }

    /// Returns what the mesh went through, the last first.
    fn stages(&self) -> impl Iterator<Item = &Conditioned> {
        self.split.get().and_then(Option::as_ref).into_iter().chain(&self.sewn)
    }

    /// Returns what has been changed so far.
    pub(crate) fn counts(&self) -> Conditioning {
        let mut counts = Conditioning::default();
        self.stages().for_each(|stage| counts += stage.counts);
        counts
    }

    /// Starts the simplification of the mesh. If non-manifold vertices turn up, they are split
    /// first.
    pub(crate) fn simplifier(
        &self,
        vanish_below: Option<f64>,
    ) -> Result<Simplifier<'_>, SimplifyError> {
        let Some(borders) = self.borders.filter(|_| self.split.get().is_none()) else {
            return Simplifier::new(self.whole().mesh, &self.own_options(vanish_below));
        };
        if let Some(manifold) =
            Simplifier::of_manifold(self.whole().mesh, &self.own_options(vanish_below))?
        {
            return Ok(manifold);
        }
        self.split.get_or_init(|| self.unsplit().condition(borders, Search::All));
        Simplifier::new(self.whole().mesh, &self.own_options(vanish_below))
    }

    /// Returns the options for the mesh as it is simplified.
    fn own_options(&self, vanish_below: Option<f64>) -> Options {
        let Held { locks, lock_boundary, .. } = self.whole();
        let locks = locks.clone();
        Options { vanish_below, locks, lock_boundary, ..self.options.clone() }
    }

    /// Returns the current level in terms of the input, and notes in `loss` what it was repaid.
    pub(crate) fn settled_level(&self, simplifier: &Simplifier<'_>, loss: &mut VolumeLoss) -> Mesh {
        let mut level = simplifier.settled_level(loss);
        self.stages().for_each(|stage| stage.rejoin(&mut level));
        level
    }
}

#[cfg(feature = "io")]
impl ConditionedMesh<'_> {
    /// Returns how many faces that are there twice had been left out before flats went.
    pub(crate) fn duplicates_before_flats(&self) -> usize {
        self.sewn.as_ref().map_or(0, |sewn| sewn.counts.duplicate_faces)
    }

    /// Returns the mesh as it is simplified.
    pub(crate) fn mesh(&self) -> &Mesh {
        self.whole().mesh
    }

    /// Returns the locks of the mesh as it is simplified.
    pub(crate) fn locks(&self) -> &Locks {
        self.whole().locks
    }
}

/// Simplifies a mesh to a target number of faces or error, and returns the result with a report.
///
/// With [`Topology::Free`] the mesh is conditioned before, as a scene is: borders that lie on each
/// other are sewn together, and non-manifold vertices are split; see [`condition`]. The result
/// holds only what its faces use. If the target is out of reach, the mesh is reduced as far as the
/// rules allow, and the report says so and counts the reasons.
///
/// Within a [`Target::Error`] flats first get as few faces as their outlines need, see
/// [`flatten`]; so do flats that are exact, if that leaves the faces that are wanted or a few less.
/// An error is proved: no point of the result is farther from the mesh, and no point of the mesh
/// farther from the result, in exact arithmetic on the positions in memory. Writing them
/// as 32-bit floats rounds them; `jobs::simplify` proves what is written. The [proof](Report::proof)
/// in the report says so, or what holds instead where an error as small as the rounding of positions
/// is out of reach.
///
/// # Errors
/// The mesh, the target or an option is invalid, see [`SimplifyError`].
pub fn simplify(
    mesh: &Mesh,
    target: Target,
    options: &Options,
) -> Result<(Mesh, Report), SimplifyError> {
    simplify_by(mesh, target, options, Tightness::FULL)
}

/// Simplifies as [`simplify`], but keeps to an error as closely as is asked for.
pub(crate) fn simplify_by(
    mesh: &Mesh,
    target: Target,
    options: &Options,
    tightness: Tightness,
) -> Result<(Mesh, Report), SimplifyError> {
    let mut ready = ConditionedMesh::new(mesh, options.clone(), Some(Borders::Stitch));
    let own = match target.valid()? {
        Target::Ratio(_) => Target::Faces(target.faces_of(mesh.faces.len())),
        target => target,
    };
    match own {
        Target::Error(error) => ready.flatten_within(error),
        target => {
            let faces = target.faces_of(mesh.faces.len());
            let left = ready.needs(faces);
            let all = ready.face_count();
            if left.is_some_and(|left| FlatFaces::may_be_worth(left, all, faces)) {
                ready.flatten_within(0.0);
            }
            if ready.flats().is_some_and(|flats| !flats.are_worth(all, faces)) {
                ready.keep_flats();
            }
        }
    }
    let mut simplifier = ready.simplifier(options.vanish_below)?;
    let report = match own {
        Target::Error(error) => {
            let again = Some((&ready, options.vanish_below));
            run_within(again, &mut simplifier, ([error, ready.moved()], tightness), &mut ())?
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
