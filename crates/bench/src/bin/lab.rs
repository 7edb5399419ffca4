//! The laboratory as a program, which `cargo xtask results` and its sisters start.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    meshlod_bench::lab(&std::env::args().skip(1).collect::<Vec<_>>())
}
