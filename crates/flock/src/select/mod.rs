//! Choice of a level for every member of a flock, frame by frame.
//!
//! A [`Selector`] holds a [`Policy`] and the level table of a model. Its answer for a frame is one
//! [`InstanceLevel`] a member, two bytes each, by which a renderer sorts its instances to draw each
//! level once. Members that are small on the screen can be impostors with any policy: see
//! [`Budget::impostors_below_px`].
//!
//! To read: `policy` and `view`, the contract; `policies`, the table and one file each, with
//! `chain_levels` as their lookup by distance; `selector`, which asks them; `impostor_tier` after
//! them.

mod budget;
mod chain_levels;
mod impostor_tier;
mod instance_level;
pub mod policies;
mod policy;
mod selector;
mod view;

pub use budget::Budget;
pub use chain_levels::ChainLevels;
pub use instance_level::{Appearance, InstanceLevel};
pub use policies::{Bias, PolicyName};
pub use policy::Policy;
pub use selector::Selector;
pub use view::{LANES, Lanes, View};
