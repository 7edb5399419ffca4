use meshlod_fixtures::{
    cube, fan, grid, hourglass, mesh, moebius, own_file, seam_strip, tetrahedron, two_objects,
};
use meshlod_mesh::{Mesh, VertexId};
use meshlod_samples as samples;

use super::*;
use crate::Malformed;

/// Deterministic pseudo-random numbers.
pub(super) struct Numbers(pub(super) u64);

impl Numbers {
    pub(super) fn next(&mut self, below: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % below
    }
}

pub(super) fn options(block_faces: usize) -> TransportOptions {
    TransportOptions { block_faces, ..TransportOptions::default() }
}

/// Rotates faces to start at their least corner, and sorts them.
fn turned(faces: impl Iterator<Item = [u32; 3]>) -> Vec<[u32; 3]> {
    let turn = |mut face: [u32; 3]| {
        let least = (0..3).min_by_key(|&k| (face[k], face[(k + 1) % 3])).unwrap();
        face.rotate_left(least);
        face
    };
    let mut faces: Vec<_> = faces.map(turn).collect();
    faces.sort_unstable();
    faces
}

/// Checks that a file has the same faces over the same vertices, close to where they were.
fn assert_same(mesh: &Mesh, options: &TransportOptions) {
    let file = Transport::encode(mesh, options).unwrap();
    let file = TransportFile::open(&file.bytes).unwrap();
    let decoded = file.decode().unwrap();
    let (mut positions, mut corners) = (Vec::new(), Vec::new());
    file.decode_into(&mut positions, &mut corners).unwrap();
    assert_eq!((file.vertices(), file.faces()), (positions.len(), corners.len()));

    // Vertices come in the order of their first block.
    let mut numbers = vec![None; mesh.positions.len()];
    let mut count = 0;
    let (_, cells) = grid::QuantizationGrid::of(mesh, options.quantization).unwrap();
    for walk in write::walks(&mesh.faces, &cells, options.block_faces) {
        for v in walk.vertices {
            numbers[v as usize].get_or_insert_with(|| {
                count += 1;
                count - 1
            });
        }
    }
    assert_eq!(count as usize, decoded.positions.len());
    let expected = mesh.faces.iter().map(|face| face.map(|v| numbers[v.index()].unwrap()));
    assert_eq!(turned(expected), turned(decoded.faces.iter().map(|face| face.map(|v| v.0))));
    assert_eq!(corners, decoded.faces.iter().map(|face| face.map(|v| v.0)).collect::<Vec<_>>());
    for (number, position) in numbers.iter().zip(&mesh.positions) {
        let Some(number) = number.map(|n| n as usize) else { continue };
        for k in 0..3 {
            let off = (decoded.positions[number][k] - position[k]).abs();
            assert!(off <= 0.5001 * file.cell(), "{off} of {}", file.cell());
            assert_eq!(positions[number][k], decoded.positions[number][k] as f32);
        }
    }
}

/// Returns faces that join random vertices.
pub(super) fn soup(vertices: usize, faces: usize, seed: u64) -> Mesh {
    let mut numbers = Numbers(seed);
    let positions = (0..vertices).map(|_| [0; 3].map(|_| numbers.next(50) as f64)).collect();
    let face = |_| [0; 3].map(|_| VertexId(numbers.next(vertices) as u32));
    Mesh::new(positions, (0..faces).map(face).collect())
}

#[test]
fn samples_come_back() {
    for name in ["sphere", "torus", "knot", "gyroid", "terrain"] {
        let mesh = samples::by_name(name, Some(3000)).unwrap();
        for bits in [1, 4, 11, 16, 21] {
            let quantization = TransportQuantization::Bits(bits);
            assert_same(&mesh, &TransportOptions { quantization, ..Default::default() });
        }
        assert_same(&mesh, &options(16));
        assert_same(&mesh, &options(max_block_faces()));
    }
}

