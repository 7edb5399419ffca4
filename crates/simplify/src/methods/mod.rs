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
pub(crate) mod qem;
mod quadric;
mod samples;
mod slopes;
mod spr;
mod volume;
mod wu;

use crate::engine::candidates::{Edges, FacesAndEdges};
use crate::engine::{Algorithm, Ready, Run};
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

/// Sets a method to work.
pub(crate) fn start(method: Method, options: &Options, ready: Ready) -> Box<dyn Run> {
    let surface = &ready.surface;
    match method {
        #[cfg(feature = "oracle")]
        Method::Qem => by_quadrics(options, Optimal, ready),
        Method::QemEndpoint => by_quadrics(options, Endpoint, ready),
        #[cfg(feature = "oracle")]
        Method::LindstromTurk => Algorithm {
            candidates: Edges,
            memory: Stars::new(surface),
            priority: Memoryless::new(options.boundary_weight),
            placement: Memoryless::new(options.boundary_weight),
        }
        .start(ready),
        #[cfg(not(feature = "oracle"))]
        Method::Qem | Method::LindstromTurk => unreachable!("the kernel runs these"),
        Method::LindstromTurkFaces => Algorithm {
            candidates: FacesAndEdges,
            memory: Stars::new(surface),
            priority: Memoryless::new(options.boundary_weight),
            placement: Memoryless::new(options.boundary_weight),
        }
        .start(ready),
        Method::LeeJang => Algorithm {
            candidates: FacesAndEdges,
            memory: Creases::new(surface, lee_jang::weight),
            priority: FaceOrder::new(surface),
            placement: Constriction,
        }
        .start(ready),
        Method::Wu => Algorithm {
            candidates: FacesAndEdges,
            memory: Creases::new(surface, wu::weight),
            priority: FaceOrder::new(surface),
            placement: WeightedMean,
        }
        .start(ready),
        Method::KimJang => Algorithm {
            candidates: Edges,
            memory: Quadrics::new(surface, &ready.connectivity, options.boundary_weight, ()),
            priority: Optimal,
            placement: Conserving,
        }
        .start(ready),
        Method::Pm => Algorithm {
            candidates: Edges,
            memory: Samples::new(surface, &ready.connectivity),
            priority: Energy,
            placement: Energy,
        }
        .start(ready),
        Method::Spr => Algorithm { candidates: Edges, memory: (), priority: Turn, placement: Turn }
            .start(ready),
    }
}

/// Quadrics with attributes, where there are any that count.
fn by_quadrics<R: Rule + Copy + 'static>(options: &Options, rule: R, ready: Ready) -> Box<dyn Run> {
    let surface = &ready.surface;
    let channels = Channels::new(surface, &options.weights);
    match (channels, &surface.wedges) {
        (Some(channels), Some(wedges)) => {
            let appearance = Expectations::new(surface, wedges, channels);
            with_appearance(appearance, options, rule, ready)
        }
        _ => with_appearance((), options, rule, ready),
    }
}

fn with_appearance<A: Appearance + 'static, R: Rule + Copy + 'static>(
    appearance: A,
    options: &Options,
    rule: R,
    ready: Ready,
) -> Box<dyn Run> {
    let Ready { surface, connectivity, .. } = &ready;
    let memory = Quadrics::new(surface, connectivity, options.boundary_weight, appearance);
    Algorithm { candidates: Edges, memory, priority: rule, placement: rule }.start(ready)
}
