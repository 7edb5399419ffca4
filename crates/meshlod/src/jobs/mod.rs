//! Jobs: what every program asks for, each written once.
//!
//! A job takes what it works on, a request and a [`Watch`], and returns an output and a report:
//! `simplify(scene, &request, &watch) -> Result<(Scene, SimplifyReport), JobError>`. A request is
//! plain data, which the feature `serde` reads and writes; a report is what the command prints with
//! `--json`. The command, the Python package and the viewer only translate: arguments into
//! requests, reports into text.
//!
//! A job reads no file and writes none. [`AnyFile`](crate::AnyFile) opens what it works on,
//! [`Output`](crate::Output) says where the result goes and in which format.

mod error;
#[cfg(feature = "serde")]
pub mod figures;
#[cfg(feature = "check")]
mod lods;
#[cfg(feature = "check")]
mod scene_run;
#[cfg(feature = "check")]
mod simplify;
#[cfg(feature = "check")]
mod switching;
mod watch;

pub use error::JobError;
#[cfg(feature = "check")]
pub use lods::{LodChain, LodReport, LodsReport, LodsRequest, chain_samples, lods};
#[cfg(feature = "check")]
pub use simplify::{
    Aim, LostVolume, ProvedError, SimplifyReport, SimplifyRequest, WrittenAs, simplify,
};
#[cfg(feature = "check")]
pub use switching::{Switch, SwitchCamera};
pub use watch::{About, Remark, Watch};
pub(crate) use watch::{Contractions, cancellable};
