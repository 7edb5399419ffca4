//! The methods as sets of policies: the table of the house.

mod qem;
mod quadric;

use meshlod_mesh::Connectivity;

use crate::candidates::Edges;
use crate::engine::{Algorithm, Engine, Run};
use crate::methods::qem::{Endpoint, Optimal, Quadrics};
use crate::options::Method;
use crate::surface::Surface;

/// Sets a method to work on a surface.
pub(crate) fn start(method: Method, surface: Surface, connectivity: Connectivity) -> Box<dyn Run> {
    let memory = Quadrics::new(&surface, &connectivity);
    match method {
        Method::Qem => Box::new(Engine::new(
            Algorithm { candidates: Edges, memory, priority: Optimal, placement: Optimal },
            surface,
            connectivity,
        )),
        Method::QemEndpoint => Box::new(Engine::new(
            Algorithm { candidates: Edges, memory, priority: Endpoint, placement: Endpoint },
            surface,
            connectivity,
        )),
    }
}
