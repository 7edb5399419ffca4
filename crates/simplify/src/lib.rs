//! Simplifies triangle meshes by contraction, with the published algorithms of [`Method`].
//!
//! ```
//! use meshlod_samples as samples;
//! use meshlod_simplify::{Options, Target, contract_to};
//!
//! let mesh = samples::sphere(1000);
//! let (level, report) = contract_to(&mesh, Target::Ratio(0.1), &Options::default())?;
//! assert!(report.reached && level.faces.len() <= 100);
//! # Ok::<(), meshlod_simplify::SimplifyError>(())
//! ```
//!
//! Two engines run the methods: the kernel runs [`Method::LindstromTurk`] and [`Method::Qem`], and the
//! policy engine runs the others, each as a set of policies. The method alone decides.
//!
//! The output depends on the input and the options alone, byte for byte, for any number of threads.
//! After every contraction the surface is as manifold, as closed and as oriented as before.
#![deny(unsafe_code)]

mod clean;
mod engine;
mod excess;
mod flat;
mod held;
mod history;
mod kernel;
mod method;
mod methods;
mod options;
mod refusal;
mod run;
mod simplifier;
mod surface;

use meshlod_mesh::Mesh;

pub use engine::policy::Observe;
pub use excess::{Excess, ExcessFace};
pub use flat::{FlatNeeds, FlatOptions, Flattened, flat_needs, flat_part, flatten};
pub use held::Held;
pub use history::exact_volume::{Digits, ExactVolumeError, VolumeResidual, conserve_volume};
pub use history::progressive::{Progressive, ProgressiveError};
pub use history::volume::{Unconserved, VolumeLoss};
pub use history::{Contraction, History};
pub use method::Method;
pub use options::{
    AttributeWeights, Contractions, ErrorProof, HandleCounts, Options, Report, SimplifyError,
    Target, Topology,
};
pub use refusal::{Refusal, Refusals};
pub use simplifier::Simplifier;
pub use surface::contracted::{Contracted, Freedom};
pub use surface::neighbourhood::{Neighbourhood, RemovedFace, RingVertex, Spoke};
pub use surface::{Placed, Surface};

/// Contracts a mesh to a target number of faces or error, and returns the result with a report.
///
/// The mesh is not conditioned before, and an error is what the method makes of it: the facade
/// `meshlod` has a `simplify` that does the one and proves the other. The result holds only what its faces use. If the target is out of reach, the mesh is reduced as
/// far as the rules allow, and the report says so and counts the reasons.
///
/// # Errors
/// The mesh, the target or an option is invalid, see [`SimplifyError`].
pub fn contract_to(
    mesh: &Mesh,
    target: Target,
    options: &Options,
) -> Result<(Mesh, Report), SimplifyError> {
    let mut simplifier = Simplifier::new(mesh, options)?;
    let mut report = simplifier.run(target, &mut ())?;
    Ok((simplifier.settled_level(&mut report.volume), report))
}
