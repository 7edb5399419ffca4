//! The methods as sets of policies: the table of the house.

mod kim_jang;
mod lindstrom_turk;
mod outline;
mod qem;
mod quadric;
mod spr;
mod volume;

use meshlod_mesh::Connectivity;

use crate::candidates::Edges;
use crate::engine::{Algorithm, Run};
use crate::methods::kim_jang::Conserving;
use crate::methods::lindstrom_turk::{Memoryless, Stars};
use crate::methods::qem::{Endpoint, Optimal, Quadrics};
use crate::methods::spr::Turn;
use crate::options::Method;
use crate::surface::Surface;

/// Sets a method to work on a surface.
pub(crate) fn start(method: Method, surface: Surface, connectivity: Connectivity) -> Box<dyn Run> {
    let quadrics = || Quadrics::new(&surface, &connectivity);
    match method {
        Method::Qem => Algorithm {
            candidates: Edges,
            memory: quadrics(),
            priority: Optimal,
            placement: Optimal,
        }
        .start(surface, connectivity),
        Method::QemEndpoint => Algorithm {
            candidates: Edges,
            memory: quadrics(),
            priority: Endpoint,
            placement: Endpoint,
        }
        .start(surface, connectivity),
        Method::LindstromTurk => Algorithm {
            candidates: Edges,
            memory: Stars::new(&surface),
            priority: Memoryless,
            placement: Memoryless,
        }
        .start(surface, connectivity),
        Method::KimJang => Algorithm {
            candidates: Edges,
            memory: quadrics(),
            priority: Optimal,
            placement: Conserving,
        }
        .start(surface, connectivity),
        Method::Spr => Algorithm { candidates: Edges, memory: (), priority: Turn, placement: Turn }
            .start(surface, connectivity),
    }
}
