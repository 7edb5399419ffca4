use crate::accept::accept;

/// Reads an OFF.
pub fn run(bytes: &[u8]) {
    if let Ok(mesh) = meshlod_io::off::read(bytes) {
        accept(&mesh);
    }
}
