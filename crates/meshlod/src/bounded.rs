//! Simplification within an error that is proved: what is found too far away is mended.
//!
//! The engines probe the error at points, or estimate it. So the level is compared with its input,
//! in both directions, until every point of either is known to be within the error of the other.
//! Contractions that made faces which are too far away are taken back, and the run goes on there
//! with a lower bound. Where an engine cannot take back, or that does not help, the whole run is
//! repeated with a lower bound.

mod comparison;

use meshlod_measure::{
    CertifiedOptions, PreparedSurface, certified_surface_distance, least_provable,
};
use meshlod_mesh::Mesh;
use meshlod_simplify::{
    ErrorProof, Excess, ExcessFace, Observe, Report, Simplifier, SimplifyError, Target,
};

use crate::bounded::comparison::{Comparison, Outcome};
use crate::conditioned::ConditionedMesh;

/// How closely a run keeps to its error: docs/notes/kernel.md and tiles.md have figures.
#[derive(Clone, Copy)]
pub(crate) struct Tightness {
    /// Part of the error that a run goes up to. Without this room, each place where it is a
    /// thousandth beyond would have to be mended.
    pub(crate) run: f64,
    /// Relative slack of comparisons: faces are compared with a limit lowered by this much, so that
    /// none exceeds the error itself. A smaller slack saves more faces and makes the proof more
    /// expensive.
    pub(crate) slack: f64,
}

impl Tightness {
    /// As few faces as the error allows.
    pub(crate) const FULL: Self = Self { run: 0.99, slack: 0.002 };
}

/// Largest number of times that contractions are taken back before the whole run is repeated. Of 64
/// parts of robots within .1 % of the diagonal none took more than 11.
const MOST_MENDS: usize = 24;

/// Largest number of times that the whole run is repeated.
const MOST_RUNS: usize = 16;

/// Part of a level's faces, one in this many, that are too far away if its bound is probed too
/// coarsely everywhere, as where long thin faces follow a crease. Mending all these places costs more
/// faces than a run with a bound lower by [`SLIGHTLY`]: fandisk-32k within .3 %, a fifth of whose
/// faces are too far away, has 670 faces mended, and 534 with a bound of .95.
const MANY: usize = 10;

/// Factor by which the bound is lowered if many faces are too far away.
const SLIGHTLY: f64 = 0.95;

/// Part of the bound that would just have done, for a whole run with a lower bound.
const CAUTION: f64 = 0.97;

/// Limits of the factor by which the bound of a whole run is lowered.
const FACTOR: [f64; 2] = [0.5, 0.93];

/// Simplifies within an error and proves that it is held.
///
/// What is proved is in the report; nothing is if the mesh has no area, if the error is infinite, or
/// if the observer wants to see contractions, which then cannot be taken back. `moved` is the part of
/// the error that was used up before, when the mesh was
/// [flattened](ConditionedMesh::flatten_within). An error below the [rounding of
/// `f64`](least_provable) cannot be held unless nothing changes; the report then says what is proved.
/// `again` is the mesh with its option `vanish_below`, if the run may be repeated.
pub(crate) fn run_within<'m>(
    again: Option<(&'m ConditionedMesh<'_>, Option<f64>)>,
    simplifier: &mut Simplifier<'m>,
    ([error, moved], tightness): ([f64; 2], Tightness),
    observer: &mut dyn Observe,
) -> Result<Report, SimplifyError> {
    let left = error - moved;
    if observer.needs_surface() || left == f64::INFINITY {
        return simplifier.run(Target::Error(left), observer);
    }
    let report = match left > 0.0 {
        true => run_and_prove(again, simplifier, (left, tightness), observer)?,
        // Nothing may move.
        false => {
            let report = simplifier.run(Target::Faces(simplifier.live_faces()), observer)?;
            with_proof(report, [0.0; 2], 0)
        }
    };
    let proof = report.proof.map(|proof| {
        let proved = proof.proved + moved;
        let proved = if report.reached { proved.min(error) } else { proved };
        ErrorProof { asked: error, proved, ..proof }
    });
    Ok(Report { proof, ..report })
}

