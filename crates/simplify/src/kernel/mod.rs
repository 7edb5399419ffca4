//! The fast engine: `lindstrom-turk` at the speed of quadrics, and `qem` without attributes.
//!
//! It answers to the same rules as the general engine, which is its oracle, by other means: rings
//! instead of stars of faces, one queue entry a vertex instead of one an edge, floats, and costs from
//! nine numbers a vertex, or ten. docs/notes/fast-simplify.md tells why each of these.

// Lanes go by their number, in one row as in the next.
#![allow(clippy::needless_range_loop)]

mod attributes;
mod bound;
mod collapse;
mod collapse_loop;
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
mod volume;

use meshlod_mesh::{Bounds, Mesh};

use crate::engine::Run;
use crate::kernel::metric::Metric;
use crate::kernel::metric::plane_distance::PlaneDistance;
use crate::kernel::metric::swept_volume::SweptVolume;
use crate::kernel::prepare::Prepared;
use crate::options::{Method, Options, SimplifyError};
use crate::simplifier::Started;
use crate::wedges::labels;

/// Sets the engine to work on a valid mesh, and says what was found in it; `None` where the general
/// engine has to.
///
/// Vertices that are not manifold stay where they are.
/// # Errors
/// No face has three different vertices.
pub(crate) fn start<'m>(
    mesh: &'m Mesh,
    bounds: &Bounds,
    options: &Options,
) -> Result<Option<Started<'m>>, SimplifyError> {
    if options.needs_general_engine() {
        return Ok(None);
    }
    let is_bare = || mesh.attributes.is_none() && labels(mesh).is_none();
    match options.method_for([mesh]) {
        Method::LindstromTurk => start_by(SweptVolume, mesh, bounds, options, |prepared| {
            prepared.start(&options.weights)
        }),
        Method::Qem if is_bare() => {
            start_by(PlaneDistance, mesh, bounds, options, Prepared::start_bare)
        }
        _ => Ok(None),
    }
}

fn start_by<'m, R: Metric + 'm>(
    rule: R,
    mesh: &'m Mesh,
    bounds: &Bounds,
    options: &Options,
    start: impl FnOnce(Prepared<'m, R>) -> Box<dyn Run + 'm>,
) -> Result<Option<Started<'m>>, SimplifyError> {
    let Some(prepared) = Prepared::new(rule, mesh, bounds, options) else { return Ok(None) };
    if prepared.live_faces() == 0 {
        return Err(SimplifyError::AllDegenerate(mesh.faces.len()));
    }
    let input = prepared.input();
    Ok(Some((start(prepared), input)))
}