#[test]
fn non_manifold_meshes_come_back() {
    for mesh in [tetrahedron(), cube(), grid(3), two_objects(), fan(), hourglass()] {
        assert_same(&mesh, &options(16));
    }
    for n in [3, 8, 60] {
        assert_same(&moebius(n), &options(16));
    }
    for seed in 0..20 {
        for (vertices, faces) in [(4, 30), (12, 80), (200, 90), (60, 700), (900, 1800)] {
            assert_same(&soup(vertices, faces, seed), &options(64));
        }
    }
}

#[test]
fn corners_may_be_the_same_and_faces_too() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for faces in [
        &[[0, 0, 0]][..],
        &[[0, 0, 1]],
        &[[0, 1, 2], [0, 1, 2]],
        &[[0, 1, 2], [0, 2, 1]],
        &[[0, 1, 2], [0, 1, 1], [2, 1, 2], [1, 0, 2], [0, 1, 2]],
    ] {
        assert_same(&mesh(&corners, faces), &options(16));
    }
}

#[test]
fn vertices_in_one_cell_stay_separate() {
    // A few cells, and then a single one.
    let mut mesh = samples::sphere(3000);
    assert_same(
        &mesh,
        &TransportOptions { quantization: TransportQuantization::Bits(2), ..options(100) },
    );
    mesh.positions.fill([7.0, -2.0, 1e30]);
    assert_same(&mesh, &options(100));
}

#[test]
fn a_flat_mesh_a_line_and_a_far_one_come_back() {
    let flat = grid(20);
    assert_same(&flat, &options(64));
    let mut line = flat.clone();
    line.positions.iter_mut().for_each(|p| *p = [p[0], 0.0, 0.0]);
    assert_same(&line, &options(64));
    let mut far = flat;
    far.positions.iter_mut().for_each(|p| *p = p.map(|x| 1e30 * x - 5e32));
    assert_same(&far, &options(64));
}

#[test]
fn a_block_is_decoded_alone() {
    let mesh = samples::torus(5000);
    let bytes = Transport::encode(&mesh, &TransportOptions::default()).unwrap().bytes;
    let whole = TransportFile::open(&bytes).unwrap().decode().unwrap();
    let blocks = TransportFile::open(&bytes).unwrap().blocks();
    assert!(blocks > 15);
    let mut from = 0;
    for k in 0..blocks {
        // Erase all other blocks.
        let file = TransportFile::open(&bytes).unwrap();
        let range = file.range(k);
        let mut bytes = bytes.clone();
        let at = bytes.len() - file.range(blocks - 1).end;
        let kept = at + range.start..at + range.end;
        (at..bytes.len()).filter(|i| !kept.contains(i)).for_each(|i| bytes[i] = 0);
        let block = TransportFile::open(&bytes).unwrap().block(k).unwrap();
        for (face, whole_face) in block.faces.iter().zip(&whole.faces[from..]) {
            for (v, w) in face.iter().zip(whole_face) {
                assert_eq!(block.positions[v.index()], whole.positions[w.index()]);
            }
        }
        from += block.faces.len();
    }
    assert_eq!(from, mesh.faces.len());
}

#[test]
fn on_a_lattice_shared_vertices_coincide() {
    let lattice = crate::Lattice::new(-9).unwrap();
    let mesh = samples::knot(4000);
    let halves = mesh.faces.split_at(1500);
    let options =
        TransportOptions { quantization: TransportQuantization::Lattice(lattice), ..options(200) };
    for faces in [halves.0, halves.1] {
        let part = Mesh::new(mesh.positions.clone(), faces.to_vec());
        assert_same(&part, &options);
        let file = Transport::encode(&part, &options).unwrap();
        let decoded = TransportFile::open(&file.bytes).unwrap().decode().unwrap();
        for x in decoded.positions.iter().flatten() {
            assert_eq!((x * 512.0).fract(), 0.0);
        }
        let place = |x: f64| (x * 512.0).round() / 512.0;
        let mut expected: Vec<_> = decoded.positions.clone();
        let used = part.used_vertices();
        let mut places: Vec<_> =
            part.positions.iter().zip(used).filter(|x| x.1).map(|x| x.0.map(place)).collect();
        let order = |a: &[f64; 3], b: &[f64; 3]| a.partial_cmp(b).unwrap();
        expected.sort_by(order);
        places.sort_by(order);
        assert_eq!(expected, places);
    }
}

