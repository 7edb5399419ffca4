use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, WedgeId};
use meshlod_samples as samples;

use super::*;
use crate::{Method, Options, Target};

/// Simplifies in steps, and checks that every level is restored exactly: up, down, and by its
/// number of faces.
fn there_and_back(mesh: &Mesh, method: Method) -> Progressive {
    let mut history = History::default();
    let mut simplifier = Simplifier::new(mesh, &Options { method, ..Options::default() }).unwrap();
    let mut levels = vec![simplifier.level()];
    for ratio in [0.8, 0.5, 0.2, 0.05] {
        simplifier.run(Target::Ratio(ratio), &mut history).unwrap();
        levels.push(simplifier.level());
    }
    let mut progressive = Progressive::new(simplifier, history).unwrap();
    assert_eq!(progressive.full_faces(), levels[0].faces.len());
    for level in levels.iter().rev() {
        while progressive.live_faces() < level.faces.len() {
            assert!(progressive.refine());
        }
        assert_eq!(&progressive.level(), level);
    }
    assert!(!progressive.refine());
    for level in &levels {
        while progressive.live_faces() > level.faces.len() {
            assert!(progressive.coarsen());
        }
        assert_eq!(&progressive.level(), level);
    }
    assert!(!progressive.coarsen());
    for i in [1, 3, 0, 4, 2] {
        progressive.go_to(levels[i].faces.len());
        assert_eq!(progressive.level(), levels[i]);
        assert_eq!(progressive.full_faces(), levels[0].faces.len());
    }
    progressive
}

#[test]
fn every_level_comes_back_to_the_bit() {
    for method in Method::ALL {
        there_and_back(&samples::torus(400), method);
        there_and_back(&samples::terrain(400), method);
    }
}

/// Mesh with uvs and normals of its own, two materials and two objects.
fn with_attributes() -> Mesh {
    let mut mesh = samples::fish(500);
    let count = mesh.faces.len() as u32;
    let labels = |part: u32| Labels {
        names: vec!["one".into(), "two".into()],
        of_face: (0..count).map(|f| u32::from(f > part)).collect(),
    };
    mesh.materials = Some(labels(count / 3));
    mesh.objects = Some(labels(count / 2));
    mesh
}

/// Mesh with attributes of which every face has its own wedges, with normals of their own.
fn faceted() -> Mesh {
    let mut mesh = with_attributes();
    let Some(all) = mesh.attributes.take() else { return mesh };
    let corners = || all.corners.iter().flatten();
    let own = |layer: &Layer| {
        let values = corners().flat_map(|&wedge| layer.of(wedge).to_vec()).collect();
        Layer { values, ..layer.clone() }
    };
    let mut layers: Vec<Layer> = all.layers.iter().map(own).collect();
    let normals = layers.iter_mut().find(|layer| layer.kind == LayerKind::Normal).unwrap();
    normals.values = (0..9 * mesh.faces.len()).map(|i| ((i / 9 + i % 3) % 7) as f32).collect();
    let wedge_count = 3 * mesh.faces.len();
    let corners: Vec<_> = (0..wedge_count).map(WedgeId::new).collect();
    let corners = corners.as_chunks::<3>().0.to_vec();
    mesh.attributes = Some(Attributes { corners, wedge_count, layers });
    mesh
}

#[test]
fn attributes_come_back_to_the_bit() {
    for method in Method::ALL {
        there_and_back(&samples::fish(500), method);
        there_and_back(&with_attributes(), method);
        there_and_back(&faceted(), method);
    }
}

#[test]
fn a_history_with_a_gap_is_refused() {
    let mesh = samples::torus(400);
    let mut simplifier = Simplifier::new(&mesh, &Options::default()).unwrap();
    simplifier.run(Target::Ratio(0.5), &mut ()).unwrap();
    assert!(Progressive::new(simplifier, History::default()).is_none());
}

#[test]
fn bytes_and_back_is_the_same() {
    for mesh in [samples::torus(300), samples::terrain(300), with_attributes()] {
        let mut progressive = there_and_back(&mesh, Method::Qem);
        let bytes = progressive.to_bytes();
        let mut again = Progressive::from_bytes(&bytes).unwrap();
        assert_eq!(again.live_faces(), again.full_faces() - progressive.splits.removed_faces.len());
        for faces in [0, 100, 200, 1000] {
            progressive.go_to(faces);
            again.go_to(faces);
            assert_eq!(again, progressive);
        }
        assert_eq!(again.to_bytes(), bytes);
    }
}

#[test]
fn bytes_cut_anywhere_are_refused() {
    let bytes = there_and_back(&with_attributes(), Method::Qem).to_bytes();
    for end in (0..bytes.len()).step_by(397) {
        assert!(Progressive::from_bytes(&bytes[..end]).is_err(), "{end}");
    }
}

/// Corrupts one byte under a matching checksum: reading must fail with an error or yield valid
/// levels.
#[test]
fn a_wrong_byte_never_makes_a_wrong_mesh() {
    let bytes = there_and_back(&with_attributes(), Method::Qem).to_bytes();
    let mut refused = 0;
    for place in (20..bytes.len()).step_by(173) {
        let mut wrong = bytes.clone();
        wrong[place] ^= 0x41;
        assert!(matches!(Progressive::from_bytes(&wrong), Err(ProgressiveError::Checksum)));
        Progressive::seal(&mut wrong);
        match Progressive::from_bytes(&wrong) {
            Err(_) => refused += 1,
            Ok(mut read) => loop {
                read.level().validate().unwrap();
                if (0..20).any(|_| !read.refine()) {
                    break;
                }
            },
        }
    }
    assert!(refused > 30, "{refused}");
}

/// Regression test for a fuzzer finding: 48 bytes that claimed 800 million wedges without a layer.
#[test]
fn wedges_that_the_bytes_cannot_name_are_refused() {
    let mut bytes = b"meshlodp".to_vec();
    bytes.extend_from_slice(&[1, 0, 0, 0]);
    bytes.extend_from_slice(&[0; 16]);
    bytes.extend_from_slice(&0x3000_3F70_u32.to_le_bytes());
    bytes.extend_from_slice(&[0; 16]);
    Progressive::seal(&mut bytes);
    let what = "the wedges";
    assert_eq!(Progressive::from_bytes(&bytes), Err(ProgressiveError::Truncated { at: 36, what }));
}
