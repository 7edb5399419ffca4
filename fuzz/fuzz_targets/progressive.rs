#![no_main]

use meshlod_simplify::{Progressive, ProgressiveError};

libfuzzer_sys::fuzz_target!(init: meshlod_fuzz::plant("progressive"), |bytes: &[u8]| {
    // A mutation with the right checksum is what gets past the door.
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
