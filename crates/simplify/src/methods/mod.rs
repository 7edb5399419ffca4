//! Table of the methods, each as a set of policies.

mod attribute_metric;
mod attribute_quadrics;
mod channels;
mod creases;
mod face_order;
mod fan;
pub(crate) mod feature_edges;
mod kim_jang;
mod lee_jang;
mod lindstrom_turk;
mod pm;
pub(crate) mod qem;
mod quadric;
mod samples;
mod slopes;
mod spr;
pub(crate) mod volume;
mod wu;

use crate::engine::candidates::{EdgeCandidates, FaceAndEdgeCandidates};
use crate::engine::{Algorithm, PreparedSurface, Run};
use crate::methods::attribute_metric::AttributeMetric;
use crate::methods::attribute_quadrics::AttributeQuadrics;
use crate::methods::channels::Channels;
use crate::methods::creases::Creases;
use crate::methods::face_order::FaceOrder;
use crate::methods::kim_jang::VolumeConserving;
use crate::methods::lee_jang::Constriction;
use crate::methods::lindstrom_turk::{Memoryless, Stars};
use crate::methods::pm::Energy;
use crate::methods::qem::{Endpoint, Optimal, PlacementRule, Plain, Quadrics, Recipe};
use crate::methods::samples::Samples;
use crate::methods::spr::Turn;
use crate::methods::wu::WeightedMean;
use crate::options::{Method, Options};

/// Starts a simplification method on a prepared surface.
pub(crate) fn start(method: Method, options: &Options, ready: PreparedSurface) -> Box<dyn Run> {
    let surface = &ready.surface;
    match method {
        #[cfg(feature = "oracle")]
        Method::Qem => by_quadrics(options, Optimal, ready),
        Method::QemEndpoint => by_quadrics(options, Endpoint, ready),
        Method::QemPlain => Algorithm {
            candidates: EdgeCandidates,
            memory: quadrics(Recipe::PLAIN, options, &ready, ()),
            priority: Plain,
            placement: Plain,
        }
        .start(ready),
        #[cfg(feature = "oracle")]
        Method::LindstromTurk => Algorithm {
            candidates: EdgeCandidates,
            memory: Stars::new(surface),
            priority: Memoryless::new(options.boundary_weight),
            placement: Memoryless::new(options.boundary_weight),
        }
        .start(ready),
        #[cfg(not(feature = "oracle"))]
        Method::Qem | Method::LindstromTurk => unreachable!("the kernel runs these"),
        Method::LindstromTurkFaces => Algorithm {
            candidates: FaceAndEdgeCandidates,
            memory: Stars::new(surface),
            priority: Memoryless::new(options.boundary_weight),
            placement: Memoryless::new(options.boundary_weight),
        }
        .start(ready),
        Method::LeeJang => Algorithm {
            candidates: FaceAndEdgeCandidates,
            memory: Creases::new(surface, lee_jang::weight),
            priority: FaceOrder::new(surface),
            placement: Constriction,
        }
        .start(ready),
        Method::Wu => Algorithm {
            candidates: FaceAndEdgeCandidates,
            memory: Creases::new(surface, wu::weight),
            priority: FaceOrder::new(surface),
            placement: WeightedMean,
        }
        .start(ready),
        Method::KimJang => Algorithm {
            candidates: EdgeCandidates,
            memory: quadrics(Recipe::OURS, options, &ready, ()),
            priority: Optimal,
            placement: VolumeConserving,
        }
        .start(ready),
        Method::Pm => Algorithm {
            candidates: EdgeCandidates,
            memory: Samples::new(surface, &ready.connectivity),
            priority: Energy,
            placement: Energy,
        }
        .start(ready),
        Method::Spr => {
            Algorithm { candidates: EdgeCandidates, memory: (), priority: Turn, placement: Turn }
                .start(ready)
        }
    }
}

/// Starts a quadric method, with an attribute term if any attributes count.
fn by_quadrics<R: PlacementRule + Copy + 'static>(
    options: &Options,
    rule: R,
    ready: PreparedSurface,
) -> Box<dyn Run> {
    let surface = &ready.surface;
    let channels = Channels::new(surface, &options.weights);
    match (channels, &surface.wedges) {
        (Some(channels), Some(wedges)) => {
            let attributes = AttributeQuadrics::new(surface, wedges, channels);
            with_attributes(attributes, options, rule, ready)
        }
        _ => with_attributes((), options, rule, ready),
    }
}

fn with_attributes<A: AttributeMetric + 'static, R: PlacementRule + Copy + 'static>(
    attributes: A,
    options: &Options,
    rule: R,
    ready: PreparedSurface,
) -> Box<dyn Run> {
    let memory = quadrics(Recipe::OURS, options, &ready, attributes);
    Algorithm { candidates: EdgeCandidates, memory, priority: rule, placement: rule }.start(ready)
}

fn quadrics<A>(
    recipe: Recipe,
    options: &Options,
    ready: &PreparedSurface,
    attributes: A,
) -> Quadrics<A> {
    let recipe = recipe.weighing(options.boundary_weight);
    Quadrics::new(&ready.surface, &ready.connectivity, recipe, attributes)
}
