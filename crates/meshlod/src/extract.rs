//! Multiresolution files in one call: one mesh out of a file.

use std::fs::File;
use std::path::Path;

use meshlod_io::IoError;
use meshlod_mesh::Mesh;
use meshlod_multires::{FileError, Level, ModelFile, Query};
use meshlod_simplify::Digits;

use crate::{CutVolumeError, LevelsError, Verification, conserve_cut_volume, extract_verified};

/// Options for extracting a mesh from a multiresolution file with [`extract`].
#[derive(Clone, Debug)]
pub struct ExtractOptions<'f> {
    /// Region to refine, and the largest error allowed there; by default the whole model, without
    /// error. A point stands for the closest point of the finest surface. All of that is where the file
    /// has each mesh of its scene; [`query_of_levels`](crate::ModelScene::query_of_levels) leads there.
    pub query: Query<'f>,
    /// Largest number of faces of the mesh. If set, the query only decides where errors matter
    /// most.
    pub max_faces: Option<usize>,
    /// True to refine the mesh until it is proven to satisfy the query, like [`extract_verified`];
    /// false to go by the errors stored in the file, which is faster and reads less. A tolerance that
    /// is a field needs false. Of no effect if `max_faces` is set.
    pub verify: bool,
    /// True to leave out faces entirely outside the focus region of the query. Of a point only the
    /// nearest faces are left.
    pub crop: bool,
    /// Number format in which the mesh shall have [exactly the volume](crate::conserve_cut_volume)
    /// of the finest cut in the file; `None` to leave the vertices where the file has them. Does not
    /// go with `crop`.
    pub exact_volume: Option<Digits>,
}

impl Default for ExtractOptions<'static> {
    fn default() -> Self {
        Self {
            query: Query::finest(),
            max_faces: None,
            verify: true,
            crop: false,
            exact_volume: None,
        }
    }
}

/// Facts about a mesh that [`extract_reported`] took out of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ExtractReport {
    /// Number of faces of the level, with those that were cropped. More than `max_faces` if the
    /// coarsest level has more.
    pub level_faces: usize,
    /// Proof of the error; `None` if it was not asked for, or a number of faces was.
    pub verification: Option<Verification>,
    /// Number of [chunks or parts](ModelFile::pieces) of the file that are there, and of a whole
    /// file. If the first is less, the finest levels are missing, and errors refer to what is there.
    pub pieces: [usize; 2],
    /// Word for one of the pieces.
    pub piece_name: &'static str,
    /// False if the query has a focus that no face intersects, so that all are as coarse as the file
    /// has them.
    pub meets_focus: bool,
}

/// Extracts a mesh at one level of detail from a `.mlod` file, reading only the parts needed.
///
/// Unless a number of faces is asked for, the mesh is proven to satisfy the query, as
/// [`extract_verified`] says.
///
/// # Errors
/// A file that cannot be read or is damaged, an invalid query, and a volume that the mesh cannot get.
///
/// ```
/// use meshlod::multires::{Focus, Query, Tolerance};
/// use meshlod::{BuildOptions, ExtractOptions, build, extract, samples};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("knot.mlod");
/// # build(&samples::knot(4_000), &path, &BuildOptions::default())?;
///
/// // Fine in a ball, coarse elsewhere.
/// let focus = Focus::Sphere { center: [0.9, 0.0, 0.0], radius: 0.2 };
/// let query = Query { focus, tolerance: Tolerance::Uniform(0.001) };
/// let near = extract(&path, &ExtractOptions { query, ..Default::default() })?;
/// let all = extract(&path, &ExtractOptions::default())?;
/// assert!(2 * near.faces.len() < all.faces.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn extract(path: &Path, options: &ExtractOptions<'_>) -> Result<Mesh, LevelsError> {
    Ok(extract_reported(path, options)?.0)
}

/// Extracts a mesh like [`extract`], and reports what is known about it: whether its error is
/// proven, and what of the file or of the query is missing.
///
/// # Errors
/// Those of [`extract`].
pub fn extract_reported(
    path: &Path,
    options: &ExtractOptions<'_>,
) -> Result<(Mesh, ExtractReport), LevelsError> {
    let file = File::open(path).map_err(|error| IoError::system(path, error))?;
    let unread = |source| LevelsError::File { path: path.to_owned(), source };
    let file = ModelFile::open(file).map_err(unread)?;
    let (level, report) = level(&file, options).map_err(unread)?;
    let mut mesh = level.mesh();
    if let Some(digits) = options.exact_volume {
        let conserved = match options.crop {
            true => Err(CutVolumeError::Cropped),
            false => conserve_cut_volume(&mut mesh, &file, digits),
        };
        conserved.map_err(|source| LevelsError::Volume { path: path.to_owned(), source })?;
    }
    Ok((mesh, report))
}

fn level(
    file: &ModelFile<File>,
    options: &ExtractOptions<'_>,
) -> Result<(Level, ExtractReport), FileError> {
    let ExtractOptions { query, max_faces, crop, verify, .. } = options;
    let (query, nearest) = file.at_surface(query, *max_faces)?;
    let (level, verification) = match *max_faces {
        None if *verify => {
            let verified = extract_verified(file, &query)?;
            (verified.extract.level, Some(verified.verification))
        }
        None => (file.extract(&query)?.level, None),
        Some(faces) => (file.extract_at_most(faces, &query)?.level, None),
    };
    let level_faces = level.faces.len();
    let is_region = nearest.is_none() && !query.is_everywhere();
    let within = if is_region { Some(level.where_asked(&query)?) } else { None };
    let meets_focus = within.as_ref().is_none_or(|within| !within.faces.is_empty());
    let level = match (nearest, within) {
        _ if !*crop => level,
        (Some(point), _) => level.nearest(point)?,
        (None, within) => within.unwrap_or(level),
    };
    let (pieces, piece_name) = (file.pieces(), file.piece_name());
    Ok((level, ExtractReport { level_faces, verification, pieces, piece_name, meets_focus }))
}

#[cfg(test)]
mod tests {
    use meshlod_multires::Focus;
    use meshlod_samples as samples;

    use super::*;
    use crate::{BuildOptions, build};

    #[test]
    fn a_report_says_what_a_mesh_lacks() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("knot.mlod");
        let mesh = samples::knot(4_000);
        build(&mesh, &path, &BuildOptions::default()).unwrap();
        let report = |options: &ExtractOptions<'_>| extract_reported(&path, options).unwrap().1;
        let of = |query| ExtractOptions { query, ..Default::default() };
        let kept = report(&of(Query::uniform(0.02)));
        assert!(kept.verification.unwrap().holds && kept.meets_focus);
        assert_eq!(kept.pieces[0], kept.pieces[1]);
        let below = report(&of(Query::uniform(1e-12))).verification.unwrap();
        assert!(!below.holds && below.rounding > 1e-12);
        let few = report(&ExtractOptions { max_faces: Some(1), ..Default::default() });
        assert!(few.level_faces > 1 && few.verification.is_none());
        let far = Focus::Sphere { center: [9.0; 3], radius: 0.1 };
        assert!(!report(&of(Query { focus: far, ..Query::uniform(0.0) })).meets_focus);
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        let half = report(&ExtractOptions::default());
        assert!(half.pieces[0] < half.pieces[1] && half.level_faces < mesh.faces.len());
    }
}
