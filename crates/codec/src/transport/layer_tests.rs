//! Attributes, materials and objects in `.mlz` files.

use meshlod_fixtures::{cube, fan, grid, hourglass, mesh, moebius, seam_strip, two_objects};
use meshlod_mesh::{AttributeBounds, Attributes, Labels, Layer, LayerKind, Mesh, WedgeId};
use meshlod_samples as samples;

use super::tests::{Numbers, options, soup};
use super::*;

const KINDS: [(LayerKind, usize); 11] = [
    (LayerKind::Tangent, 4),
    (LayerKind::Normal, 3),
    (LayerKind::Uv(0), 2),
    (LayerKind::Uv(3), 2),
    (LayerKind::Color(0), 3),
    (LayerKind::Color(1), 4),
    (LayerKind::Joints(0), 4),
    (LayerKind::Weights(0), 4),
    (LayerKind::Other, 1),
    (LayerKind::Other, 7),
    (LayerKind::Normal, 3),
];

/// Returns attributes of all kinds for these wedges at vertices: smooth, or all different.
pub(super) fn attributes(mesh: &Mesh, corners: Vec<[WedgeId; 3]>, seed: Option<u64>) -> Attributes {
    let count = corners.iter().flatten().max().map_or(0, |w| w.index() + 1);
    let mut at = vec![[0.0; 3]; count];
    for (face, corners) in mesh.faces.iter().zip(&corners) {
        (0..3).for_each(|k| at[corners[k].index()] = mesh.positions[face[k].index()]);
    }
    let size = mesh.bounds().diagonal().max(1e-30);
    let mut numbers = Numbers(seed.unwrap_or(0));
    let mut value = |p: &[f64; 3], k: usize| match seed {
        Some(_) => numbers.next(1000) as f64 / 1000.0 - 0.4,
        None => (p[k % 3] / size * (1.0 + k as f64)).sin(),
    };
    let layer = |(kind, width): (LayerKind, usize)| {
        let mut values = Vec::new();
        for p in &at {
            values.extend((0..width).map(|k| match kind {
                LayerKind::Joints(_) => (value(p, k) * 60.0).abs().round() as f32,
                LayerKind::Tangent if k == 3 => {
                    if value(p, k) < 0.0 {
                        -1.0
                    } else {
                        1.0
                    }
                }
                LayerKind::Uv(_) => 3.0 * value(p, k) as f32,
                _ => value(p, k) as f32,
            }));
        }
        Layer { kind, name: format!("{kind:?} {width}"), width, values }
    };
    let layers = KINDS.map(layer).into();
    Attributes { corners, wedge_count: count, layers }
}

/// Returns a wedge for each vertex.
fn smooth(mesh: &Mesh) -> Vec<[WedgeId; 3]> {
    mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect()
}

/// Gives each vertex up to `most` wedges, chosen at random by the corner.
pub(super) fn torn(mesh: &Mesh, most: usize, seed: u64) -> Vec<[WedgeId; 3]> {
    let mut numbers = Numbers(seed);
    let wedge = |v: meshlod_mesh::VertexId| WedgeId::new(v.index() * most + numbers.next(most));
    let corners: Vec<u32> = mesh.faces.iter().flatten().copied().map(wedge).map(|w| w.0).collect();
    corners.as_chunks().0.iter().map(|&face: &[u32; 3]| face.map(WedgeId)).collect()
}

pub(super) fn labels(faces: usize, count: usize, seed: u64) -> Labels {
    let mut numbers = Numbers(seed);
    let names = (0..count).map(|k| format!("label {k}")).collect();
    let mut label = 0;
    let mut of_face = Vec::new();
    for _ in 0..faces {
        label = if numbers.next(6) == 0 { numbers.next(count) as u32 } else { label };
        of_face.push(label);
    }
    Labels { names, of_face }
}

