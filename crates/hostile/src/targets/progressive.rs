use meshlod_simplify::{Progressive, ProgressiveError};

use crate::accept::accept;

/// Refines a progressive mesh to its end.
pub fn run(bytes: &[u8]) {
    // With the right checksum, more mutations get past the header.
    let mut bytes = bytes.to_vec();
    Progressive::seal(&mut bytes);
    match Progressive::from_bytes(&bytes) {
        Err(error) => assert_ne!(error, ProgressiveError::Checksum),
        Ok(mut progressive) => loop {
            accept(&progressive.level());
            if !progressive.refine() {
                break;
            }
        },
    }
}
