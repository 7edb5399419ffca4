//! Properties that every scheme must have, on every kind of mesh.

use glam::DVec3;
use meshlod_fixtures as fixtures;
use meshlod_mesh::{
    AttributeBounds, Attributes, Connectivity, Labels, Layer, LayerKind, Mesh, VertexId, WedgeId,
    face_components,
};
use meshlod_samples as samples;
use meshlod_strip::{StripOptions, StripQuality, stripify};

use super::*;
use crate::blocks::Accuracy;
use crate::lattice::Lattice;
use crate::parts::{Partitioner, Reconstruction};

/// Meshes with and without attributes and seams, closed, open and non-manifold.
fn meshes() -> Vec<Mesh> {
    let mut seamed = samples::terrain(1500);
    // Each face has wedges of its own.
    let corners = (0..seamed.faces.len()).map(|f| [3 * f, 3 * f + 1, 3 * f + 2].map(WedgeId::new));
    let corners: Vec<_> = corners.collect();
    let uv = |k: usize| [(k % 97) as f32 / 97.0, (k / 7 % 13) as f32];
    let count = 3 * corners.len();
    seamed.attributes = Some(Attributes {
        corners,
        wedge_count: count,
        layers: vec![Layer {
            kind: LayerKind::Uv(0),
            name: "uv".into(),
            width: 2,
            values: (0..count).flat_map(uv).collect(),
        }],
    });
    let names = ["a", "b", "c"].map(String::from).into();
    let of_face = (0..seamed.faces.len() as u32).map(|f| f / 7 % 3).collect();
    seamed.materials = Some(Labels { names, of_face });
    vec![
        samples::sphere(3000),
        samples::gyroid(4000),
        fixtures::seam_strip(),
        seamed,
        fixtures::two_objects(),
        fixtures::moebius(9),
        fixtures::hourglass(),
        fixtures::mesh(&[[5.0; 3], [6.0, 5.0, 5.0], [5.0, 6.0, 5.0]], &[[0, 1, 2], [0, 1, 2]]),
    ]
}

/// A mesh compressed by every scheme.
fn by_schemes(mesh: &Mesh) -> Vec<Compressed> {
    compressions(mesh).into_iter().map(|done| done.compressed).collect()
}

fn compressions(mesh: &Mesh) -> Vec<Compression> {
    let bounds = AttributeBounds::default();
    let parts = Partitioner::new(mesh).unwrap();
    let in_parts = |count, cells| {
        Compressed::in_parts(mesh, &parts.with_count(count, cells), &bounds).unwrap()
    };
    vec![
        in_parts(1, Reconstruction::Centred),
        in_parts(9, Reconstruction::Truncated),
        stripped(in_parts(1, Reconstruction::Truncated)),
        stripped(in_parts(9, Reconstruction::Centred)),
        Compressed::on_lattice(mesh, Lattice::new(-7).unwrap(), &bounds).unwrap(),
        Compressed::in_blocks(mesh, Accuracy::Bits(8), &bounds).unwrap(),
    ]
}

/// Stores the faces of parts as strips.
fn stripped(done: Compression) -> Compression {
    let faces = done.compressed.stored().unwrap().faces;
    let faces: Vec<_> = faces.into_iter().map(|face| face.map(VertexId)).collect();
    let options = StripOptions { quality: StripQuality::Fast, ..StripOptions::default() };
    let strips = stripify(&faces, &options);
    let strips = strips.iter().map(|strip| strip.iter().map(|node| node.0));
    Compression { compressed: done.compressed.with_strips(strips).unwrap(), ..done }
}

/// Faces of a mesh as positions and values of their corners, from the least corner on, with their
/// material and object, sorted.
fn drawn(mesh: &Mesh, at: impl Fn(f64) -> f64) -> Vec<[String; 3]> {
    let corner = |face: usize, k: usize| {
        let place = mesh.positions[mesh.faces[face][k].index()].map(&at);
        let values = mesh.attributes.iter().flat_map(|of| {
            of.layers.iter().map(move |layer| layer.of(of.corners[face][k]).to_vec())
        });
        let labels = [&mesh.materials, &mesh.objects];
        let labels = labels.map(|of| of.as_ref().map(|of| &of.names[of.of(face) as usize]));
        format!("{place:?} {:?} {labels:?}", values.collect::<Vec<_>>())
    };
    let turned = |face: usize| {
        let mut corners = [0, 1, 2].map(|k| corner(face, k));
        let least = (0..3).min_by_key(|&k| &corners[k]).unwrap();
        corners.rotate_left(least);
        corners
    };
    let mut drawn: Vec<_> = (0..mesh.faces.len()).map(turned).collect();
    drawn.sort_unstable();
    drawn
}

