//! Simplification of tiles: within an error that is proved.

use std::fmt;

use meshlod_measure::{
    CertifiedOptions, DistanceOptions, MeasureError, PreparedSurface, certified_distance, distance,
    vertex_errors,
};
use meshlod_mesh::{Lock, Locks, Mesh};
use meshlod_simplify::{Options, SimplifyError, Target};
use meshlod_tiles::coarser::Coarsen;
use meshlod_tiles::plan::Plan;

use crate::bounded::Tightness;
use crate::conditioned::simplify_by;
use crate::simplify;

/// Number of faces of a tile, as a multiple of what a leaf may have, from which it is simplified
/// further than its error allows: surfaces that do not get simpler, such as leaves of trees, would
/// be whole in the root.
const MOST: usize = 3;

/// Error that is proved of a tile, as a multiple of that which its level may lose: so much is left to
/// places that would cost more to mend than they are worth.
const ROOM: f64 = 1.05;

/// Little to mend: the faces that a run leaves are a twentieth within the error, and few are that much
/// farther away.
const LOOSE: Tightness = Tightness { run: 0.943, slack: 0.019 };

/// Samples by which leaves are measured that errors are chosen from.
const SAMPLES: usize = 20_000;

/// Simplifies within an error that is proved.
pub(super) struct Proven {
    most_faces: usize,
}

impl Proven {
    pub fn new(plan: &Plan) -> Self {
        Self { most_faces: MOST * plan.options.most_faces }
    }
}

/// Reason why a tile was not simplified.
#[derive(Debug)]
pub(super) enum TileFailure {
    Simplify(SimplifyError),
    Measure(MeasureError),
}

impl fmt::Display for TileFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simplify(error) => error.fmt(f),
            Self::Measure(error) => error.fmt(f),
        }
    }
}

impl Coarsen for Proven {
    type Error = TileFailure;

    fn coarsen(
        &self,
        mesh: &Mesh,
        locks: Vec<Lock>,
        error: f64,
    ) -> Result<(Mesh, f64), TileFailure> {
        let locks = Locks { of_vertex: locks, ties: Vec::new() };
        let options = Options { locks, ..Options::default() };
        let target = Target::Error(ROOM * error);
        let (level, report) = match simplify_by(mesh, target, &options, LOOSE) {
            Err(SimplifyError::NoFaces) => return Ok((mesh.clone(), 0.0)),
            done => done.map_err(TileFailure::Simplify)?,
        };
        if level.faces.len() <= self.most_faces
            && let Some(proof) = report.proof
        {
            return Ok((level, proof.proved));
        }
        let target = Target::Faces(self.most_faces.min(level.faces.len()));
        let (level, _) = simplify(mesh, target, &options).map_err(TileFailure::Simplify)?;
        let apart = certified_distance(mesh, &level, &CertifiedOptions::default());
        match apart {
            Ok(apart) => Ok((level, apart.symmetric().upper)),
            // Without area nothing can be told apart: it stays as it is.
            Err(_) => Ok((mesh.clone(), 0.0)),
        }
    }

    fn loss(&self, mesh: &Mesh, faces: usize) -> Result<f64, TileFailure> {
        let options = Options::default();
        let (level, _) =
            simplify(mesh, Target::Faces(faces), &options).map_err(TileFailure::Simplify)?;
        let options = DistanceOptions { samples: SAMPLES, ..DistanceOptions::default() };
        Ok(distance(mesh, &level, &options).map_err(TileFailure::Measure)?.max())
    }

    fn distances(&self, points: &Mesh, mesh: &Mesh) -> Vec<f64> {
        PreparedSurface::new(mesh).map_or(Vec::new(), |surface| vertex_errors(points, &surface))
    }
}
