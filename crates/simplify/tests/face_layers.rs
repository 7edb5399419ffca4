//! Layers of faces stay with their faces, whatever method simplifies.

use meshlod_fixtures as fixtures;
use meshlod_mesh::{
    Borders, ConditionOptions, FaceLayer, FaceLayerKind, Labels, Locks, Mesh, condition,
};
use meshlod_samples as samples;
use meshlod_simplify::{History, Method, Options, Progressive, Simplifier, Target};

/// Gives each face its number, as a layer and as its object.
fn numbered(mesh: Mesh) -> Mesh {
    let faces = mesh.faces.len();
    let names = (0..faces).map(|face| face.to_string()).collect();
    let objects = Some(Labels { names, of_face: (0..faces as u32).collect() });
    let layer = |kind, name: &str, factor: f64| FaceLayer {
        kind,
        name: name.to_owned(),
        values: (0..faces).map(|face| face as f64 * factor).collect(),
    };
    let face_layers = vec![
        layer(FaceLayerKind::Smoothing, "groups", 1.0),
        layer(FaceLayerKind::Other, "quality", -0.1),
    ];
    Mesh { objects, face_layers, ..mesh }
}

/// Checks that every face has the numbers of the face whose object it has.
fn assert_numbers(level: &Mesh, what: &str) {
    assert_eq!(level.validate(), Ok(()), "{what}");
    let faces = &level.objects.as_ref().unwrap().of_face;
    let [groups, quality] = &level.face_layers[..] else { panic!("{what}: layers") };
    for (i, &face) in faces.iter().enumerate() {
        assert_eq!(groups.values[i], f64::from(face), "{what}: face {i}");
        assert_eq!(quality.values[i], f64::from(face) * -0.1, "{what}: face {i}");
    }
}

#[test]
fn every_method_keeps_the_numbers_of_the_faces_that_are_left() {
    // Few objects: where each face is one, its borders are all that is left.
    let mesh = numbered(samples::knot(2000));
    let plain = Mesh { objects: None, ..mesh.clone() };
    for method in Method::ALL {
        let options = Options { method, ..Options::default() };
        let mut history = History::default();
        let mut simplifier = Simplifier::new(&plain, &options).unwrap();
        simplifier.run(Target::Ratio(0.1), &mut history).unwrap();
        let level = simplifier.level();
        assert!(level.faces.len() < 300, "{method:?}: {}", level.faces.len());
        let quality = &level.face_layers[1].values;
        assert!(quality.windows(2).all(|pair| pair[1] < pair[0]), "{method:?}: order");
        assert!(quality.iter().all(|value| mesh.face_layers[1].values.contains(value)));
        let Some(mut progressive) = Progressive::new(simplifier, history) else { continue };
        assert_eq!(progressive.level().face_layers, level.face_layers, "{method:?}");
        progressive.go_to(usize::MAX);
        assert_eq!(progressive.level().face_layers, mesh.face_layers, "{method:?}");
    }
}

#[test]
fn numbers_and_objects_agree_at_every_face() {
    for method in [Method::LindstromTurk, Method::Qem, Method::QemPlain] {
        let mesh = numbered(samples::terrain(600));
        let options = Options { method, ..Options::default() };
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        simplifier.run(Target::Ratio(0.5), &mut ()).unwrap();
        let level = simplifier.level();
        assert!(level.faces.len() < mesh.faces.len(), "{method:?}");
        assert_numbers(&level, &format!("{method:?}"));
    }
}

#[test]
fn conditioning_keeps_the_numbers_of_the_faces_that_stay() {
    let mut mesh = fixtures::hourglass();
    mesh.faces.push(mesh.faces[0]);
    let mesh = numbered(mesh);
    let options = ConditionOptions { borders: Borders::Stitch, ..ConditionOptions::default() };
    let conditioned = condition(&mesh, &Locks::default(), &options).unwrap().mesh;
    assert_eq!(conditioned.faces.len() + 1, mesh.faces.len());
    assert_numbers(&conditioned, "hourglass");
}
