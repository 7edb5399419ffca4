//! The methods as sets of policies: the table of the house.

mod appearance;
mod channels;
mod creases;
mod expectations;
mod face_order;
mod fan;
mod kim_jang;
mod lee_jang;
mod lindstrom_turk;
mod outline;
mod pm;
mod qem;
mod quadric;
mod samples;
mod slopes;
mod spr;
mod volume;
mod wu;

use meshlod_mesh::Connectivity;

use crate::candidates::{Edges, FacesAndEdges};
use crate::engine::{Algorithm, Run};
use crate::methods::appearance::Appearance;
use crate::methods::channels::Channels;
use crate::methods::creases::Creases;
use crate::methods::expectations::Expectations;
use crate::methods::face_order::FaceOrder;
use crate::methods::kim_jang::Conserving;
use crate::methods::lee_jang::Constriction;
use crate::methods::lindstrom_turk::{Memoryless, Stars};
use crate::methods::pm::Energy;
use crate::methods::qem::{Endpoint, Optimal, Quadrics, Rule};
use crate::methods::samples::Samples;
use crate::methods::spr::Turn;
use crate::methods::wu::WeightedMean;
use crate::options::{Method, Options};
use crate::surface::Surface;

/// Sets a method to work on a surface.
pub(crate) fn start(
    options: &Options,
    surface: Surface,
    connectivity: Connectivity,
) -> Box<dyn Run> {
    match options.method {
        Method::Qem => by_quadrics(options, Optimal, surface, connectivity),
        Method::QemEndpoint => by_quadrics(options, Endpoint, surface, connectivity),
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
            memory: Quadrics::new(&surface, &connectivity, ()),
            priority: Optimal,
            placement: Conserving,
        }
        .start(surface, connectivity),
        Method::Pm => Algorithm {
            candidates: Edges,
            memory: Samples::new(&surface, &connectivity),
            priority: Energy,
            placement: Energy,
        }
        .start(surface, connectivity),
        Method::Spr => Algorithm { candidates: Edges, memory: (), priority: Turn, placement: Turn }
            .start(surface, connectivity),
    }
}

/// Quadrics with attributes, where there are any that count.
fn by_quadrics<R: Rule + Copy + 'static>(
    options: &Options,
    rule: R,
    surface: Surface,
    connectivity: Connectivity,
) -> Box<dyn Run> {
    let channels = Channels::new(&surface, &options.weights);
    match (channels, &surface.wedges) {
        (Some(channels), Some(wedges)) => {
            let appearance = Expectations::new(&surface, wedges, channels);
            with_appearance(appearance, rule, surface, connectivity)
        }
        _ => with_appearance((), rule, surface, connectivity),
    }
}

fn with_appearance<A: Appearance + 'static, R: Rule + Copy + 'static>(
    appearance: A,
    rule: R,
    surface: Surface,
    connectivity: Connectivity,
) -> Box<dyn Run> {
    let memory = Quadrics::new(&surface, &connectivity, appearance);
    Algorithm { candidates: Edges, memory, priority: rule, placement: rule }
        .start(surface, connectivity)
}