/// Checks that attributes are within their bounds, wedges shared by the same corners, and labels
/// the same. Returns the largest error of each layer relative to its bound.
pub(super) fn assert_same(mesh: &Mesh, options: &TransportOptions) -> Vec<f64> {
    mesh.validate().unwrap();
    let encoded = Transport::encode(mesh, options).unwrap();
    let file = TransportFile::open(&encoded.bytes).unwrap();
    let decoded = file.decode().unwrap();
    decoded.validate().unwrap();
    let (_, cells) = grid::QuantizationGrid::of(mesh, options.quantization).unwrap();
    let walks = write::walks(&mesh.faces, &cells, options.block_faces);
    let sides: Vec<_> = walks.iter().flat_map(|walk| &walk.sides).copied().collect();
    assert_eq!(sides.len(), decoded.faces.len());
    for (was, is) in [(&mesh.materials, &decoded.materials), (&mesh.objects, &decoded.objects)] {
        assert_eq!(was.as_ref().map(|of| &of.names), is.as_ref().map(|of| &of.names));
        let (Some(was), Some(is)) = (was, is) else { continue };
        let expected: Vec<_> = sides.iter().map(|side| was.of(side.face().index())).collect();
        assert_eq!(expected, is.of_face);
    }
    assert_eq!(decoded.attributes.is_some(), mesh.attributes.is_some());
    let (Some(was), Some(is)) = (&mesh.attributes, &decoded.attributes) else { return Vec::new() };
    assert_eq!(was.layers.len(), is.layers.len());
    let mut wedge_of = vec![None; was.wedge_count];
    for (side, corners) in sides.iter().zip(&is.corners) {
        for (k, &wedge) in corners.iter().enumerate() {
            let corner = was.corners[side.face().index()][(side.corner() + k) % 3];
            // What shared a wedge still does.
            assert_eq!(*wedge_of[corner.index()].get_or_insert(wedge), wedge);
        }
    }
    let used = was.corners.iter().flatten().copied();
    let layers = was.layers.iter().zip(&is.layers).zip(&encoded.layers);
    let errors = layers.map(|((was, is), report)| {
        assert_eq!((was.kind, &was.name, was.width), (is.kind, &is.name, is.width));
        let bound = options.attributes.of(was, used.clone());
        let coding = crate::attributes::LayerCoding::new(was, &[], &options.attributes);
        let error = |(wedge, &is_wedge): (usize, &Option<WedgeId>)| {
            let is_wedge = is_wedge?;
            Some(coding.error(was.of(WedgeId::new(wedge)), is.of(is_wedge)))
        };
        let error = wedge_of.iter().enumerate().filter_map(error).fold(0.0, f64::max);
        assert!(error <= bound * 1.000_001, "{}: {error} of {bound}", was.name);
        assert_eq!(error, report.max_error, "{}", was.name);
        error / bound.max(1e-30)
    });
    errors.collect()
}

#[test]
fn all_layers_and_labels_of_samples_come_back() {
    for name in ["sphere", "knot", "terrain"] {
        let mut mesh = samples::by_name(name, Some(3000)).unwrap();
        mesh.attributes = Some(attributes(&mesh, smooth(&mesh), None));
        mesh.materials = Some(labels(mesh.faces.len(), 5, 1));
        mesh.objects = Some(labels(mesh.faces.len(), 1, 1));
        let fine = AttributeBounds {
            direction_rad: 0.0002,
            uv: 1e-5,
            color: 1e-4,
            weight: 1e-4,
            other: 1e-5,
        };
        let all =
            [options(16), options(256), TransportOptions { attributes: fine, ..options(256) }];
        for options in all {
            let errors = assert_same(&mesh, &options);
            // Not finer than asked for, but for whole numbers.
            let joints = KINDS.iter().position(|(kind, _)| matches!(kind, LayerKind::Joints(_)));
            for (at, error) in errors.iter().enumerate() {
                assert!(Some(at) == joints || *error > 0.1, "{:?}: {error}", KINDS[at]);
            }
        }
    }
}

#[test]
fn wedges_come_back_in_soups_and_on_single_faces() {
    let fixtures = [cube(), grid(5), seam_strip(), two_objects(), fan(), hourglass(), moebius(9)];
    let single = mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    let double = mesh(&[[0.0; 3]; 3], &[[0, 1, 2], [0, 1, 1], [2, 1, 0], [0, 0, 0]]);
    let soups = (0..6).map(|seed| soup(60, 700, seed));
    for base in fixtures.into_iter().chain([single, double]).chain(soups) {
        for (most, seed) in [(1, 1), (2, 2), (5, 3), (40, 4)] {
            let mut mesh = base.clone();
            mesh.attributes = Some(attributes(&base, torn(&base, most, seed), Some(seed)));
            mesh.materials = Some(labels(mesh.faces.len(), most, seed));
            mesh.objects = Some(labels(mesh.faces.len(), 300, seed));
            assert_same(&mesh, &options(16));
            assert_same(&mesh, &options(256));
        }
    }
}

