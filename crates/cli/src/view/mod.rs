//! Drawing on the GPU, for `view` and `render --gpu`; one mode a file.
//!
//! It is there with the feature `view`. Without it the same arguments are understood, and the answer
//! says how to get it.

#[cfg(feature = "view")]
pub mod film;
#[cfg(feature = "view")]
pub mod school;
#[cfg(feature = "view")]
pub mod still;
#[cfg(feature = "view")]
pub mod window;

/// Message of what needs the GPU, in a program that was built without it.
#[cfg(not(feature = "view"))]
pub const MISSING: &str = "this build has no viewer; get it with: cargo install --path crates/cli \
                           --features view";
