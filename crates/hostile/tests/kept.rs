//! Replays the seeds of the fuzz targets, and what long runs of the fuzzers found.

use meshlod_hostile::{inputs, run, targets};

/// An input that a target is about to run; says which one it was if the target panics.
struct Shown<'i> {
    target: &'i str,
    input: &'i [u8],
}

impl Drop for Shown<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("the target {} with these bytes: {:?}", self.target, self.input);
        }
    }
}

fn replay(target: &str) {
    let inputs = inputs(target);
    assert!(!inputs.is_empty(), "{target} has neither seeds nor kept inputs");
    for input in &inputs {
        let _shown = Shown { target, input };
        run(target, input);
    }
}

/// A test for each target, and one that none is forgotten.
macro_rules! replayed {
    ($($target:ident),*) => {
        $(#[test]
        fn $target() {
            replay(stringify!($target));
        })*

        #[test]
        fn every_target_is_replayed() {
            assert!(targets().eq([$(stringify!($target)),*]));
        }
    };
}

replayed!(
    check,
    draco,
    gltf,
    mlod,
    mlq,
    mlz,
    mtl,
    obj,
    off,
    ply,
    progressive,
    simplify,
    skeleton,
    smf,
    stl
);
