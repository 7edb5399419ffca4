//! The fast engine: `lindstrom-turk` at the speed of quadrics, and `qem` without attributes.
//!
//! It answers to the same rules as the general engine, which is its oracle, by other means: rings
//! instead of stars of faces, one queue entry a vertex instead of one an edge, floats, and costs from
//! nine numbers a vertex, or ten. docs/notes/kernel.md tells why each of these.

// Lanes go by their number, in one row as in the next.
#![allow(clippy::needless_range_loop)]

mod attributes;
mod bound;
mod collapse;
mod collapse_loop;
mod components;
mod contraction_log;
mod level;
mod mesh;
mod metric;
mod partition;
mod prepare;
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
use crate::simplifier::Started;

pub(crate) use crate::kernel::metric::plane_distance::PlaneDistance;
pub(crate) use crate::kernel::metric::swept_volume::SweptVolume;

/// Sets the kernel to work on a valid mesh, and says what was found in it.
///
/// # Errors
/// No face has three different vertices.
pub(crate) fn start<'m, M: Metric + 'm>(
    metric: M,
    mesh: &'m Mesh,
    bounds: &Bounds,
    options: &Options,
) -> Result<Started<'m>, SimplifyError> {
    let prepared = Prepared::new(metric, mesh, bounds, options);
    if prepared.live_faces() == 0 {
        return Err(SimplifyError::AllDegenerate(mesh.faces.len()));
    }
    let input = prepared.input();
    Ok((prepared.start(&options.weights), input))
}
