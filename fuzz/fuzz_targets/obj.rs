#![no_main]

libfuzzer_sys::fuzz_target!(init: meshlod_fuzz::plant("obj"), |bytes: &[u8]| {
    // Any material library it names is the file itself, so that this reader is reached too.
    if let Ok(scene) = meshlod_io::obj::read(bytes, &mut |_| Some(bytes.to_vec())) {
        meshlod_fuzz::accept_scene(&scene);
    }
});
