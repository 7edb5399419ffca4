//! Extraction from a multiresolution file that keeps the error asked for.
//!
//! The errors stored in a file decide where a cut starts. Then the cut is compared with the finest
//! triangles in the file, both ways, and refined where it is farther from them than the query
//! allows, until nothing is.

mod check;

use meshlod_measure::{CertifiedOptions, certified_distance};
use meshlod_mesh::Mesh;
use meshlod_multires::{
    Archive, Cut, ErrorKind, Extract, FileError, ModelFile, Query, Source, Tolerance,
};
use meshlod_spatial::closest_point;

use self::check::{Check, CutSurface, RESERVE};
use crate::model::measured_poses;

/// Part of the tolerance at which a cut for a camera or a focus starts, which has up to a tenth more
/// faces from 1. The whole surface within one tolerance starts at 1: from 1.5 it has a hundredth fewer
/// faces, and takes half as long again.
const START: f64 = 1.5;

/// Number of refinements after which the rest is refined as far as it goes, so that a file of wrong
/// errors cannot hold up its reader. The meshes of docs/notes/multires.md take 10 at most.
const MOST_ROUNDS: usize = 64;

/// Mesh extracted from a `.mlod` file, with what is known about its error.
#[derive(Clone, Debug)]
pub struct VerifiedExtract {
    /// The mesh, with what was read to build it.
    pub extract: Extract,
    /// Proof of its error.
    pub verification: Verification,
}

/// Proof of the error of an extracted mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Verification {
    /// True if every point of the mesh in the focus is as close to the original as the query asks,
    /// and every point of the original in the focus as close to the mesh.
    ///
    /// False where the query asks for less than the file's rounding. Then the mesh is the finest in
    /// the file, and [`rounding`](Self::rounding) away at most.
    pub holds: bool,
    /// Greatest distance between the finest mesh in the file and the original, by rounding, in model
    /// units. If the file is truncated, the finest mesh that is there takes the original's place.
    pub rounding: f64,
    /// Distance by which points may be moved afterwards, as when coordinates are rounded to `f32`,
    /// without breaking what [`holds`](Self::holds) says, in model units; infinite if no triangle
    /// meets the focus.
    pub spare: f64,
    /// Number of updates applied because the check demanded them, with what they depend on.
    pub added: usize,
    /// Number of times that the mesh was refined and checked again.
    pub rounds: usize,
}

impl Verification {
    /// Returns the proof of a mesh by the least distance that a query allows anywhere, and the distance
    /// that no refinement takes away.
    fn within(least: f64, rounding: f64) -> Self {
        let holds = (1.0 - RESERVE) * least >= rounding;
        Self { holds, rounding, spare: RESERVE * least, added: 0, rounds: 0 }
    }
}

/// Extracts the mesh that satisfies a query, and proves that it does.
///
/// In the focus **every point of the mesh is as close to the original mesh as the query asks, and
/// every point of the original to the mesh**, whatever errors the file stores, unless the query asks
/// for less than [`Verification::rounding`]. The original is the mesh that the file was built from,
/// without faces that `build` has left out, or what is there of a truncated file. Of a height field it
/// is the grid of its heights, with diagonals of its own: `moved` and `turned` of its
/// [`Fit`](meshlod_multires::Fit) say how far the mesh may be from that. For tolerances in
/// pixels the distance allowed for a point is that at its own distance from the camera. The result
/// is the same for any number of threads.
///
/// That is proven in the pose in which the file has the mesh. In the poses in which stored errors were
/// measured ([`measured_poses`]) the mesh is as close by these errors.
///
/// Reads all levels around the focus. Files of height fields, and of proven bounds where the focus is
/// everything, are not checked again.
///
/// Cost: about O(n log n), n = faces of the finest mesh around the focus; most of the time goes into
/// the first check. [`ModelFile::extract`] answers by the stored errors alone, and faster.
/// # Errors
/// An invalid query, one whose tolerance is a field, or a damaged file.
pub fn extract_verified<S: Source>(
    file: &ModelFile<S>,
    query: &Query<'_>,
) -> Result<VerifiedExtract, FileError> {
    let rounding = rounding(file);
    let is_proven = match file {
        ModelFile::HeightField(..) => true,
        ModelFile::Contractions(archive) => {
            archive.error_kind() == ErrorKind::Bound && query.is_everywhere()
        }
    };
    match file {
        ModelFile::Contractions(archive) if !is_proven => refine(archive, query, rounding),
        _ => by_proven_errors(file, query, rounding),
    }
}

/// Extracts by the errors that a file stores, which are proven.
fn by_proven_errors<S: Source>(
    file: &ModelFile<S>,
    query: &Query<'_>,
    rounding: f64,
) -> Result<VerifiedExtract, FileError> {
    let mut extract = file.extract(&scaled(query, 1.0 - RESERVE))?;
    let mut least = least_tolerance(query, &extract.level.mesh());
    let mut verification = Verification::within(least, rounding);
    if matches!(file, ModelFile::HeightField(..)) && rounding > 0.0 {
        // Its errors are those of the rounded heights: what rounding takes is not left to them.
        let part = (1.0 - 2.0 * RESERVE - rounding / least).max(0.0);
        extract = file.extract(&scaled(query, part))?;
        least = least_tolerance(query, &extract.level.mesh());
        verification = Verification::within(least, part * least + rounding);
        verification.rounding = rounding;
    }
    Ok(VerifiedExtract { extract, verification })
}

