use std::sync::Mutex;

use meshlod_fixtures::folding_strip;
use meshlod_io::Weld;
use meshlod_mesh::{Connectivity, VertexId};
use meshlod_multires::{ModelFile, Query};
use meshlod_samples as samples;

use super::*;
use crate::jobs::{About, ExtractRequest, Remark, extract};
use crate::model::verified::extract_verified;

fn built(mesh: Mesh, request: &BuildRequest) -> (ModelFile<Vec<u8>>, BuildReport) {
    let (bytes, report) = build(Scene::from_mesh("", mesh), request, &()).unwrap();
    assert_eq!(report.bytes, bytes.len());
    (ModelFile::open(bytes).unwrap(), report)
}

fn finest(file: &ModelFile<Vec<u8>>) -> Mesh {
    extract(file, &ExtractRequest::default(), &()).unwrap().0.into_mesh()
}

fn coarsest(file: &ModelFile<Vec<u8>>) -> Mesh {
    file.extract_at_most(0, &Query::finest()).unwrap().level.mesh()
}

/// Returns the bits of all positions, in a fixed order.
fn bits(positions: impl Iterator<Item = [f64; 3]>) -> Vec<[u64; 3]> {
    let mut bits: Vec<_> = positions.map(|p| p.map(f64::to_bits)).collect();
    bits.sort_unstable();
    bits
}

/// Watch that keeps what it hears.
#[derive(Default)]
struct Heard {
    stages: Mutex<Vec<String>>,
    remarks: Mutex<Vec<Remark>>,
}

impl Watch for Heard {
    fn stage(&self, stage: &str) {
        self.stages.lock().unwrap().push(stage.into());
    }

    fn remark(&self, remark: &Remark) {
        self.remarks.lock().unwrap().push(remark.clone());
    }
}

/// Watch that has cancelled from the start.
struct Cancelled;

impl Watch for Cancelled {
    fn is_cancelled(&self) -> bool {
        true
    }
}

#[test]
fn a_lossless_file_restores_the_mesh() {
    let mesh = samples::knot(1_000);
    let request = BuildRequest { lossless: true, ..Default::default() };
    let (file, report) = built(mesh.clone(), &request);
    assert!(report.rounding == 0.0 && report.moved > 0.0);
    let level = finest(&file);
    assert_eq!(level.faces.len(), mesh.faces.len());
    assert_eq!(bits(level.positions.into_iter()), bits(mesh.positions.into_iter()));
}

#[test]
fn constraints_hold_in_every_level() {
    let mesh = samples::terrain(600);
    let constraints = Constraints { lock_boundary: true, ..Constraints::default() };
    let held = BuildRequest { lossless: true, constraints, ..Default::default() };
    let free = BuildRequest { lossless: true, ..Default::default() };
    let boundary = |mesh: &Mesh| {
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let on = |v: &usize| connectivity.marks(VertexId::new(*v)).boundary();
        bits((0..mesh.positions.len()).filter(on).map(|v| mesh.positions[v]))
    };
    let of_coarsest = |request| boundary(&coarsest(&built(mesh.clone(), request).0));
    assert_eq!(of_coarsest(&held), boundary(&mesh));
    assert!(of_coarsest(&free).len() < boundary(&mesh).len());
}

#[test]
fn a_height_field_keeps_its_heights() {
    let request = BuildRequest {
        model: LevelModel::RightTriangles,
        rounding: Bound::Length(0.0),
        ..Default::default()
    };
    let (file, report) = built(samples::terrain(600), &request);
    let BuiltLevels::RightTriangles { fit, .. } = report.levels else { panic!("{report:?}") };
    assert_eq!((report.rounding, fit.rounded), (0.0, 0.0));
    assert_eq!(finest(&file).faces.len(), report.faces);
}

#[test]
fn right_triangles_refuse_what_they_cannot_keep() {
    let model = LevelModel::RightTriangles;
    let constraints = Constraints { lock_boundary: true, ..Constraints::default() };
    let plain = BuildRequest { model, ..Default::default() };
    for (field, request) in [
        ("exact_volume", BuildRequest { exact_volume: true, ..plain.clone() }),
        ("lossless", BuildRequest { lossless: true, ..plain.clone() }),
        ("order", BuildRequest { order: LevelOrder::Error, ..plain.clone() }),
        ("lock_boundary", BuildRequest { constraints, ..plain.clone() }),
    ] {
        let scene = Scene::from_mesh("", samples::terrain(100));
        let refused = build(scene, &request, &()).unwrap_err();
        assert!(matches!(refused, JobError::Request { field: at, .. } if at == field));
    }
    assert!(plain.validate().is_ok());
}

