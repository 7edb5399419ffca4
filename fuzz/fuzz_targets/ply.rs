#![no_main]

libfuzzer_sys::fuzz_target!(init: meshlod_fuzz::plant("ply"), |bytes: &[u8]| {
    if let Ok(mesh) = meshlod_io::ply::read(bytes) {
        meshlod_fuzz::accept(&mesh);
    }
});
