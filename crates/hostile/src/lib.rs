//! Hostile bytes for every reader and for the engine: what the fuzzers run, and what they found.
//!
//! A target is a function of bytes. `cargo fuzz run -s none ply` has a fuzzer look for bytes that
//! break the target `ply`; the test `kept` replays its seeds, and the interesting inputs of long
//! runs, which are in `fuzz/kept`.
#![forbid(unsafe_code)]

mod accept;
mod draco;
mod kept;
mod models;
mod seeds;
mod targets;

pub use kept::{inputs, keep, plant};
pub use targets::{run, targets};
