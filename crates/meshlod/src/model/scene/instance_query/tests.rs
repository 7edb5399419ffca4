//! Queries about a scene, for every instance of its meshes.

use meshlod_io::Scene;

use super::*;
use crate::model::scene::tests::{lossless_file, scene};
use crate::model::verified::extract_verified;

const FOV_RAD: f64 = 0.8;

fn camera(eye: [f64; 3], look: [f64; 3]) -> ViewCamera {
    ViewCamera { eye, look, up: [0.0, 1.0, 0.0], fov_rad: FOV_RAD, viewport: [400, 300] }
}

/// Returns the scene of the cut that a query gives, and the number of faces of its levels.
fn cut(file: &ModelFile<Vec<u8>>, query: &Query<'_>) -> (Scene, usize) {
    let ModelFile::Contractions(archive) = file else { panic!() };
    let model = ModelScene::read(archive).unwrap();
    let (query, _) = model.query_of_levels(file, query, None).unwrap();
    let found = extract_verified(file, &query).unwrap();
    let level = found.extract.level.mesh();
    let faces = level.faces.len();
    (model.into_scene("", level).unwrap(), faces)
}

/// Returns the world triangles of an instance of a scene.
fn shown(scene: &Scene, instance: &MeshInstance) -> Vec<[DVec3; 3]> {
    let world = DMat4::from_cols_array_2d(&instance.transform);
    let mesh = &scene.meshes[instance.mesh].mesh;
    let corners = |&face: &[_; 3]| mesh.triangle(face).map(|at| world.transform_point3(at));
    mesh.faces.iter().map(corners).collect()
}

/// Returns how many points of all instances in the focus are farther than `allowed` from the other scene.
fn beyond(
    scenes: [&Scene; 2],
    is_in: &dyn Fn(DVec3) -> bool,
    allowed: &dyn Fn(DVec3) -> f64,
) -> [usize; 2] {
    let [mut far, mut all] = [0; 2];
    for (a, b) in scenes[0].instances().iter().zip(&scenes[1].instances()) {
        let [from, to] = [shown(scenes[0], a), shown(scenes[1], b)];
        for &[p, q, r] in &from {
            for at in [p, (p + q) / 2.0, (p + q + r) / 3.0].into_iter().filter(|&at| is_in(at)) {
                let near = to.iter().map(|corners| closest_point(at, corners).distance(at));
                all += 1;
                far += usize::from(near.fold(f64::INFINITY, f64::min) > allowed(at) + 1e-5);
            }
        }
    }
    [far, all]
}

#[test]
fn every_instance_is_as_fine_as_asked() {
    let file = ModelFile::open(lossless_file(scene())).unwrap();
    let (finest, most) = cut(&file, &Query::finest());
    let on_face = |instance: &MeshInstance| shown(&finest, instance)[7].iter().sum::<DVec3>() / 3.0;
    let middles: Vec<DVec3> = finest.instances().iter().map(on_face).collect();
    for &middle in &middles {
        let camera = camera((middle + DVec3::new(0.3, 0.8, 4.0)).to_array(), middle.to_array());
        let eye = DVec3::from(camera.eye);
        let slope = 4.0 * camera.pixel();
        let pixels = Tolerance::Pixels { camera, pixels: 4.0 };
        let (found, faces) = cut(&file, &Query { focus: Focus::Everything, tolerance: pixels });
        for scenes in [[&found, &finest], [&finest, &found]] {
            let [far, all] = beyond(scenes, &|_| true, &|at| slope * at.distance(eye));
            assert!(far == 0 && all > 100, "{middle}: {far} of {all} from {eye}");
        }
        assert!(10 * faces < 9 * most, "{faces} of {most}");
        let ball = Focus::Sphere { center: middle.to_array(), radius: 0.8 };
        let low = (middle - 0.7).to_array();
        let focus = Focus::Box([low, (middle + 0.7).to_array()]);
        for focus in [ball, focus, Focus::Frustum(camera)] {
            let is_in = |at: DVec3| match &focus {
                Focus::Box(_) => (at - middle).abs().max_element() < 0.7,
                Focus::Sphere { .. } => at.distance(middle) < 0.8,
                _ => {
                    let [forward, ahead] = [middle - eye, at - eye].map(DVec3::normalize);
                    forward.dot(ahead) > (0.5 * FOV_RAD).cos()
                }
            };
            let asked = Query { focus: focus.clone(), tolerance: Tolerance::Uniform(0.02) };
            let (found, faces) = cut(&file, &asked);
            for scenes in [[&found, &finest], [&finest, &found]] {
                let [far, all] = beyond(scenes, &is_in, &|_| 0.02);
                assert!(far == 0 && all > 10, "{focus:?}: {far} of {all}");
            }
            assert!(10 * faces < 9 * most, "{faces} of {most}");
        }
    }
}

#[test]
fn a_point_is_the_closest_one_shown() {
    let file = ModelFile::open(lossless_file(scene())).unwrap();
    let ModelFile::Contractions(archive) = &file else { panic!() };
    let model = ModelScene::read(archive).unwrap();
    let (finest, _) = cut(&file, &Query::finest());
    for (index, instance) in finest.instances().iter().enumerate() {
        let place = InstancePlace::new(
            instance.mesh,
            DMat4::from_cols_array_2d(
                &model.head.meshes[instance.mesh].as_ref().unwrap().placement,
            ),
            DMat4::from_cols_array_2d(&instance.transform),
        );
        let Some(to_levels) = place.to_levels else { continue };
        let [a, b, c] = shown(&finest, instance)[7];
        let point = ((a + b + c) / 3.0).to_array();
        let asked = Query { focus: Focus::Point(point), ..Query::uniform(0.1) };
        let (query, found) = model.query_of_levels(&file, &asked, None).unwrap();
        let there = to_levels.transform_point3(point.into());
        assert!(there.distance(found.unwrap().into()) < 1e-9, "{index}");
        let Focus::Sphere { radius, .. } = query.focus else { panic!("{query:?}") };
        assert!((radius * place.growth - 0.1).abs() < 1e-9 && radius >= 0.1 - 1e-9);
    }
}

#[test]
fn too_many_places_are_taken_together() {
    let queries = |count: usize| -> Vec<Query<'static>> {
        let pixels = |k| Query::pixels(camera([0.0, 0.0, 5.0 + 1e-4 * k as f64], [0.0; 3]), 1.0);
        (0..count).map(pixels).collect()
    };
    let around = Bounds { min: [-1.0; 3], max: [1.0; 3] };
    assert_eq!(needed(queries(MOST_PLACES), &around).len(), MOST_PLACES);
    let one = needed(queries(MOST_PLACES + 1), &around);
    let slope = camera([0.0; 3], [1.0; 3]).pixel();
    let [Query { focus: Focus::Everything, tolerance: Tolerance::Uniform(most) }] = &one[..] else {
        panic!("{one:?}")
    };
    assert!((most - 4.0 * slope).abs() < 1e-12, "the closest place is 4 away");
    let mut far = queries(2);
    far[1] = Query::pixels(camera([0.0, 0.0, 90.0], [0.0; 3]), 1.0);
    assert_eq!(needed(far, &around).len(), 1, "the nearer one implies the other");
}