fn refine<S: Source>(
    archive: &Archive<S>,
    query: &Query<'_>,
    rounding: f64,
) -> Result<VerifiedExtract, FileError> {
    let near = archive.around(query)?;
    let mut finest = Cut::new(&near.model);
    finest.refine_all_around(&near.limits);
    let surface = CutSurface::of(&finest);
    let least = surface.least_limit(&near.limits);
    let mut verification = Verification::within(least, rounding);
    if is_finest(&query.tolerance, rounding) {
        // Nothing in the file is finer.
        return Ok(VerifiedExtract { extract: near.extract(&finest)?, verification });
    }
    let is_uniform = query.is_everywhere() && matches!(query.tolerance, Tolerance::Uniform(_));
    let part = match measured_poses(archive)? {
        // No check looks at the poses in which the stored errors were measured.
        Some(_) if least > 0.0 => (1.0 - rounding / least).max(0.0),
        Some(_) => 1.0,
        None if is_uniform => 1.0,
        None => START,
    };
    let mut check = None;
    let mut cut = rayon::in_place_scope(|scope| {
        scope.spawn(|_| check = Check::new(&surface, &near, rounding));
        Cut::at(&near.model, &scaled(query, part))
    })?;
    loop {
        let splits = match &mut check {
            Some(check) if verification.rounds < MOST_ROUNDS => check.refine(&mut cut),
            _ => cut.refine_all_around(&near.limits),
        };
        if splits == 0 {
            return Ok(VerifiedExtract { extract: near.extract(&cut)?, verification });
        }
        verification.added += splits;
        verification.rounds += 1;
    }
}

/// Returns true if nothing but the finest mesh of a file with this rounding can satisfy a tolerance.
fn is_finest(tolerance: &Tolerance<'_>, rounding: f64) -> bool {
    match tolerance {
        Tolerance::Uniform(most) => *most == 0.0 || most * (1.0 - RESERVE) <= rounding,
        Tolerance::Each(queries) => {
            queries.iter().all(|query| is_finest(&query.tolerance, rounding))
        }
        Tolerance::Pixels { .. } | Tolerance::Field(_) => tolerance.is_finest(),
    }
}

/// Returns the least distance that a query allows anywhere on a mesh, in model units.
fn least_tolerance(query: &Query<'_>, mesh: &Mesh) -> f64 {
    match &query.tolerance {
        Tolerance::Uniform(most) => *most,
        Tolerance::Pixels { camera, pixels } => {
            let eye = camera.eye.into();
            let away = |face| closest_point(eye, &mesh.triangle(face)).distance(eye);
            let allowed = mesh.faces.iter().map(|&face| pixels * camera.pixel() * away(face));
            allowed.fold(f64::INFINITY, f64::min)
        }
        Tolerance::Field(_) => 0.0,
        Tolerance::Each(queries) => {
            queries.iter().map(|query| least_tolerance(query, mesh)).fold(f64::INFINITY, f64::min)
        }
    }
}

/// Returns a query for this part of a tolerance.
fn scaled<'f>(query: &Query<'f>, part: f64) -> Query<'f> {
    Query { focus: query.focus.clone(), tolerance: query.tolerance.scaled(part) }
}

/// Returns how far the finest mesh in a file may be from the mesh that it was built from, in model
/// units.
fn rounding<S: Source>(file: &ModelFile<S>) -> f64 {
    match file {
        ModelFile::Contractions(archive) if archive.is_lossless() => 0.0,
        ModelFile::Contractions(archive) => archive.rounding(),
        ModelFile::HeightField(field, _) => field.fit().rounded,
    }
}

/// Measures how far a mesh from a `.mlod` file is from the original: an upper bound of the greatest
/// distance of a point on either from the other, in model units; `None` if it cannot be measured.
///
/// The bound is a hundredth above the distance, if not too many divisions of faces are needed, and
/// includes rounding. It refers to the whole surface, whatever the focus. In a truncated file the
/// finest mesh that is there takes the original's place.
///
/// Cost: that of reading the whole file and of [`certified_distance`].
/// # Errors
/// A damaged file.
pub fn measure_extract<S: Source>(
    file: &ModelFile<S>,
    mesh: &Mesh,
) -> Result<Option<f64>, FileError> {
    let finest = match file {
        ModelFile::Contractions(archive) => {
            let near = archive.around(&Query::finest())?;
            let mut finest = Cut::new(&near.model);
            finest.refine_all_around(&near.limits);
            finest.level().mesh()
        }
        ModelFile::HeightField(..) => file.extract(&Query::finest())?.level.mesh(),
    };
    let apart = certified_distance(&finest, mesh, &CertifiedOptions::default());
    Ok(apart.ok().map(|apart| apart.symmetric().upper + rounding(file)))
}

#[cfg(test)]
mod tests;
