//! The kernel, which runs `lindstrom-turk` and `qem`.
//!
//! It follows the rules of the policy engine, which is its oracle, by other means: one-rings
//! instead of lists of faces, one queue entry per vertex instead of one per edge, single precision,
//! and edge costs from nine or ten numbers at each end. `docs/notes/kernel.md` gives the reasons and
//! the figures.
//!
//! From the ground up:
//!
//! | module | what it holds |
//! |---|---|
//! | `simd` | rows of eight floats, and the choice of register width |
//! | `mesh` | vertices of 128 bytes with their one-rings, in a local frame |
//! | `setup`, `prepare` | from the faces of the input to vertices with rings |
//! | `collapse` | one contraction: its ends, the edge's one-ring, the deviation |
//! | `metric` | what an edge costs: swept volume or plane distance |
//! | `attributes` | quadrics of normals, uvs and colours at the wedges |
//! | `bound` | a bound on the distance to the input |
//! | `schedule` | edge costs, the bucket queue, deferral |
//! | `collapse_loop` | the loop: start reading here; `tied` and `vanish` are its rarer steps |
//! | `retrace` | contractions taken back where the bound was not held |
//! | `components`, `apart` | the components that may vanish, and how far they are apart |
//! | `volume` | the volume lost and owed |
//! | `partition` | parts that coarsen side by side |
//! | `repay`, `polish` | levels whose debts are repaid, and that are fitted to the input |
//! | `run`, `level`, `contraction_log` | the face to `Simplifier`: runs, levels, observers |
//!
//! A wedge is known by its *slot*, an index: the first wedge of a vertex has the vertex's own id,
//! all further wedges follow after the last vertex.

// Lanes are indexed by number, across several rows at once.
#![allow(clippy::needless_range_loop)]

mod apart;
mod attributes;
mod bound;
mod coats;
mod collapse;
mod collapse_loop;
mod components;
mod contraction_log;
mod handles;
mod level;
mod mesh;
mod metric;
mod partition;
mod polish;
mod prepare;
mod repay;
pub(crate) mod retrace;
mod run;
mod schedule;
mod setup;
mod simd;
mod tied;
mod vanish;
mod volume;

use meshlod_mesh::{Bounds, Mesh};

use crate::kernel::metric::Metric;
use crate::kernel::prepare::Prepared;
use crate::options::{Options, SimplifyError};
use crate::run::{Started, Wanted};

pub(crate) use crate::kernel::metric::plane_distance::PlaneDistance;
pub(crate) use crate::kernel::metric::swept_volume::SweptVolume;

/// Prepares the kernel for a valid mesh. Also returns what was found in the input.
///
/// Returns `None` if only a manifold mesh is wanted and this one has a non-manifold vertex.
///
/// # Errors
/// If no face has three different vertices.
pub(crate) fn start<'m, M: Metric + 'm>(
    metric: M,
    mesh: &'m Mesh,
    bounds: &Bounds,
    (options, wanted): (&Options, Wanted),
) -> Result<Option<Started<'m>>, SimplifyError> {
    let Some(prepared) = Prepared::new(metric, mesh, bounds, (options, wanted)) else {
        return Ok(None);
    };
    if prepared.live_faces() == 0 {
        return Err(SimplifyError::AllDegenerate(mesh.faces.len()));
    }
    let input = prepared.input();
    Ok(Some((prepared.start(options), input)))
}