#[test]
fn unused_vertices_are_counted() {
    let unused = |mesh: &Mesh| Transport::encode(mesh, &options(256)).unwrap().unused_vertices;
    assert_eq!(unused(&tetrahedron()), 0);
    let mut mesh = seam_strip();
    mesh.positions.push([0.0; 3]);
    assert_eq!(unused(&mesh), 1);
}

#[test]
fn every_shape_has_a_table() {
    for class in 0..models::CLASSES {
        for code in 0..=u8::MAX {
            let table = models::ResidualTable::of(class, code);
            assert!(table.symbol(models::ESCAPE, 0, 0).is_some(), "{class} {code}");
            let all = (0..models::SYMBOLS).filter_map(|symbol| table.symbol(symbol, 0, 0));
            assert_eq!(all.map(|symbol| u32::from(symbol.size)).sum::<u32>(), 2048);
        }
    }
}

#[test]
fn bad_input_is_refused_in_words() {
    let encode = |mesh: &Mesh, options| Transport::encode(mesh, &options).unwrap_err();
    let good = tetrahedron();
    assert_eq!(encode(&Mesh::default(), options(256)), TransportError::Empty);
    let points = Mesh::new(vec![[0.0; 3]], Vec::new());
    assert_eq!(encode(&points, options(256)), TransportError::Empty);
    for bits in [0, 22, 64] {
        let options =
            TransportOptions { quantization: TransportQuantization::Bits(bits), ..options(256) };
        assert_eq!(encode(&good, options), TransportError::Bits(bits));
    }
    for size in [0, 15, 100_000] {
        assert_eq!(encode(&good, options(size)), TransportError::Block(size));
    }
    for x in [f64::NAN, f64::INFINITY, 1e39, -f64::MAX] {
        let mut bad = good.clone();
        bad.positions[2][1] = x;
        assert_eq!(encode(&bad, options(256)), TransportError::NotFinite(VertexId(2)));
    }
    let mut bad = good.clone();
    bad.faces[1][2] = VertexId(4);
    assert_eq!(encode(&bad, options(256)), TransportError::BadVertex(VertexId(4)));
    let lattice = |exponent| TransportOptions {
        quantization: TransportQuantization::Lattice(crate::Lattice::new(exponent).unwrap()),
        ..options(256)
    };
    assert!(matches!(encode(&good, lattice(-30)), TransportError::TooFine { .. }));
    let mut far = good;
    far.positions.iter_mut().for_each(|p| p[0] += 1e12);
    assert_eq!(encode(&far, lattice(-15)), TransportError::TooFar);
}

/// Returns a file of an earlier version, kept since that was the latest.
fn kept(name: &str) -> Vec<u8> {
    std::fs::read(own_file(name)).expect("our own file")
}

#[test]
fn files_of_version_1_give_the_same_mesh() {
    for (name, mut mesh) in
        [("knot-v1.mlz", samples::knot(400)), ("terrain-v1.mlz", samples::terrain(300))]
    {
        // They were made from files with single precision.
        mesh.positions.iter_mut().flatten().for_each(|x| *x = f64::from(*x as f32));
        let bytes = kept(name);
        assert_eq!(bytes[8], 1);
        let quantization = TransportQuantization::Bits(10);
        let now = Transport::encode(&mesh, &TransportOptions { quantization, ..options(256) });
        let decoded = [bytes, now.unwrap().bytes].map(|bytes| decode_all(&bytes).unwrap());
        assert_eq!(decoded[0].positions, decoded[1].positions, "{name}");
        assert_eq!(decoded[0].faces, decoded[1].faces, "{name}");
    }
}

