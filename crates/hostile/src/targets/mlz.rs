use meshlod_codec::{Malformed, TransportFile};

use crate::accept::accept;

/// Decodes a mesh that was sent, whole and by blocks.
pub fn run(bytes: &[u8]) {
    // With the right checksums, more mutations get past the header.
    let mut bytes = bytes.to_vec();
    TransportFile::seal(&mut bytes);
    let _ = decode(&bytes);
}

/// Decodes each block by itself, all together, and what is attached.
fn decode(bytes: &[u8]) -> Result<(), Malformed> {
    let file = TransportFile::open(bytes)?;
    for block in 0..file.blocks() {
        if let Ok(block) = file.block(block) {
            accept(&block);
        }
    }
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    file.decode_into(&mut positions, &mut faces)?;
    assert!(positions.iter().flatten().all(|x| x.is_finite()));
    accept(&file.decode()?);
    file.resources().map(|_| ())
}
