#![no_main]

use meshlod_simplify::{Progressive, ProgressiveError};

libfuzzer_sys::fuzz_target!(init: meshlod_fuzz::plant("progressive"), |bytes: &[u8]| {
    // With the right checksum, more mutations get past the header.
    let mut bytes = bytes.to_vec();
    Progressive::seal(&mut bytes);
    match Progressive::from_bytes(&bytes) {
        Err(error) => assert_ne!(error, ProgressiveError::Checksum),
        Ok(mut progressive) => loop {
            meshlod_fuzz::accept(&progressive.level());
            if !progressive.refine() {
                break;
            }
        },
    }
});
