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

mod candidates;
mod charts;
mod checks;
mod clean;
mod contracted;
mod engine;
mod estimate;
mod exact_volume;
mod history;
mod interpolate;
mod kernel;
mod level;
mod locks;
mod methods;
mod nearest;
mod neighbourhood;
mod options;
mod policy;
mod progressive;
mod queue;
mod refusal;
mod simplifier;
mod surface;
mod ties;
mod vanishing;
mod volume;
mod wedges;

use meshlod_mesh::Mesh;

pub use contracted::{Contracted, Freedom};
pub use exact_volume::{Digits, ExactVolumeError, VolumeResidual, conserve_volume};
pub use history::{Contraction, History};
pub use locks::Held;
pub use neighbourhood::{Dying, Neighbourhood, RingVertex, Spoke};
pub use options::{AttributeWeights, Method, Options, Report, SimplifyError, Target};
pub use policy::Observe;
pub use progressive::{Progressive, ProgressiveError};
pub use refusal::{Refusal, Refusals};
pub use simplifier::Simplifier;
pub use surface::{Placed, Surface};
pub use volume::{Unconserved, VolumeLoss};

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