fn run_and_prove<'m>(
    again: Option<(&'m ConditionedMesh<'_>, Option<f64>)>,
    simplifier: &mut Simplifier<'m>,
    (error, tightness): (f64, Tightness),
    observer: &mut dyn Observe,
) -> Result<Report, SimplifyError> {
    let mut bound = tightness.run * error;
    let mut report = simplifier.run_to_compare(bound, observer)?;
    let whole = simplifier.input();
    let input = match simplifier.hierarchy() {
        Some(known) => PreparedSurface::with_hierarchy(whole, known),
        None => PreparedSurface::new(whole),
    };
    let Ok(input) = input else { return Ok(report) };
    let (mut rounds, mut runs, mut mends) = (0, 1, 0);
    let mut comparison = Comparison::new(whole, &input, [error, tightness.slack]);
    if error < least_provable(&input) {
        let level = simplifier.level();
        let proved = match comparison.is_input(&level) {
            true => 0.0,
            false => distance_at_most(&input, &level, error),
        };
        return Ok(with_proof(report, [error, proved], 0));
    }
    loop {
        let level = simplifier.level();
        let found = match comparison.with(&level) {
            Outcome::Near => return Ok(with_proof(report, [error; 2], rounds)),
            Outcome::Far(found) => found,
            Outcome::NoArea => Vec::new(),
            Outcome::Undecided => {
                let proved = distance_at_most(&input, &level, error);
                return Ok(with_proof(report, [error, proved], rounds));
            }
        };
        rounds += 1;
        let is_first = mends == 0 && runs == 1 && again.is_some();
        let are_many = is_first && can_take_back(&report) && are_many(&found, &level);
        if !are_many && mends < MOST_MENDS && simplifier.take_back(&found) {
            mends += 1;
        } else if let Some((mesh, vanish_below)) = again.filter(|_| runs < MOST_RUNS) {
            (runs, mends) = (runs + 1, 0);
            bound *= if are_many { SLIGHTLY } else { lower(&found) };
            *simplifier = mesh.simplifier(vanish_below)?;
            comparison.start_again();
        } else {
            let proved = distance_at_most(&input, &level, error);
            return Ok(with_proof(report, [error, proved], rounds));
        }
        report = simplifier.run_to_compare(bound, observer)?;
    }
}

fn can_take_back(report: &Report) -> bool {
    report.method.runs_in_kernel()
}

/// Returns true if many faces of a level are too far from the input.
fn are_many(found: &[Excess], level: &Mesh) -> bool {
    let of_level = |excess: &&Excess| matches!(excess.face, ExcessFace::OfLevel(_));
    found.iter().filter(of_level).count() * MANY > level.faces.len()
}

fn with_proof(report: Report, [asked, proved]: [f64; 2], rounds: usize) -> Report {
    let proof = Some(ErrorProof { asked, proved, rounds });
    Report { proof, reached: proved <= asked, ..report }
}

/// Returns the factor by which the bound of a whole run is lowered: the lowest if nothing is known
/// of the distance.
fn lower(found: &[Excess]) -> f64 {
    let worst = found.iter().map(|excess| excess.ratio).reduce(f64::max);
    worst.map_or(0.0, |worst| CAUTION / worst).clamp(FACTOR[0], FACTOR[1])
}

/// Returns an upper bound of the distance between an input and a level, no closer than `enough`;
/// infinite if the level has no area.
fn distance_at_most(input: &PreparedSurface<'_>, level: &Mesh, enough: f64) -> f64 {
    PreparedSurface::new(level).map_or(f64::INFINITY, |level| {
        let options = CertifiedOptions::up_to(enough / input.diagonal());
        certified_surface_distance(input, &level, &options).symmetric().upper
    })
}
