//! The GPU, for the verbs that draw with it: `view` and `render --gpu`. It is there with the feature
//! `view`; without it the same arguments are understood, and the answer says how to get it.

#[cfg(feature = "view")]
pub mod film;
#[cfg(feature = "view")]
pub mod still;

/// Message of verbs that need the GPU, in a program that was built without it.
#[cfg(not(feature = "view"))]
pub const MISSING: &str = "this meshlod was built without the viewer; build it with the feature \
                           view, as by cargo install --path crates/cli --features view";
