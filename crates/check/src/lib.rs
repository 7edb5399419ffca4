//! Checks triangle meshes for defects and contacts between objects, repairs them, and finds the
//! vertices that simplification must keep.
//!
//! [`check`](check()) reports [`Finding`]s by kind, [`repair`](repair()) mends what can be mended
//! safely, [`imprint`](imprint()) and [`fuse`](fuse()) treat components that pass through each
//! other, and [`locks`](locks()) holds vertices at contacts and boundaries.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `finding`, `place`, `kinds`, `summary` | a finding, and counts of them |
//! | `check`, `zero_area`, `unique_positions`, `intersect` | the search for defects |
//! | `objects`, `object_octree`, `box_blocks` | objects, and where they may meet |
//! | `repair`, `locks` | repair, and vertices to keep |
//! | `imprint`, `fuse` | components that pass through each other |
#![forbid(unsafe_code)]

mod box_blocks;
mod check;
mod finding;
mod fuse;
mod imprint;
mod intersect;
mod kinds;
mod locks;
mod object_octree;
mod objects;
mod place;
mod repair;
mod summary;
mod unique_positions;
mod zero_area;

pub use check::{CheckOptions, check, findings, first_finding, is_clean};
pub use finding::{Degeneracy, Finding, Intersection, IntersectionKind, Kind, Severity};
pub use fuse::{Fused, fuse};
pub use imprint::{Imprint, imprint};
pub use intersect::BroadPhase;
pub use kinds::Kinds;
pub use locks::{ContactPolicy, LockOptions, LockReason, VertexLocks, locks};
pub use object_octree::{ObjectLeaf, ObjectOctree};
pub use objects::{ObjectId, Objects, ObjectsBy};
pub use repair::{HoleLimits, RepairOptions, RepairReport, RepairStep, Stitch, repair};
pub use summary::Summary;
pub use unique_positions::UniquePositions;
