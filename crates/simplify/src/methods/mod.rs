//! The methods as sets of policies: the table of the house.

mod drift;
mod qem;
mod quadric;
mod spr;

use meshlod_mesh::Connectivity;

use crate::candidates::Edges;
use crate::engine::{Algorithm, Engine, Run};
use crate::methods::drift::Drift;
use crate::methods::qem::{Endpoint, Optimal, Quadrics};
use crate::methods::spr::Turn;
use crate::options::Method;
use crate::surface::Surface;

/// Sets a method to work on a surface.
pub(crate) fn start(method: Method, surface: Surface, connectivity: Connectivity) -> Box<dyn Run> {
    let candidates = Edges;
    match method {
        Method::Qem => {
            let memory = Quadrics::new(&surface, &connectivity);
            let algorithm = Algorithm { candidates, memory, priority: Optimal, placement: Optimal };
            Box::new(Engine::new(algorithm, surface, connectivity))
        }
        Method::QemEndpoint => {
            let memory = Quadrics::new(&surface, &connectivity);
            let algorithm =
                Algorithm { candidates, memory, priority: Endpoint, placement: Endpoint };
            Box::new(Engine::new(algorithm, surface, connectivity))
        }
        Method::Spr => {
            let memory = Drift::new(&surface);
            let algorithm = Algorithm { candidates, memory, priority: Turn, placement: Turn };
            Box::new(Engine::new(algorithm, surface, connectivity))
        }
    }
}
