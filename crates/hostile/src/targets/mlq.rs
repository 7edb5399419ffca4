use meshlod_codec::Compressed;

use crate::accept::accept;

/// Decodes a resident mesh, whole and by patches.
pub fn run(bytes: &[u8]) {
    // With the right checksums, more mutations get past the header.
    let mut bytes = bytes.to_vec();
    Compressed::seal(&mut bytes);
    let Ok(compressed) = Compressed::from_bytes(&bytes) else { return };
    if let Some(strips) = compressed.stored().ok().and_then(|stored| stored.strips) {
        let count = |part| strips.bytes(part).len() / strips.index_bytes(part);
        assert!((0..strips.parts()).all(|part| strips.indices(part).count() == count(part)));
    }
    if let Ok(mesh) = compressed.decode() {
        accept(&mesh);
    }
    for at in 0..compressed.patches() {
        if let Ok(mesh) = compressed.patch(at) {
            accept(&mesh);
        }
    }
}
