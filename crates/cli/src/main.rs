//! The program `meshlod`: the command of `meshlod_cli` in a process of its own.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    meshlod_cli::end_at_signals();
    meshlod_cli::run(std::env::args_os()).into()
}
