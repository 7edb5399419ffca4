//! Compression of scenes into every kind of file.

use meshlod_io::{Format, ReadOptions};
use meshlod_mesh::Mesh;
use meshlod_samples as samples;

use super::*;
use crate::{AnyFile, Bound, FileKind};

fn request(kind: FileKind, target: CompressTarget) -> CompressRequest {
    let packing = Packing::of(kind).unwrap();
    CompressRequest { packing, target, ..CompressRequest::default() }
}

/// Returns the request for an encoding of positions in an `.mlq` file.
fn in_scheme(scheme: PositionScheme) -> CompressRequest {
    let packing =
        Packing::Resident { scheme: Some(scheme), attributes: AttributeBounds::default() };
    CompressRequest { packing, ..CompressRequest::default() }
}

fn on_lattice(target: CompressTarget) -> CompressRequest {
    let packing = Packing::Sent { on_lattice: true, attributes: AttributeBounds::default() };
    CompressRequest { packing, target, ..CompressRequest::default() }
}

fn refused(request: &CompressRequest) -> String {
    let sphere = Scene::from_mesh("sphere", samples::sphere(100));
    match compress(sphere, request, &()).unwrap_err() {
        JobError::Request { field: "", reason } => reason,
        JobError::Request { field, reason } => format!("{field}: {reason}"),
        error => panic!("{error}"),
    }
}

#[test]
fn every_kind_and_target_comes_back() {
    let mesh = samples::fish(1_500);
    let error = CompressTarget::Error(Bound::OfDiagonal(0.001));
    let bits = CompressTarget::default();
    for (kind, request) in [
        (FileKind::Resident, request(FileKind::Resident, bits)),
        (FileKind::Resident, request(FileKind::Resident, error)),
        (FileKind::Resident, request(FileKind::Resident, CompressTarget::Reduction(0.5))),
        (FileKind::Resident, in_scheme(PositionScheme::Lattice)),
        (FileKind::Resident, in_scheme(PositionScheme::Parts { strips: None })),
        (FileKind::Sent, request(FileKind::Sent, bits)),
        (FileKind::Sent, request(FileKind::Sent, error)),
        (FileKind::Sent, on_lattice(error)),
        (FileKind::Mesh(Format::Glb), request(FileKind::Mesh(Format::Glb), bits)),
    ] {
        let fish = Scene::from_mesh("fish", mesh.clone());
        let (bytes, report) = compress(fish, &request, &()).unwrap();
        assert_eq!(report.bytes_total, bytes.len(), "{request:?}");
        assert_eq!((report.reached, report.faces), (true, mesh.faces.len()), "{request:?}");
        let read = ReadOptions::default();
        let file = AnyFile::from_bytes("fish", kind, bytes, &mut |_| None, &read).unwrap();
        let decoded = file.into_scene().unwrap().into_mesh();
        match kind {
            // Its reader joins vertices that the grid has brought together.
            FileKind::Mesh(_) => assert!(100 * decoded.faces.len() >= 99 * mesh.faces.len()),
            _ => {
                assert_eq!(decoded.faces.len(), mesh.faces.len(), "{request:?}");
                assert_eq!(decoded.positions.len(), report.vertices, "{request:?}");
            }
        }
        let layers = |mesh: &Mesh| mesh.attributes.as_ref().map(|of| of.layers.len());
        assert_eq!(layers(&decoded), layers(&mesh), "{request:?}");
    }
}

#[test]
fn what_does_not_go_together_is_refused() {
    let reduction = CompressTarget::Reduction(0.5);
    let glb = FileKind::Mesh(Format::Glb);
    assert!(refused(&request(FileKind::Sent, reduction)).starts_with("--reduction does not go"));
    assert!(refused(&request(glb, reduction)).starts_with("--error and --reduction need"));
    assert!(refused(&request(glb, CompressTarget::Bits(17))).contains("between 1 and 16"));
    assert!(refused(&request(FileKind::Resident, CompressTarget::Bits(25))).contains("bits"));
    let blocks = CompressRequest { lock_contacts: true, ..in_scheme(PositionScheme::Blocks) };
    assert!(refused(&blocks).starts_with("--lock-contacts needs one grid"));
    let packing = Packing::Gltf(GltfPacking::Scene {
        normal_error: None,
        uv_error: None,
        animation_error: Some(100.0),
        resident: false,
    });
    let turned = CompressRequest { packing, ..CompressRequest::default() };
    assert!(refused(&turned).starts_with("--animation-error must be"));
    assert_eq!([FileKind::Levels, FileKind::Mesh(Format::Ply)].map(Packing::of), [None, None]);
}

#[test]
fn what_the_file_lacks_is_noted() {
    let mut mesh = samples::sphere(100);
    mesh.positions.push([0.0; 3]);
    mesh.faces.push(mesh.faces[0]);
    for kind in [FileKind::Resident, FileKind::Sent] {
        let request = request(kind, CompressTarget::default());
        let scene = Scene::from_mesh("sphere", mesh.clone());
        let (_, report) = compress(scene, &request, &()).unwrap();
        let noted = |what: &str| report.notes.iter().any(|note| note.what == what);
        assert!(noted("unused vertex"), "{kind:?}: {:?}", report.notes);
        assert_eq!(
            report.faces + 1,
            mesh.faces.len() + usize::from(!noted("degenerate or duplicate face"))
        );
    }
}
