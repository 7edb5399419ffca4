//! Coarser triangle meshes: one contraction engine, algorithms as sets of policies.
//!
//! ```
//! use meshlod_samples as samples;
//! use meshlod_simplify::{Options, Target, simplify};
//!
//! let mesh = samples::sphere(1000);
//! let (level, report) = simplify(&mesh, Target::Ratio(0.1), &Options::default())?;
//! assert!(report.reached && level.faces.len() <= 100);
//! # Ok::<(), meshlod_simplify::SimplifyError>(())
//! ```
//!
//! Same input, same options, same bytes out, for any number of threads. After every contraction the
//! surface is as manifold, as closed and as oriented as before.
#![deny(unsafe_code)]

mod clean;
mod engine;
mod history;
mod kernel;
mod methods;
mod options;
mod refusal;
mod simplifier;
mod surface;

use meshlod_mesh::Mesh;

pub use engine::locks::Held;
pub use engine::policy::Observe;
pub use history::exact_volume::{Digits, ExactVolumeError, VolumeResidual, conserve_volume};
pub use history::progressive::{Progressive, ProgressiveError};
pub use history::volume::{Unconserved, VolumeLoss};
pub use history::{Contraction, History};
pub use options::{AttributeWeights, Method, Options, Report, SimplifyError, Target};
pub use refusal::{Refusal, Refusals};
pub use simplifier::Simplifier;
pub use surface::contracted::{Contracted, Freedom};
pub use surface::neighbourhood::{Dying, Neighbourhood, RingVertex, Spoke};
pub use surface::{Placed, Surface};

/// A coarser mesh, and what was done to get it.
///
/// The result holds only what its faces use. A target out of reach is approached as far as the
/// rules allow; the report says so, and why.
pub fn simplify(
    mesh: &Mesh,
    target: Target,
    options: &Options,
) -> Result<(Mesh, Report), SimplifyError> {
    let mut simplifier = Simplifier::new(mesh, options)?;
    let report = simplifier.run(target, &mut ())?;
    Ok((simplifier.level(), report))
}