#[test]
fn every_scheme_gives_the_mesh_back_from_bytes() {
    for mesh in meshes() {
        for compressed in by_schemes(&mesh) {
            let bytes = compressed.to_bytes();
            assert_eq!(bytes.len(), compressed.sizes().total);
            let read = Compressed::from_bytes(&bytes).unwrap();
            assert!(read == compressed && read.sizes() == compressed.sizes());
            let decoded = compressed.decode().unwrap();
            assert!(read.decode().unwrap() == decoded);
            decoded.validate().unwrap();
            let used = mesh.used_vertices().iter().filter(|&&used| used).count();
            assert_eq!((decoded.positions.len(), decoded.faces.len()), (used, mesh.faces.len()));
            let shape = |mesh: &Mesh| {
                let count = mesh.positions.len();
                let is_closed = Connectivity::new(&mesh.faces, count).is_closed();
                (is_closed, face_components(&mesh.faces, count).1)
            };
            assert_eq!(shape(&decoded), shape(&mesh));
        }
    }
}

/// Random triangles, some of them far larger than others.
fn soup(seed: u32) -> Mesh {
    let number = |i: u32| {
        let hashed = (i ^ seed.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b);
        let hashed = (hashed ^ (hashed >> 13)).wrapping_mul(0xc2b2_ae35);
        f64::from(hashed ^ (hashed >> 16)) / f64::from(u32::MAX)
    };
    let scale = |v: u32| if number(7000 + v) < 0.1 { 100.0 } else { 1.0 };
    let count = 10 + seed * 13 % 200;
    let place = |v: u32| [0, 1, 2].map(|k| number(3 * v + k) * scale(v));
    let corner = |i: u32| (number(20_000 + i) * f64::from(count)) as u32 % count;
    let faces = (0..2 * count).map(|f| [0, 1, 2].map(|k| corner(3 * f + k)));
    fixtures::mesh(&(0..count).map(place).collect::<Vec<_>>(), &faces.collect::<Vec<_>>())
}

#[test]
fn written_files_can_be_read_with_any_cells() {
    for seed in 0..24 {
        let (mesh, bits) = (soup(seed), 2 + seed % 23);
        for scheme in [Scheme::Parts(Reconstruction::Centred), Scheme::Lattice, Scheme::Blocks] {
            let done =
                compress(&mesh, scheme, CompressionTarget::Bits(bits), &AttributeBounds::default());
            let Ok(Compression { compressed, vertices, .. }) = done else { continue };
            let read = Compressed::from_bytes(&compressed.to_bytes()).unwrap();
            assert_eq!(read.decode().unwrap().positions.len(), vertices.len());
        }
    }
}

#[test]
fn many_faces_at_one_vertex_are_compressed_too() {
    let rim = |i: u32| (f64::from(i) * 0.01).sin_cos();
    let points = (0..600).map(|i| [rim(i).0, rim(i).1, f64::from(i) * 1e-3]);
    let points: Vec<_> = std::iter::once([0.0, 0.0, 1.0]).chain(points).collect();
    let faces: Vec<_> = (1..600).map(|i| [0, i, i + 1]).collect();
    let mesh = fixtures::mesh(&points, &faces);
    for compressed in by_schemes(&mesh) {
        assert_eq!(compressed.decode().unwrap().faces.len(), faces.len());
    }
}

#[test]
fn a_reduction_is_reached_or_reported_as_missed() {
    for mesh in [samples::gyroid(3000), samples::sphere(600), fixtures::grid(6)] {
        for scheme in [Scheme::Parts(Reconstruction::Centred), Scheme::Lattice, Scheme::Blocks] {
            for part in [0.5, 0.6, 0.7] {
                let target = CompressionTarget::Reduction(part);
                let done = compress(&mesh, scheme, target, &AttributeBounds::default()).unwrap();
                assert_eq!(done.reached, done.compressed.reduction() >= part);
            }
        }
    }
}

#[test]
fn faces_and_values_match_the_lattice() {
    for mut mesh in meshes() {
        let bounds = AttributeBounds::default();
        let compressed = Compressed::on_lattice(&mesh, Lattice::new(-7).unwrap(), &bounds).unwrap();
        let closest = |x: f64| (x * 128.0).round() / 128.0 + 0.0;
        for layer in mesh.attributes.iter_mut().flat_map(|of| &mut of.layers) {
            layer.values.iter_mut().for_each(|x| *x = (*x * 4096.0).round() / 4096.0 + 0.0);
        }
        let decoded = compressed.compressed.decode().unwrap();
        assert!(drawn(&decoded, |x| x + 0.0) == drawn(&mesh, closest));
    }
}

#[test]
fn patches_decoded_alone_are_the_mesh() {
    for mesh in meshes() {
        for compressed in by_schemes(&mesh) {
            let patches = (0..compressed.patches()).map(|at| compressed.patch(at).unwrap());
            let mut alone: Vec<_> = patches.flat_map(|patch| drawn(&patch, |x| x)).collect();
            alone.sort_unstable();
            assert!(alone == drawn(&compressed.decode().unwrap(), |x| x));
        }
    }
}

