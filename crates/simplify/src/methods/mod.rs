//! The methods as sets of policies: the table of the house.

mod creases;
mod face_order;
mod kim_jang;
mod lee_jang;
mod lindstrom_turk;
mod outline;
mod qem;
mod quadric;
mod spr;
mod volume;
mod wu;

use meshlod_mesh::Connectivity;

use crate::candidates::{Edges, FacesAndEdges};
use crate::engine::{Algorithm, Run};
use crate::methods::creases::Creases;
use crate::methods::face_order::FaceOrder;
use crate::methods::kim_jang::Conserving;
use crate::methods::lee_jang::Constriction;
use crate::methods::lindstrom_turk::{Memoryless, Stars};
use crate::methods::qem::{Endpoint, Optimal, Quadrics};
use crate::methods::spr::Turn;
use crate::methods::wu::WeightedMean;
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
        Method::LindstromTurkFaces => Algorithm {
            candidates: FacesAndEdges,
            memory: Stars::new(&surface),
            priority: Memoryless,
            placement: Memoryless,
        }
        .start(surface, connectivity),
        Method::LeeJang => Algorithm {
            candidates: FacesAndEdges,
            memory: Creases::new(&surface, lee_jang::weight),
            priority: FaceOrder::new(&surface),
            placement: Constriction,
        }
        .start(surface, connectivity),
        Method::Wu => Algorithm {
            candidates: FacesAndEdges,
            memory: Creases::new(&surface, wu::weight),
            priority: FaceOrder::new(&surface),
            placement: WeightedMean,
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
