//! The three variants of quadric error metrics [GH97], by where they place a vertex and what they
//! remember.

use crate::engine::Algorithm;
use crate::engine::candidates::EdgeCandidates;
use crate::engine::prepared_surface::PreparedSurface;
use crate::methods::attribute_metric::AttributeMetric;
use crate::methods::attribute_quadrics::AttributeQuadrics;
use crate::methods::channels::Channels;
#[cfg(feature = "oracle")]
use crate::methods::qem::Optimal;
use crate::methods::qem::{Endpoint, PlacementRule, Plain, Quadrics, Recipe};
use crate::options::Options;
use crate::run::Run;

/// Starts the general version of the kernel's method.
#[cfg(feature = "oracle")]
pub(super) fn start_optimal(options: &Options, ready: PreparedSurface) -> Box<dyn Run> {
    start(Optimal, options, ready)
}

/// Starts the method that places a vertex at the better end.
pub(super) fn start_endpoint(options: &Options, ready: PreparedSurface) -> Box<dyn Run> {
    start(Endpoint, options, ready)
}

/// Starts the method as first published.
pub(super) fn start_plain(options: &Options, ready: PreparedSurface) -> Box<dyn Run> {
    Algorithm {
        candidates: EdgeCandidates,
        memory: Quadrics::new(Recipe::PLAIN, options, &ready, ()),
        priority: Plain,
        placement: Plain,
    }
    .start(ready)
}

/// Starts a placement rule with our own quadrics, and an attribute term if any attributes count.
fn start<R: PlacementRule + Copy + 'static>(
    rule: R,
    options: &Options,
    ready: PreparedSurface,
) -> Box<dyn Run> {
    let surface = &ready.surface;
    let channels = Channels::new(surface, &options.weights);
    match (channels, &surface.wedges) {
        (Some(channels), Some(wedges)) => {
            let attributes = AttributeQuadrics::new(surface, wedges, channels);
            with_attributes(attributes, rule, options, ready)
        }
        _ => with_attributes((), rule, options, ready),
    }
}

fn with_attributes<A: AttributeMetric + 'static, R: PlacementRule + Copy + 'static>(
    attributes: A,
    rule: R,
    options: &Options,
    ready: PreparedSurface,
) -> Box<dyn Run> {
    let memory = Quadrics::new(Recipe::OURS, options, &ready, attributes);
    Algorithm { candidates: EdgeCandidates, memory, priority: rule, placement: rule }.start(ready)
}
