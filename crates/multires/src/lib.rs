#![doc = "stub"]
#![forbid(unsafe_code)]

mod cut;
mod explicit;
mod forest;
mod frame;
mod implicit;
mod level;
mod need;
mod query;
mod record;

#[cfg(test)]
mod tests;

pub use cut::{Certificate, Change, Cut, Effort, Patch, Unsound};
pub use explicit::{Explicit, ExplicitCut};
pub use forest::{BuildError, Forest};
pub use frame::Frame;
pub use implicit::{Extractor, Faces, Implicit, Links, Rule, Saturated};
pub use level::Level;
pub use query::{Camera, Focus, Query, QueryError, Tolerance};
pub use record::Recorder;