/// A torus with a seam along one of its circles, across which only some layers differ.
fn seamed_torus() -> Mesh {
    let mut mesh = samples::torus(4000);
    let count = mesh.positions.len();
    let is_left =
        |face: &[VertexId; 3]| face.iter().map(|v| mesh.positions[v.index()][0]).sum::<f64>() < 0.0;
    let corners = mesh.faces.iter().map(|face| {
        let by = if is_left(face) { count } else { 0 };
        face.map(|v| WedgeId::new(v.index() + by))
    });
    let corners: Vec<_> = corners.collect();
    let uv = |p: &[f64; 3]| [p[1] as f32, p[2] as f32];
    let mut values: Vec<f32> = mesh.positions.iter().flat_map(uv).collect();
    values.extend(mesh.positions.iter().flat_map(|p| uv(p).map(|x| x + 5.0)));
    let normals = mesh.positions.iter().flat_map(|p| p.map(|x| x as f32));
    let normals: Vec<_> = normals.collect();
    let layers = vec![
        Layer { kind: LayerKind::Uv(0), name: "uv".into(), width: 2, values },
        Layer {
            kind: LayerKind::Normal,
            name: "normal".into(),
            width: 3,
            values: [&normals[..], &normals].concat(),
        },
    ];
    mesh.attributes = Some(Attributes { corners, wedge_count: 2 * count, layers });
    mesh
}

#[test]
fn seams_stay_seams_and_the_rest_stays_smooth() {
    let mesh = seamed_torus();
    for block_faces in [16, 100, 256] {
        assert_same(&mesh, &options(block_faces));
        let encoded = Transport::encode(&mesh, &options(block_faces)).unwrap();
        assert!(encoded.blocks > 10);
        let again = Transport::encode(&mesh, &options(block_faces)).unwrap();
        assert!(again.bytes == encoded.bytes, "the same bytes each time");
        let decoded = TransportFile::open(&encoded.bytes).unwrap().decode().unwrap();
        let wedges = |mesh: &Mesh| {
            let mut used = mesh.attributes.as_ref().unwrap().corners.concat();
            used.sort_unstable();
            used.dedup();
            used.len()
        };
        assert_eq!(wedges(&decoded), wedges(&mesh));
        assert!(wedges(&decoded) > decoded.positions.len());
    }
}

#[test]
fn wedges_with_equal_values_become_one() {
    let mut mesh = seamed_torus();
    mesh.attributes.as_mut().unwrap().layers.remove(0);
    let encoded = Transport::encode(&mesh, &options(256)).unwrap();
    let decoded = TransportFile::open(&encoded.bytes).unwrap().decode().unwrap();
    assert_eq!(decoded.attributes.unwrap().wedge_count, decoded.positions.len());
}

#[test]
fn directions_that_are_all_the_same_cost_next_to_nothing() {
    let mut mesh = samples::knot(4000);
    let mut own = attributes(&mesh, smooth(&mesh), None);
    own.layers.retain(|layer| matches!(layer.kind, LayerKind::Uv(0)));
    let constant = |kind, value: &[f32]| Layer {
        kind,
        name: String::new(),
        width: value.len(),
        values: value.repeat(own.wedge_count),
    };
    let layers = [
        constant(LayerKind::Normal, &[0.0, 0.6, 0.8]),
        constant(LayerKind::Tangent, &[1.0, 0.0, 0.0, -1.0]),
    ];
    own.layers.extend(layers);
    mesh.attributes = Some(own);
    let encoded = Transport::encode(&mesh, &options(256)).unwrap();
    let bytes: Vec<usize> = encoded.layers.iter().map(|layer| layer.bytes).collect();
    // Little more than the first of each block.
    assert!(30 * bytes[1].max(bytes[2]) < bytes[0], "{bytes:?}");
    let decoded = TransportFile::open(&encoded.bytes).unwrap().decode().unwrap();
    let tangents = &decoded.attributes.unwrap().layers[2].values;
    assert!(tangents.chunks(4).all(|t| t[0] > 0.9999 && t[3] == -1.0));
}

