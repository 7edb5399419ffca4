//! Strips of levels, asked for as a job.

use meshlod_samples as samples;

use super::*;

fn knot() -> Scene {
    Scene::from_mesh("knot", samples::knot(1_000))
}

#[test]
fn every_filter_draws_every_level() {
    use StripFilter::{Dtff, None as Unfiltered, Repair, Stss};
    let filters = [None, Some(Unfiltered), Some(Stss), Some(Dtff), Some(Repair)];
    for filter in filters {
        let levels = vec![Target::Ratio(0.1), Target::Ratio(1.0), Target::Faces(300)];
        let request = StripRequest { levels, filter, verify: true, ..StripRequest::default() };
        let (stripped, report) = strip(knot(), &request, &()).unwrap();
        assert_eq!(report.verified, Some(true), "{filter:?}");
        assert_eq!(report.strip_seconds.is_some(), filter.is_some());
        let sizes: Vec<&str> = report.levels.iter().map(|level| &level.size[..]).collect();
        assert_eq!(sizes, ["10%", "100%", "300 faces"]);
        // The finest comes first, whichever was listed first.
        let meshes = stripped.strip_meshes();
        let finest: usize = meshes[0].levels[0].iter().map(Vec::len).sum();
        assert!(finest > report.levels[1].triangles);
    }
}

#[test]
fn sizes_out_of_range_are_refused() {
    for (size, text) in [
        (Target::Ratio(0.0), "0%"),
        (Target::Faces(0), "0 faces"),
        (Target::Faces(5_000), "5000 faces"),
        (Target::Error(0.1), "an error of 0.1"),
    ] {
        let request = StripRequest { levels: vec![size], ..StripRequest::default() };
        let error = strip(knot(), &request, &()).unwrap_err();
        assert!(matches!(error, JobError::Request { field: "levels", .. }), "{error}");
        assert!(error.to_string().starts_with(&format!("{text} is out of range")), "{error}");
    }
}

#[test]
fn a_mesh_of_degenerate_faces_is_refused() {
    let mut mesh = samples::sphere(100);
    mesh.faces = vec![[mesh.faces[0][0]; 3]];
    let scene = Scene::from_mesh("none", mesh);
    let error = strip(scene, &StripRequest::default(), &()).unwrap_err();
    assert!(matches!(error, JobError::Input(_)), "{error}");
}

/// A scene that shows two meshes many times, turned, scaled and mirrored.
fn flock() -> Scene {
    let mut scene = knot();
    scene.meshes.push(Scene::from_mesh("torus", samples::torus(400)).meshes[0].clone());
    let nodes = (0..18u8).map(|i| {
        let [scale, x] = [f64::from(1 + i % 3), 30.0 * f64::from(i)];
        let side = if i % 2 == 0 { scale } else { -scale };
        let transform = [
            [0.0, scale, 0.0, 0.0],
            [side, 0.0, 0.0, 0.0],
            [0.0, 0.0, scale, 0.0],
            [x, 0.0, 0.0, 1.0],
        ];
        let mesh = Some(usize::from(i % 6 == 5));
        meshlod_io::Node { mesh, transform, ..meshlod_io::Node::default() }
    });
    scene.nodes = nodes.collect();
    scene.roots = (0..18).collect();
    scene
}

#[test]
fn copies_are_stripped_once_and_counted_as_they_are_shown() {
    let merged = Scene::from_mesh("", flock().flatten());
    let request = StripRequest { verify: true, ..StripRequest::default() };
    let [own, all] = [flock(), merged].map(|scene| strip(scene, &request, &()).unwrap().1);
    assert!(own.each_mesh_once && !all.each_mesh_once);
    assert_eq!((own.input_faces, own.verified), (all.input_faces, Some(true)));
    let [own, all] = [&own.levels[0], &all.levels[0]];
    assert_eq!((own.triangles, own.reached), (all.triangles, true));
    let [sent, expected] = [own, all].map(|level| level.vertices_sent as f64);
    assert!((sent / expected - 1.0).abs() < 0.01, "{sent} {expected}");
    assert!((own.acmr16 / all.acmr16 - 1.0).abs() < 0.05, "{} {}", own.acmr16, all.acmr16);
}

#[test]
fn copies_of_a_mesh_without_faces_stay_beside_those_that_are_stripped() {
    for at in [0, 1, 2] {
        let mut scene = flock();
        let mut wire = scene.meshes[0].clone();
        wire.mesh.faces.clear();
        scene.meshes.insert(at, wire);
        for node in &mut scene.nodes {
            node.mesh = node.mesh.map(|mesh| mesh + usize::from(mesh >= at));
        }
        for i in 18..60 {
            scene.nodes.push(meshlod_io::Node { mesh: Some(at), ..scene.nodes[i % 18].clone() });
            scene.roots.push(i);
        }
        let levels = vec![Target::Ratio(1.0), Target::Ratio(0.5)];
        let request = StripRequest { levels, ..StripRequest::default() };
        let (stripped, report) = strip(scene, &request, &()).unwrap();
        let expected = strip(flock(), &request, &()).unwrap().1;
        let triangles = |report: &StripReport| -> Vec<usize> {
            report.levels.iter().map(|level| level.triangles).collect()
        };
        assert!(report.each_mesh_once);
        assert_eq!(triangles(&report), triangles(&expected));
        let strips = stripped.strip_meshes();
        let glb = meshlod_io::gltf::write_strips_glb(&stripped.scene, &strips).unwrap();
        let options = meshlod_io::ReadOptions::default();
        let back = meshlod_io::read_bytes(&glb, meshlod_io::Format::Glb, &mut |_| None, &options);
        // A new glTF has a degenerate triangle where a mesh has no faces.
        assert_eq!(shown_faces(&back.unwrap()), report.input_faces + 42, "{at}");
    }
}

#[test]
fn levels_of_copies_show_no_more_than_was_asked_for() {
    let levels = vec![Target::Ratio(0.5), Target::Faces(3_000), Target::Faces(1)];
    let request = StripRequest { levels, verify: true, ..StripRequest::default() };
    let (stripped, report) = strip(flock(), &request, &()).unwrap();
    assert_eq!(report.verified, Some(true));
    let [half, some, one] = &report.levels[..] else { panic!() };
    assert!(half.reached && half.triangles > report.input_faces * 2 / 5, "{half:?}");
    assert!(some.reached && some.triangles > 2_000, "{some:?}");
    assert!(!one.reached, "a knot cannot vanish");
    let strips = stripped.strip_meshes();
    assert_eq!(strips.len(), 2, "one for each mesh");
    let glb = meshlod_io::gltf::write_strips_glb(&stripped.scene, &strips).unwrap();
    let options = meshlod_io::ReadOptions::default();
    let back = meshlod_io::read_bytes(&glb, meshlod_io::Format::Glb, &mut |_| None, &options);
    let back = back.unwrap();
    let instances = back.instances();
    assert_eq!((instances.len(), shown_faces(&back)), (18, half.triangles));
    let volumes = [&back, &flock()].map(|scene| crate::scene::shown_sizes(scene).volume);
    assert!((volumes[0] / volumes[1] - 1.0).abs() < 0.1, "{volumes:?}");
}
