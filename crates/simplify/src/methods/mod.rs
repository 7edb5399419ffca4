//! The methods as sets of policies, each started from its own file.
//!
//! What else the code asks about a method is in its row of the table of [`Method`].
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `lindstrom_turk`, `qem`, `qem_variants`, `spr`, `pm`, `kim_jang` | methods that contract edges |
//! | `lee_jang`, `wu`, `face_order`, `creases` | methods that contract faces |
//! | `quadric`, `attribute_quadrics`, `attribute_metric`, `channels`, `slopes` | costs |
//! | `volume`, `fan`, `samples` | places and distances |

mod attribute_metric;
mod attribute_quadrics;
mod channels;
mod creases;
mod face_order;
mod fan;
mod kim_jang;
mod lee_jang;
mod lindstrom_turk;
mod pm;
pub(crate) mod qem;
mod qem_variants;
mod quadric;
mod samples;
mod slopes;
mod spr;
pub(crate) mod volume;
mod wu;

#[cfg(feature = "oracle")]
use crate::engine::candidates::EdgeCandidates;
use crate::engine::candidates::FaceAndEdgeCandidates;
use crate::engine::prepared_surface::PreparedSurface;
use crate::method::Method;
use crate::options::Options;
use crate::run::Run;

/// Starts a simplification method on a prepared surface.
pub(crate) fn start(method: Method, options: &Options, ready: PreparedSurface) -> Box<dyn Run> {
    match method {
        #[cfg(feature = "oracle")]
        Method::Qem => qem_variants::start_optimal(options, ready),
        Method::QemEndpoint => qem_variants::start_endpoint(options, ready),
        Method::QemPlain => qem_variants::start_plain(options, ready),
        #[cfg(feature = "oracle")]
        Method::LindstromTurk => lindstrom_turk::start(EdgeCandidates, options, ready),
        #[cfg(not(feature = "oracle"))]
        Method::Qem | Method::LindstromTurk => unreachable!("the kernel runs these"),
        Method::LindstromTurkFaces => lindstrom_turk::start(FaceAndEdgeCandidates, options, ready),
        Method::LeeJang => lee_jang::start(ready),
        Method::Wu => wu::start(ready),
        Method::KimJang => kim_jang::start(options, ready),
        Method::Pm => pm::start(ready),
        Method::Spr => spr::start(ready),
    }
}