#[test]
fn versions_say_what_a_reader_needs() {
    let mut mesh = samples::knot(2000);
    let own = attributes(&mesh, smooth(&mesh), None);
    // Beside texture coordinates, from which tangents would follow.
    let with = |constant: Option<(LayerKind, &[f32])>| {
        let is_kept = |layer: &&Layer| {
            let kind = constant.map(|(kind, _)| kind);
            layer.kind == LayerKind::Uv(0) || Some(layer.kind) == kind
        };
        let mut layers: Vec<Layer> = own.layers.iter().filter(is_kept).cloned().collect();
        for layer in &mut layers {
            if let Some((_, value)) = constant.filter(|(kind, _)| *kind == layer.kind) {
                layer.values = value.repeat(own.wedge_count);
            }
        }
        Some(Attributes { layers, ..own.clone() })
    };
    let all = [
        (None, 4),
        (with(None), 5),
        (with(Some((LayerKind::Normal, &[0.0, 0.6, 0.8]))), 6),
        (with(Some((LayerKind::Tangent, &[1.0, 0.0, 0.0, -1.0]))), 6),
    ];
    for (attributes, version) in all {
        mesh.attributes = attributes;
        let bytes = Transport::encode(&mesh, &options(256)).unwrap().bytes;
        assert_eq!(bytes[8..12], u32::to_le_bytes(version));
        assert!(TransportFile::open(&bytes).unwrap().decode().is_ok());
        for other in (0..=7).chain([u32::MAX]) {
            let mut named = bytes.clone();
            named[8..12].copy_from_slice(&other.to_le_bytes());
            let opened = TransportFile::open(&named);
            assert_eq!(opened.is_ok(), other == version, "{version} as {other}");
        }
    }
}

#[test]
fn blocks_decoded_alone_have_the_attributes_of_the_mesh() {
    let mut mesh = samples::knot(3000);
    mesh.attributes = Some(attributes(&mesh, torn(&mesh, 2, 7), Some(3)));
    mesh.materials = Some(labels(mesh.faces.len(), 9, 1));
    let bytes = Transport::encode(&mesh, &options(256)).unwrap().bytes;
    let file = TransportFile::open(&bytes).unwrap();
    let whole = file.decode().unwrap();
    let mut from = 0;
    for at in 0..file.blocks() {
        let block = file.block(at).unwrap();
        block.validate().unwrap();
        let (own, all) = (block.attributes.as_ref().unwrap(), whole.attributes.as_ref().unwrap());
        for (f, corners) in own.corners.iter().enumerate() {
            for (k, &wedge) in corners.iter().enumerate() {
                let there = all.corners[from + f][k];
                for (own, all) in own.layers.iter().zip(&all.layers) {
                    assert_eq!(own.of(wedge), all.of(there));
                }
            }
        }
        let [own, all] = [&block.materials, &whole.materials].map(|of| of.as_ref().unwrap());
        assert_eq!(own.of_face, all.of_face[from..][..own.of_face.len()]);
        from += block.faces.len();
    }
    assert_eq!(from, mesh.faces.len());
}

#[test]
fn resources_come_back_and_bare_files_have_no_trace_of_what_they_lack() {
    let bare = cube();
    let plain = Transport::encode(&bare, &options(256)).unwrap();
    assert_eq!(plain.bytes[8], 4);
    assert_eq!((plain.sizes.attributes, plain.sizes.resources), (0.0, 0));
    let resources: Vec<u8> = (0..=255).cycle().take(1000).collect();
    for mesh in [bare, seam_strip()] {
        let encoded = Transport::encode_with_resources(&mesh, &resources, &options(256)).unwrap();
        assert_eq!((encoded.bytes[8], encoded.sizes.resources), (5, 1000));
        let file = TransportFile::open(&encoded.bytes).unwrap();
        assert_eq!(file.resources(), Ok(&resources[..]));
        assert_eq!(file.decode().unwrap().faces.len(), mesh.faces.len());
        let mut damaged = encoded.bytes.clone();
        *damaged.last_mut().unwrap() ^= 1;
        assert!(TransportFile::open(&damaged).unwrap().resources().is_err());
        assert!(TransportFile::open(&damaged[..damaged.len() - 1]).is_err());
    }
}

#[test]
fn sizes_add_up() {
    let mesh = seamed_torus();
    let encoded = Transport::encode(&mesh, &options(256)).unwrap();
    let TransportSizes { positions, connectivity, attributes, resources, headers } = encoded.sizes;
    let all = positions + connectivity + attributes + resources as f64 + headers;
    assert!((all - encoded.bytes.len() as f64).abs() < 1e-6);
    let layers: usize = encoded.layers.iter().map(|layer| layer.bytes).sum();
    assert!(layers as f64 <= attributes + 1.0 && layers as f64 > 0.9 * attributes);
}
