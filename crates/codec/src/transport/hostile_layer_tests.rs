//! Attributes that cannot be stored, and damaged files.

use meshlod_fixtures::{grid, hourglass, seam_strip};
use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, WedgeId};
use meshlod_samples as samples;

use super::layer_tests::{assert_same, attributes, labels, torn};
use super::tests::{Numbers, decode_all, options, seal, soup};
use super::*;

#[test]
fn bad_attributes_are_refused_in_words() {
    let refused = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = seam_strip();
        change(&mut mesh);
        Transport::encode(&mesh, &options(256)).unwrap_err()
    };
    let layer = |mesh: &'_ mut Mesh| mesh.attributes.as_mut().unwrap().layers.remove(0);
    let with = |mesh: &mut Mesh, layer: Layer| mesh.attributes.as_mut().unwrap().layers.push(layer);
    let error = refused(&|mesh| {
        let mut changed = layer(mesh);
        *changed.values.last_mut().unwrap() = f32::INFINITY;
        with(mesh, changed);
    });
    assert!(matches!(error, TransportError::NotFiniteValue { .. }), "{error}");
    let error = refused(&|mesh| {
        let changed = Layer { name: "x".repeat(70_000), ..layer(mesh) };
        with(mesh, changed);
    });
    assert!(matches!(error, TransportError::Layer(_)));
    let error = refused(&|mesh| {
        let count = mesh.attributes.as_ref().unwrap().wedge_count;
        let values = vec![0.0; 1024 * count];
        with(mesh, Layer { kind: LayerKind::Other, name: "wide".into(), width: 1024, values });
    });
    assert!(matches!(error, TransportError::Layer(_)));
    let error = refused(&|mesh| {
        mesh.materials = Some(Labels { names: Vec::new(), of_face: vec![0; mesh.faces.len()] });
    });
    assert!(matches!(error, TransportError::Mesh(_)));
    let error = refused(&|mesh| mesh.attributes.as_mut().unwrap().wedge_count = 1);
    assert!(matches!(error, TransportError::Mesh(_)));
}

#[test]
fn a_flipped_bit_in_attributes_is_detected() {
    let mut mesh = samples::knot(600);
    mesh.attributes = Some(attributes(&mesh, torn(&mesh, 2, 5), None));
    mesh.materials = Some(labels(mesh.faces.len(), 3, 2));
    let bytes = Transport::encode(&mesh, &options(256)).unwrap().bytes;
    for at in (0..bytes.len()).step_by(11) {
        let mut bytes = bytes.clone();
        bytes[at] ^= 1 << (at % 8);
        assert!(decode_all(&bytes).is_err(), "byte {at}");
    }
    for len in (0..bytes.len()).step_by(53) {
        assert!(TransportFile::open(&bytes[..len]).is_err());
    }
}

#[test]
fn any_bytes_of_attributes_are_survived() {
    let bases = [samples::sphere(700), soup(60, 300, 5), hourglass(), grid(9)];
    let mut numbers = Numbers(1);
    let mut read = 0;
    for base in bases {
        let mut mesh = base.clone();
        mesh.attributes = Some(attributes(&base, torn(&base, 3, 8), Some(2)));
        mesh.objects = Some(labels(mesh.faces.len(), 4, 2));
        let bytes = Transport::encode_with_resources(&mesh, b"some", &options(100)).unwrap().bytes;
        for _ in 0..700 {
            let mut bytes = bytes.clone();
            for _ in 0..1 + numbers.next(4) {
                // Most of the layers' names and tables are in the first quarter.
                let below = [bytes.len(), 2000][numbers.next(2)];
                let at = numbers.next(below);
                let at = at % bytes.len();
                bytes[at] = [0, 255, bytes[at] ^ 1, numbers.next(256) as u8][numbers.next(4)];
            }
            if numbers.next(6) == 0 {
                bytes.truncate(numbers.next(bytes.len()));
            }
            seal(&mut bytes);
            read += usize::from(decode_all(&bytes).is_ok());
        }
    }
    assert!(read > 5, "{read}");
}

#[test]
fn few_bytes_cannot_claim_many_values() {
    // Constant values take no bits, but a block still has a byte for every 256 of them.
    let mut mesh = grid(30);
    let corners = (0..mesh.faces.len()).map(|f| [0, 1, 2].map(|k| WedgeId::new(3 * f + k)));
    let corners: Vec<_> = corners.collect();
    let count = 3 * corners.len();
    let tell_apart =
        (0..count).flat_map(|w| (0..255).map(move |k| if k == 0 { w as f32 } else { 0.0 }));
    let values = tell_apart.collect();
    let layer = Layer { kind: LayerKind::Other, name: "flat".into(), width: 255, values };
    mesh.attributes = Some(Attributes { corners, wedge_count: count, layers: vec![layer] });
    assert_same(&mesh, &options(256));
    let bytes = Transport::encode(&mesh, &options(256)).unwrap().bytes;
    assert!(bytes.len() >= count * 255 / 256);
}
