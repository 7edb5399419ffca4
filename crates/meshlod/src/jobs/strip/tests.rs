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
