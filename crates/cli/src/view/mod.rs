//! Modes of the verb `view`, one a file.

pub mod window;
