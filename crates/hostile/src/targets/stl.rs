use crate::accept::accept;

/// Reads an STL.
pub fn run(bytes: &[u8]) {
    if let Ok(mesh) = meshlod_io::stl::read(bytes) {
        accept(&mesh);
    }
}
