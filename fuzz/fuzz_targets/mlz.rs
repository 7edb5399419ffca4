#![no_main]

use meshlod_codec::{Malformed, TransportFile};

libfuzzer_sys::fuzz_target!(init: meshlod_fuzz::plant("mlz"), |bytes: &[u8]| {
    // With the right checksums, more mutations get past the header.
    let mut bytes = bytes.to_vec();
    TransportFile::seal(&mut bytes);
    let _ = decode(&bytes);
});

/// Decodes each block by itself, all together, and what is attached.
fn decode(bytes: &[u8]) -> Result<(), Malformed> {
    let file = TransportFile::open(bytes)?;
    for block in 0..file.blocks() {
        if let Ok(block) = file.block(block) {
            meshlod_fuzz::accept(&block);
        }
    }
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    file.decode_into(&mut positions, &mut faces)?;
    assert!(positions.iter().flatten().all(|x| x.is_finite()));
    meshlod_fuzz::accept(&file.decode()?);
    file.resources().map(|_| ())
}
