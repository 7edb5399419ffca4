//! What is wrong with a mesh, where its objects touch, what can be mended, what must not move.
#![forbid(unsafe_code)]

mod check;
mod cubes;
mod finding;
mod fuse;
mod imprint;
mod intersect;
mod joined;
mod kinds;
mod locks;
mod objects;
mod places;
mod repair;
mod summary;
mod zero_area;

pub use check::{CheckOptions, check, findings, first, is_clean};
pub use cubes::{Cubes, MarkedCube};
pub use finding::{Degeneracy, Finding, Kind, Severity, Touch, TouchKind};
pub use fuse::{Fused, fuse};
pub use imprint::{Imprint, imprint};
pub use intersect::Net;
pub use kinds::Kinds;
pub use locks::{LockOptions, LockReason, Locking, locks};
pub use objects::{ObjectId, Objects, ObjectsBy};
pub use places::Places;
pub use repair::{HoleLimits, RepairOptions, RepairReport, RepairStep, repair};
pub use summary::Summary;
