#![no_main]

libfuzzer_sys::fuzz_target!(init: meshlod_fuzz::plant("stl"), |bytes: &[u8]| {
    if let Ok(mesh) = meshlod_io::stl::read(bytes) {
        meshlod_fuzz::accept(&mesh);
    }
});
