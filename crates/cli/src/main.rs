//! The command `meshlod`.
#![forbid(unsafe_code)]

fn main() {}
