use crate::accept::accept;

/// Reads an SMF.
pub fn run(bytes: &[u8]) {
    if let Ok(mesh) = meshlod_io::smf::read(bytes) {
        accept(&mesh);
    }
}
