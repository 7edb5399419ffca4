#![no_main]

libfuzzer_sys::fuzz_target!(init: meshlod_fuzz::plant("smf"), |bytes: &[u8]| {
    if let Ok(mesh) = meshlod_io::smf::read(bytes) {
        meshlod_fuzz::accept(&mesh);
    }
});
