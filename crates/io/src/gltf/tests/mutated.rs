//! Arbitrarily changed documents: never a panic, and whatever is read can be written.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::carried::rich;
use super::{json_of, levels, read_alone};
use crate::gltf::document::container;
use crate::gltf::{Compression, write_compressed_glb, write_glb};

/// Reads a document; if that succeeds, the scene must be valid and writable, also with levels.
fn check(bytes: &[u8]) {
    let Ok(scene) = read_alone(bytes) else { return };
    scene.flatten().validate().unwrap();
    let glb = write_glb(&scene, &[]).unwrap();
    read_alone(&glb).unwrap();
    if let Ok(glb) = write_glb(&scene, &levels::levels(&scene)) {
        read_alone(&glb).unwrap();
    }
    for meshopt in [false, true] {
        let how = Compression { meshopt, ..Compression::default() };
        if let Ok((glb, _)) = write_compressed_glb(&scene, &levels::levels(&scene), &how) {
            read_alone(&glb).unwrap();
        }
    }
}

/// Lists every value in a document as a JSON pointer.
fn pointers(value: &Value, at: &str, into: &mut Vec<String>) {
    into.push(at.to_owned());
    match value {
        Value::Array(values) => {
            for (i, value) in values.iter().enumerate() {
                pointers(value, &format!("{at}/{i}"), into);
            }
        }
        Value::Object(entries) => {
            for (key, value) in entries {
                pointers(value, &format!("{at}/{key}"), into);
            }
        }
        _ => {}
    }
}

/// Values that readers may stumble over.
fn odd() -> impl Strategy<Value = Value> {
    let values = [
        json!(null),
        json!(true),
        json!(-1),
        json!(0),
        json!(1),
        json!(5),
        json!(0.5),
        json!(5126),
        json!(u32::MAX),
        json!(u64::MAX),
        json!(1e300),
        json!(""),
        json!("VEC2"),
        json!([]),
        json!([0]),
        json!([[], {}, 0]),
        json!({}),
        json!({ "POSITION": 0 }),
    ];
    prop::sample::select(values.to_vec())
}

proptest! {
    #[test]
    fn any_value_of_the_document(changes in prop::collection::vec((any::<usize>(), odd()), 1..4)) {
        let glb = write_glb(&rich(), &[]).unwrap();
        let buffer = container::split(&glb).unwrap().1.unwrap();
        let mut json = json_of(&glb);
        for (place, value) in changes {
            let mut all = Vec::new();
            pointers(&json, "", &mut all);
            *json.pointer_mut(&all[place % all.len()]).unwrap() = value;
        }
        check(&container::join(json.to_string().as_bytes(), buffer).unwrap());
    }

    #[test]
    fn any_byte_of_a_small_file(changes in prop::collection::vec((any::<usize>(), any::<u8>()), 1..6)) {
        let scene = crate::Scene::from_mesh("cube", meshlod_fixtures::cube());
        let (mut glb, _) = write_compressed_glb(&scene, &[], &Compression::default()).unwrap();
        for (place, byte) in changes {
            let place = place % glb.len();
            glb[place] = byte;
        }
        check(&glb);
    }

    #[test]
    fn any_byte_of_the_file(changes in prop::collection::vec((any::<usize>(), any::<u8>()), 1..6)) {
        let mut glb = write_glb(&rich(), &[]).unwrap();
        for (place, byte) in changes {
            let place = place % glb.len();
            glb[place] = byte;
        }
        check(&glb);
    }
}
