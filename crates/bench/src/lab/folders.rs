//! Where the laboratory reads and writes.

use std::path::Path;

/// Returns the root folder of the project that this program was compiled from.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}