#[test]
fn files_of_version_2_keep_their_attributes() {
    let bytes = kept("quad-v2.mlz");
    assert_eq!(bytes[8], 2);
    let mesh = decode_all(&bytes).unwrap();
    assert_eq!((mesh.positions.len(), mesh.faces.len()), (4, 2));
    let attributes = mesh.attributes.unwrap();
    assert_eq!((attributes.wedge_count, attributes.layers.len()), (4, 1));
    let corners: Vec<_> = attributes.layers[0].values.iter().map(|x| x.round()).collect();
    let corners: std::collections::BTreeSet<_> =
        corners.as_chunks().0.iter().map(|&[u, v]: &[f32; 2]| (u as i32, v as i32)).collect();
    assert_eq!(corners.len(), 4);
}

#[test]
fn fans_are_at_least_as_likely_as_a_slot() {
    // Every fan can occur, whatever the header says of its steps.
    for codes in [[0, 31, 31, 31, 31], [31, 0, 31, 31, 31], [31, 31, 31, 31, 0], [6; 5]] {
        let steps = [models::StepTable::of(codes); gate::CONTEXTS];
        for table in fans::FanTable::all(&steps).iter() {
            let sizes = table.sizes();
            assert!(sizes.iter().all(|&size| size > 0), "{sizes:?}");
            assert_eq!(sizes.iter().sum::<i32>(), 4096);
        }
    }
}

#[test]
fn a_long_fan_comes_back() {
    // More new vertices around one than a single symbol counts, closed and open.
    for around in 5..40 {
        for is_closed in [false, true] {
            let angle = |k: usize| k as f64 / f64::from(around) * std::f64::consts::TAU;
            let rim = (0..around as usize).map(|k| [angle(k).cos(), angle(k).sin(), 0.0]);
            let corners: Vec<_> = std::iter::once([0.0; 3]).chain(rim).collect();
            let last = around - u32::from(!is_closed);
            let faces: Vec<_> = (0..last).map(|k| [0, 1 + k, 1 + (k + 1) % around]).collect();
            assert_same(&mesh(&corners, &faces), &options(64));
        }
    }
}

/// Recomputes the checksums of header and blocks.
pub(super) fn seal(bytes: &mut [u8]) {
    TransportFile::seal(bytes);
}

pub(super) fn decode_all(bytes: &[u8]) -> Result<Mesh, Malformed> {
    let file = TransportFile::open(bytes)?;
    for block in 0..file.blocks() {
        if let Ok(block) = file.block(block) {
            block.validate().unwrap();
        }
    }
    let mesh = file.decode()?;
    mesh.validate().unwrap();
    Ok(mesh)
}

#[test]
fn a_flipped_bit_is_detected() {
    let mesh = samples::knot(2000);
    let bytes = Transport::encode(&mesh, &options(256)).unwrap().bytes;
    let mut missed = 0;
    for at in 0..bytes.len() {
        let mut bytes = bytes.clone();
        bytes[at] ^= 1 << (at % 8);
        assert!(decode_all(&bytes).is_err(), "byte {at}");
        // A single block detects damage by the checksum in its final state.
        if let Ok(file) = TransportFile::open(&bytes) {
            missed += usize::from((0..file.blocks()).all(|block| file.block(block).is_ok()));
        }
    }
    // Four bytes are the checksum of all blocks, which a single block does not check.
    assert!(missed <= 5, "{missed} of {}", bytes.len());
}

#[test]
fn any_bytes_are_survived() {
    let meshes = [samples::sphere(700), soup(60, 300, 5), hourglass(), grid(9)];
    let mut numbers = Numbers(1);
    let mut files = ["knot-v1.mlz", "terrain-v1.mlz", "quad-v2.mlz"].map(kept).to_vec();
    for mesh in meshes {
        files.push(Transport::encode(&mesh, &options(100)).unwrap().bytes);
    }
    for bytes in files {
        for _ in 0..1500 {
            let mut bytes = bytes.clone();
            for _ in 0..1 + numbers.next(4) {
                let at = numbers.next(bytes.len());
                bytes[at] = [0, 255, bytes[at] ^ 1, numbers.next(256) as u8][numbers.next(4)];
            }
            if numbers.next(4) == 0 {
                bytes.truncate(numbers.next(bytes.len()));
            }
            seal(&mut bytes);
            let _ = decode_all(&bytes);
        }
    }
}