#[test]
fn errors_are_measured_in_the_poses_of_animations() {
    let heard = Heard::default();
    let glb = folding_strip(40);
    let scene = meshlod_io::gltf::read(&glb, &mut |_| None, Weld::Exact).unwrap();
    let (bytes, report) = build(scene, &BuildRequest::default(), &heard).unwrap();
    let poses = report.error_poses.measured().expect("it folds");
    assert!(poses.measured > 0 && poses.animations == 1);
    assert!(report.scene.is_some_and(|scene| scene.animations == 1) && report.scene_bytes > 0);
    let file = ModelFile::open(bytes).unwrap();
    let (scene, found) = extract(&file, &ExtractRequest::default(), &()).unwrap();
    assert!(scene.source.is_some() && found.error.poses.is_some_and(|known| known.poses == poses));
    assert_eq!(
        *heard.stages.lock().unwrap(),
        ["contracting", "measuring errors", "proving and packing", "packing images"]
    );
}

#[test]
fn an_open_mesh_has_no_volume_to_keep() {
    let heard = Heard::default();
    let request = BuildRequest { exact_volume: true, ..Default::default() };
    build(Scene::from_mesh("", samples::terrain(100)), &request, &heard).unwrap();
    let remarks = heard.remarks.into_inner().unwrap();
    assert!(matches!(&remarks[..], [Remark { about: About::Field("exact_volume"), .. }]));
}

#[test]
fn a_job_that_cannot_be_done_says_why() {
    let empty = build(Scene::from_mesh("", Mesh::default()), &BuildRequest::default(), &());
    assert!(matches!(empty, Err(JobError::Input(_))));
    let scene = Scene::from_mesh("", samples::torus(300));
    let rounding = Bound::OfDiagonal(2.0);
    let rounded = build(scene.clone(), &BuildRequest { rounding, ..Default::default() }, &());
    assert!(matches!(rounded, Err(JobError::Input(_))));
    let cancelled = build(scene, &BuildRequest::default(), &Cancelled);
    assert!(matches!(cancelled, Err(JobError::Cancelled)));
}

#[test]
fn levels_in_the_order_of_errors_have_fewer_faces_within_one() {
    let mesh = samples::gyroid(6000);
    let tolerance = 3e-3 * mesh.bounds().diagonal();
    let faces = [LevelOrder::Cost, LevelOrder::Error].map(|order| {
        let request = BuildRequest { order, ..Default::default() };
        let (bytes, _) = build(Scene::from_mesh("", mesh.clone()), &request, &()).unwrap();
        let file = ModelFile::open(bytes).unwrap();
        let found = extract_verified(&file, &Query::uniform(tolerance)).unwrap();
        assert!(found.verification.holds, "{order:?}");
        found.extract.level.mesh().faces.len()
    });
    assert!(10 * faces[1] < 9 * faces[0], "{faces:?}");
}

#[test]
fn a_card_seen_from_both_sides_passes_its_own_check() {
    // Its sides are cut along different diagonals, turned the same way at two edges, and have uvs of
    // their own.
    let places = [[0.0, 0.0, 0.1], [1.0, 0.0, 0.0], [1.0, 1.0, 0.1], [0.0, 1.0, 0.0]];
    let faces = [[0, 3, 2], [0, 1, 3], [2, 0, 1], [1, 2, 3]];
    let corner = |k: usize| faces[k / 3][k % 3];
    let obj = places.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat()
        + &(0..12).map(|k| format!("vt .{} .{}\n", 10 + k, 10 + k % 5)).collect::<String>()
        + &(0..12)
            .map(|k| {
                let start = if k % 3 == 0 { "\nf" } else { "" };
                format!("{start} {}/{}", corner(k) + 1, k + 1)
            })
            .collect::<String>();
    let scene = meshlod_io::obj::read(obj.as_bytes(), &mut |_| None).unwrap();
    let (bytes, report) = build(scene, &BuildRequest::default(), &()).unwrap();
    let file = ModelFile::open(bytes).unwrap();
    assert_eq!((report.faces, finest(&file).faces.len()), (4, 4));
}
