//! An error is kept as it is written: files are read back and compared with the input.

use meshlod::io::Precision;
use meshlod::jobs::{Aim, SimplifyReport, SimplifyRequest, WrittenAs, simplify};
use meshlod::measure::{CertifiedOptions, certified_distance};
use meshlod::mesh::Mesh;
use meshlod::{Bound, Format, Output, ReadOptions, Scene, WriteOptions, read, samples};

const FORMATS: [(Format, Precision, &str); 5] = [
    (Format::Ply, Precision::F32, "ply"),
    (Format::Ply, Precision::Auto, "ply"),
    (Format::Obj, Precision::Auto, "obj"),
    (Format::Stl, Precision::Auto, "stl"),
    (Format::Glb, Precision::Auto, "glb"),
];

/// Simplifies a mesh to a part of its diagonal, writes it, and returns the report with the greatest
/// distance of what is read back that is certain.
fn written(
    mesh: &Mesh,
    part: f64,
    (format, precision, suffix): (Format, Precision, &str),
) -> (SimplifyReport, f64) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("level").with_extension(suffix);
    let request = SimplifyRequest {
        target: Aim::Error(Bound::OfDiagonal(part)),
        written_as: Some(WrittenAs { format, precision }),
        ..SimplifyRequest::default()
    };
    let scene = Scene::from_mesh("level", mesh.clone());
    let (level, report) = simplify(scene, &request, &()).unwrap();
    let precision = report.written_as.unwrap().precision;
    Output::new(&path).unwrap().write(&level, &WriteOptions { precision }).unwrap();
    let back = read(&path, &ReadOptions::default()).unwrap().flatten();
    let found = certified_distance(mesh, &back, &CertifiedOptions::default()).unwrap();
    (report, found.symmetric().lower)
}

#[test]
fn what_is_read_back_is_within_the_error_that_is_proved() {
    let meshes = [
        samples::knot(1_500),
        samples::fish(1_500),
        samples::torus(1_200),
        samples::gyroid(1_500),
        samples::terrain(1_500),
        samples::sphere(1_000),
    ];
    for mesh in &meshes {
        for part in [0.003, 0.001, 0.0003] {
            for form in FORMATS {
                let (report, apart) = written(mesh, part, form);
                let error = report.error.unwrap();
                let proved = error.proved.unwrap();
                assert!(apart <= proved, "{form:?} {part}: {apart} is more than {proved}");
                assert_eq!(error.is_held, proved <= error.asked * (1.0 + 1e-9), "{error:?}");
                assert!(error.is_held && report.run.reached, "{form:?} {part}: {error:?}");
            }
        }
    }
}

/// A torus so far from the origin that 32 bits round it visibly.
fn far_away() -> Mesh {
    let mut mesh = samples::torus(1_000);
    mesh.positions.iter_mut().for_each(|at| at[0] += 1e5);
    mesh
}

#[test]
fn coordinates_take_64_bits_where_32_would_round_the_error_away() {
    let auto = (Format::Ply, Precision::Auto, "ply");
    let (report, apart) = written(&far_away(), 1e-3, auto);
    assert_eq!(report.written_as.unwrap().precision, Precision::F64);
    assert!(report.run.reached && apart <= report.error.unwrap().asked);
}

#[test]
fn a_format_that_rounds_the_error_away_says_what_holds() {
    for form in [(Format::Stl, Precision::Auto, "stl"), (Format::Ply, Precision::F32, "ply")] {
        let (report, apart) = written(&far_away(), 1e-3, form);
        let error = report.error.unwrap();
        assert!(!report.run.reached && !error.is_held && error.is_rounded_away(), "{error:?}");
        assert!(error.proved.unwrap() > error.asked && apart <= error.proved.unwrap());
    }
}

#[test]
fn a_request_is_read_and_written_as_data() {
    #[cfg(feature = "serde")]
    {
        let text = r#"{ "target": { "error": "0.1%" }, "written_as": { "format": "ply", "precision": "f32" } }"#;
        let request: SimplifyRequest = serde_json::from_str(text).unwrap();
        assert_eq!(request.target, Aim::Error(Bound::OfDiagonal(0.001)));
        assert_eq!(request.written_as.unwrap().format, Format::Ply);
        let again = serde_json::to_string(&request).unwrap();
        assert_eq!(serde_json::from_str::<SimplifyRequest>(&again).unwrap(), request);
    }
}
