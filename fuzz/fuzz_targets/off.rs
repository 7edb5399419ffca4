#![no_main]

libfuzzer_sys::fuzz_target!(init: meshlod_fuzz::plant("off"), |bytes: &[u8]| {
    if let Ok(mesh) = meshlod_io::off::read(bytes) {
        meshlod_fuzz::accept(&mesh);
    }
});