#[test]
fn resources_come_back_and_are_covered_by_a_checksum() {
    for mesh in [samples::sphere(200), meshes().remove(3)] {
        for compressed in by_schemes(&mesh) {
            let bare = compressed.to_bytes().len();
            let compressed = compressed.with_resources(vec![9; 500]);
            let bytes = compressed.to_bytes();
            assert_eq!(bytes.len(), compressed.sizes().total);
            assert!(bytes.len() > bare + 499);
            let read = Compressed::from_bytes(&bytes).unwrap();
            assert!(read == compressed && read.resources() == [9; 500]);
            let mut damaged = bytes.clone();
            *damaged.last_mut().unwrap() ^= 1;
            assert!(Compressed::from_bytes(&damaged).is_err());
            assert!(Compressed::from_bytes(&bytes[..bytes.len() - 1]).is_err());
            Compressed::seal(&mut damaged);
            assert_eq!(Compressed::from_bytes(&damaged).unwrap().resources()[499], 8);
        }
    }
}

#[test]
fn every_vertex_has_the_right_source() {
    for mesh in meshes() {
        for Compression { compressed, vertices, .. } in compressions(&mesh) {
            let decoded = compressed.decode().unwrap();
            assert_eq!(vertices.len(), decoded.positions.len());
            let was = |v: &VertexId| DVec3::from(mesh.positions[v.index()]);
            let apart = vertices.iter().zip(&decoded.positions);
            let apart = apart.map(|(v, &is)| was(v).distance(is.into())).fold(0.0, f64::max);
            assert!(apart < mesh.bounds().diagonal() / 60.0, "{apart}");
        }
    }
}

#[test]
fn impossible_requests_are_refused() {
    let lattice = Lattice::new(-7).unwrap();
    let ask = |mesh: &Mesh| {
        Compressed::on_lattice(mesh, lattice, &AttributeBounds::default()).map(|_| ()).unwrap_err()
    };
    assert_eq!(ask(&Mesh::default()), CompressError::Empty);
    let mut mesh = fixtures::seam_strip();
    let layer = |mesh: &mut Mesh, change: &dyn Fn(&mut Layer)| {
        change(&mut mesh.attributes.as_mut().unwrap().layers[0]);
    };
    layer(&mut mesh, &|layer| *layer.values.last_mut().unwrap() = f32::NAN);
    assert!(matches!(ask(&mesh), CompressError::NotFinite { .. }));
    layer(&mut mesh, &|layer| layer.name = "x".repeat(70_000));
    assert!(matches!(ask(&mesh), CompressError::Layer(_)));
    mesh.faces[0][0] = VertexId(1000);
    assert!(matches!(ask(&mesh), CompressError::Mesh(_)));
}

#[test]
fn damaged_bytes_are_refused() {
    for mesh in [samples::gyroid(1000), fixtures::seam_strip()] {
        for compressed in by_schemes(&mesh) {
            let bytes = compressed.to_bytes();
            for bit in (0..8 * bytes.len()).step_by(bytes.len() / 40) {
                let mut damaged = bytes.clone();
                damaged[bit / 8] ^= 1 << (bit % 8);
                assert!(Compressed::from_bytes(&damaged).is_err(), "bit {bit}");
            }
            for len in (0..bytes.len()).step_by(bytes.len() / 40) {
                assert!(Compressed::from_bytes(&bytes[..len]).is_err());
            }
        }
    }
}

#[test]
fn damage_with_valid_checksums_does_no_harm() {
    let mut read = 0;
    for mesh in [samples::gyroid(600), meshes().remove(3)] {
        for compressed in by_schemes(&mesh) {
            let bytes = compressed.to_bytes();
            for bit in (0..8 * bytes.len()).step_by(1 + bytes.len() / 30) {
                let mut damaged = bytes.clone();
                damaged[bit / 8] ^= 1 << (bit % 8);
                Compressed::seal(&mut damaged);
                let decoded = Compressed::from_bytes(&damaged).and_then(|of| of.decode());
                read += usize::from(decoded.is_ok());
                decoded.map_or(Ok(()), |mesh| mesh.validate()).unwrap();
            }
        }
    }
    assert!(read > 200, "{read}");
}

#[test]
fn bytes_do_not_depend_on_the_number_of_threads() {
    // More vertices than are assigned in one chunk, and more faces than have their boxes merged.
    let mesh = samples::gyroid(70_000);
    for scheme in [Scheme::Blocks, Scheme::Lattice, Scheme::Parts(Reconstruction::Centred)] {
        let bytes = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let bounds = AttributeBounds::default();
            let done =
                pool.install(|| compress(&mesh, scheme, CompressionTarget::Bits(9), &bounds));
            done.unwrap().compressed.to_bytes()
        };
        assert_eq!(bytes(1), bytes(3));
    }
}
