use meshlod_io::Format;
use meshlod_mesh::Mesh;
use meshlod_multires::{Focus, ViewCamera};
use meshlod_samples as samples;

use super::*;
use crate::Bound;
use crate::jobs::{BuildRequest, build};

fn bytes(mesh: &Mesh, lossless: bool) -> Vec<u8> {
    let request = BuildRequest { lossless, ..Default::default() };
    build(Scene::from_mesh("", mesh.clone()), &request, &()).unwrap().0
}

fn file(mesh: &Mesh, lossless: bool) -> ModelFile<Vec<u8>> {
    ModelFile::open(bytes(mesh, lossless)).unwrap()
}

fn within(error: f64) -> QueryRequest {
    let target = QueryTarget::Error(ErrorLimit::Length(Bound::Length(error)));
    QueryRequest { target, ..QueryRequest::default() }
}

fn at_most(faces: usize) -> QueryRequest {
    QueryRequest { target: QueryTarget::Faces(faces), ..QueryRequest::default() }
}

fn asking(query: QueryRequest) -> ExtractRequest {
    ExtractRequest { query, ..ExtractRequest::default() }
}

fn ball(center: [f64; 3], radius: f64) -> FocusRequest {
    FocusRequest::Region(Focus::Sphere { center, radius })
}

fn report(file: &ModelFile<Vec<u8>>, request: &ExtractRequest) -> ExtractReport {
    extract(file, request, &()).unwrap().1
}

#[test]
fn a_report_says_what_a_mesh_lacks() {
    let mesh = samples::knot(4_000);
    let all = bytes(&mesh, false);
    let whole = ModelFile::open(all.clone()).unwrap();
    let kept = report(&whole, &asking(within(0.02)));
    assert!(kept.reached && kept.meets_focus && kept.error.is_kept() == Some(true));
    assert_eq!((kept.chunks, kept.error.proved()), (kept.chunks_there, Some(0.02)));
    let below = report(&whole, &asking(within(1e-12)));
    assert!(!below.reached && below.error.below_rounding().is_some_and(|least| least > 1e-12));
    let few = report(&whole, &asking(at_most(1)));
    assert!(few.level_faces > 1 && !few.reached && few.error.asked == AskedError::Faces);
    let far = QueryRequest { focus: ball([9.0; 3], 0.1), ..within(0.0) };
    assert!(!report(&whole, &asking(far.clone())).meets_focus);
    let nothing = report(&whole, &ExtractRequest { crop: true, ..asking(far) });
    assert_eq!((nothing.faces, nothing.shown_faces), (0, 0));
    let half = ModelFile::open(all[..all.len() / 2].to_vec()).unwrap();
    let half = report(&half, &ExtractRequest::default());
    assert!(half.chunks_there < half.chunks && half.level_faces < mesh.faces.len());
    assert_eq!(half.error.proved(), None);
}

#[test]
fn a_focus_is_fine_and_the_rest_is_coarse_or_cropped() {
    let file = file(&samples::sphere(500), false);
    assert!(report(&file, &asking(at_most(100))).faces <= 100);
    let near = QueryRequest { focus: ball([0.0, 1.0, 0.0], 0.3), ..within(0.0) };
    let whole = asking(near);
    let cropped = ExtractRequest { crop: true, ..whole.clone() };
    assert!(report(&file, &cropped).faces < report(&file, &whole).faces);
    let on_top = FocusRequest::Region(Focus::Point([0.0, 2.0, 0.0]));
    let nearest = asking(QueryRequest { focus: on_top, ..at_most(100) });
    let nearest = report(&file, &ExtractRequest { crop: true, ..nearest });
    assert!((1..10).contains(&nearest.faces) && nearest.meets_focus);
}

#[test]
fn a_cut_has_the_volume_of_the_mesh() {
    let mesh = samples::knot(4_000);
    let file = file(&mesh, true);
    let off = |request: &ExtractRequest| {
        let cut = extract(&file, request, &()).unwrap().0.into_mesh();
        (meshlod_measure::volume(&cut) / meshlod_measure::volume(&mesh) - 1.0).abs()
    };
    let near = QueryRequest { focus: ball([0.9, 0.0, 0.0], 0.2), ..within(0.001) };
    for query in [near, within(0.02)] {
        let cut = asking(query);
        assert!(off(&cut) > 1e-9, "{:e}", off(&cut));
        let exact = ExtractRequest { exact_volume: true, ..cut };
        assert!(off(&exact) < 1e-14, "{:e}", off(&exact));
    }
    let cropped = ExtractRequest { crop: true, exact_volume: true, ..asking(within(0.02)) };
    let refused = extract(&file, &cropped, &()).unwrap_err();
    assert!(matches!(refused, JobError::Request { field: "exact_volume", .. }));
}

#[test]
fn a_precision_is_chosen_so_that_the_error_holds_as_written() {
    let mut mesh = samples::torus(4_000);
    mesh.positions.iter_mut().for_each(|at| at[0] += 1e4);
    let file = file(&mesh, true);
    let written = |given| ExtractRequest {
        written_as: Some(WrittenAs { format: Format::Ply, precision: given }),
        ..asking(within(1e-2))
    };
    let chosen = report(&file, &written(Precision::Auto));
    assert_eq!((chosen.precision, chosen.rounded), (Some(Precision::F64), None));
    assert!(chosen.reached && chosen.error.moved == 0.0);
    let forced = report(&file, &written(Precision::F32));
    assert!(forced.rounded.is_some_and(|moved| moved > 1e-5) && forced.error.moved > 0.0);
    assert!(!forced.reached && forced.error.proved().is_some_and(|proved| proved > 1e-2));
}

#[test]
fn a_query_without_what_it_needs_is_refused() {
    let file = file(&samples::torus(500), false);
    let pixels = QueryTarget::Error(ErrorLimit::Pixels(1.0));
    let frustum = QueryRequest { focus: FocusRequest::Frustum, ..QueryRequest::default() };
    let up = Some(7);
    for (field, query) in [
        ("error", QueryRequest { target: pixels, ..QueryRequest::default() }),
        ("focus", frustum),
        ("up", QueryRequest { up, ..QueryRequest::default() }),
        ("", within(f64::NAN)),
    ] {
        let refused = extract(&file, &asking(query), &()).unwrap_err();
        assert!(matches!(refused, JobError::Request { field: at, .. } if at == field), "{field}");
    }
}

#[test]
fn a_camera_decides_where_faces_are() {
    let file = file(&samples::torus(4_000), false);
    let (eye, look, up) = ([0.0, 0.0, 30.0], [0.0; 3], [0.0, 1.0, 0.0]);
    let camera = Some(ViewCamera { eye, look, up, fov_rad: 0.8, viewport: [640, 480] });
    let target = QueryTarget::Error(ErrorLimit::Pixels(1.0));
    let seen = report(&file, &asking(QueryRequest { target, camera, ..QueryRequest::default() }));
    assert!(seen.faces < 2_000 && seen.error.proved_px() == Some(1.0));
}
