//! The fast engine: `lindstrom-turk` at the speed of quadrics.
//!
//! It answers to the same rules as the general engine, which is its oracle, by other means: rings
//! instead of stars of faces, one queue entry a vertex instead of one an edge, floats, and costs from
//! nine numbers a vertex. docs/notes/fast-simplify.md tells why each of these.

// Lanes go by their number, in one row as in the next.
#![allow(clippy::needless_range_loop)]

mod ahead;
mod apart;
mod around;
mod batch;
mod carry;
mod cells;
mod coat;
mod cost;
mod dress;
mod engine;
mod fans;
mod field;
mod frame;
mod hood;
mod lanes;
mod level;
mod log;
mod looks;
mod order;
mod original;
mod pace;
mod painted;
mod parts;
mod place;
mod prepare;
mod probe;
mod queue;
mod renew;
mod ring;
mod seams;
mod split;
mod vertex;
mod volume;
mod wide;
mod within;
mod work;

use meshlod_mesh::{Bounds, Mesh};

use crate::fast::prepare::Prepared;
use crate::options::{Method, Options, SimplifyError};
use crate::simplifier::Started;

/// Whether there is a fast way for this.
fn fits(mesh: &Mesh, options: &Options) -> bool {
    options.method_for([mesh]) == Method::LindstromTurk && !options.needs_general_engine()
}

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
    let prepared = if fits(mesh, options) { Prepared::new(mesh, bounds, options) } else { None };
    let Some(prepared) = prepared else { return Ok(None) };
    if prepared.live_faces() == 0 {
        return Err(SimplifyError::AllDegenerate(mesh.faces.len()));
    }
    let input = prepared.input();
    Ok(Some((prepared.start(&options.weights), input)))
}
