//! Malformed files with matching checksums.

use meshlod_fixtures as fixtures;
use meshlod_mesh::Mesh;
use meshlod_samples as samples;
use meshlod_simplify::Options;

use super::small;
use crate::pack::ExactPositions;
use crate::{Archive, Forest, Query};

/// Offset of the base's length in the header, offset of the index, and length of its entries, which
/// start with the length of a chunk.
const BASE: usize = 28;
const INDEX: usize = 88;
const ENTRY_LEN: usize = 44;

fn written(forest: &Forest) -> Vec<u8> {
    Archive::write(forest, &small()).unwrap().0.into_source()
}

fn lossless(mesh: &Mesh) -> Forest {
    Forest::lossless(mesh, &Options::default()).unwrap()
}

fn lossy(mesh: &Mesh) -> Forest {
    Forest::new(mesh, &Options::default()).unwrap()
}

/// Returns the message with which a file is refused.
fn refusal(bytes: Vec<u8>) -> String {
    let read = Archive::open(bytes).and_then(|archive| archive.read());
    let why = read.map(|_| ()).unwrap_err().to_string();
    assert!(!why.contains('\n'));
    why
}

/// Returns a file with the contents of one section changed: a chunk, or the base for `None`.
fn changed(bytes: &[u8], chunk: Option<usize>, change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let archive = Archive::open(bytes.to_vec()).unwrap();
    let ends: Vec<usize> = archive.chunk_ends().map(|end| end as usize).collect();
    let (entry, start, end) = match chunk {
        Some(chunk) => (INDEX + ENTRY_LEN * chunk, ends[chunk], ends[chunk + 1]),
        None => (BASE, INDEX + ENTRY_LEN * archive.chunk_count(), ends[0]),
    };
    let mut content = zstd::decode_all(&bytes[start..end]).unwrap();
    change(&mut content);
    let piece = zstd::encode_all(&content[..], 1).unwrap();
    let mut all = [&bytes[..start], &piece, &bytes[end..]].concat();
    all[entry..entry + 4].copy_from_slice(&(piece.len() as u32).to_le_bytes());
    Archive::rewrite_checksums(&mut all);
    all
}

/// Returns the first flag byte after streams with the given numbers of elements.
fn first_flag<'c>(content: &'c mut [u8], numbers: &[usize]) -> &'c mut u8 {
    let at = numbers.iter().fold(0, |at, count| at + 1 + usize::from(content[at]) * count);
    &mut content[at]
}

#[test]
fn flags_that_are_not_known_are_refused() {
    let mesh = samples::torus(100);
    let [lossy, lossless] = [lossy(&mesh), lossless(&mesh)].map(|forest| written(&forest));
    for (bytes, flags) in [(&lossy, &[8, 16, 32, 64, 128][..]), (&lossless, &[32, 64, 128])] {
        let archive = Archive::open(bytes.clone()).unwrap();
        let updates = archive.header.chunks[0].updates as usize;
        for flag in flags {
            let wrong = changed(bytes, Some(0), |all| *first_flag(all, &[updates]) |= flag);
            let why = refusal(wrong);
            assert!(why.contains("update 0 is invalid: it has flags"), "{flag}: {why}");
        }
        assert!(Archive::open(changed(bytes, Some(0), |_| ())).unwrap().read().is_ok());
    }
    let header = Archive::open(lossless.clone()).unwrap().header;
    let [roots, faces] = [header.roots, header.base_faces].map(|count| count as usize);
    let streams = [roots, roots, roots, faces, faces, faces];
    let wrong = changed(&lossless, None, |all| *first_flag(all, &streams) |= 2);
    assert!(refusal(wrong).contains("the coarsest mesh: it has flags"));
    let mut wrong = lossy;
    wrong[19] = 128;
    Archive::rewrite_checksums(&mut wrong);
    assert!(refusal(wrong).contains("invalid header: it has flags"));
}

#[test]
fn forms_of_attributes_that_were_never_released_are_refused() {
    let bytes = written(&lossy(&fixtures::charted(&samples::torus(100))));
    let with_flags = |flags: u8| {
        let mut bytes = bytes.clone();
        bytes[19] = bytes[19] & 31 | flags;
        Archive::rewrite_checksums(&mut bytes);
        bytes
    };
    assert!(Archive::open(with_flags(128)).unwrap().read().is_ok());
    for flags in [0, 32, 64, 96, 192] {
        let why = refusal(with_flags(flags));
        assert!(why.ends_with("was never released; build it again"), "{flags}: {why}");
    }
}

#[test]
fn every_vertex_of_the_finest_mesh_has_its_position() {
    for without in [0, 57] {
        let mut forest = lossless(&samples::torus(200));
        let mut exact = ExactPositions::lossless();
        let others = (0..forest.vertices as u32).filter(|&leaf| leaf != without);
        others.for_each(|leaf| exact.push(leaf, forest.exact.get(leaf).unwrap()));
        forest.exact = exact;
        let archive = Archive::open(written(&forest)).unwrap();
        let why = archive.read().unwrap_err().to_string();
        assert_eq!(
            why,
            "the finest mesh: 1 of its vertices lack the exact position of a lossless file"
        );
        // This cannot be known before the last chunk.
        assert!(archive.read_chunks(archive.chunk_count() - 1).is_ok());
    }
}

#[test]
fn a_position_is_where_its_place_is() {
    let cases: [(usize, f64); 4] = [(0, 2e38), (1, 1e-3), (2, -1e-3), (0, f64::MAX)];
    for (axis, off) in cases {
        let mut forest = lossless(&samples::torus(200));
        let mut exact = ExactPositions::lossless();
        for leaf in 0..forest.vertices as u32 {
            let mut position = forest.exact.get(leaf).unwrap();
            position[axis] += if leaf == 31 { off } else { 0.0 };
            exact.push(leaf, position);
        }
        forest.exact = exact;
        let why = refusal(written(&forest));
        let expected = "one of its exact positions is outside the lattice cell of its vertex";
        assert!(why.ends_with(expected), "{off}: {why}");
    }
}

#[test]
fn places_are_numbers() {
    for forest in [lossy(&fixtures::cube()), lossless(&samples::torus(100))] {
        let mut wrong = written(&forest);
        wrong[40..48].copy_from_slice(&f64::MAX.to_le_bytes());
        wrong[64..72].copy_from_slice(&1000f64.exp2().to_le_bytes());
        Archive::rewrite_checksums(&mut wrong);
        assert!(refusal(wrong).contains("out of range"));
    }
}

/// Whatever a section says, what is extracted without a certificate is a valid mesh.
#[test]
fn faces_have_wedges_of_their_own_vertices() {
    let bytes = written(&lossy(&fixtures::seam_strip()));
    let chunks = Archive::open(bytes.clone()).unwrap().chunk_count();
    let mut refused = 0;
    for chunk in std::iter::once(None).chain((0..chunks).map(Some)) {
        let mut length = 0;
        changed(&bytes, chunk, |content| length = content.len());
        for (at, flip) in (0..length).flat_map(|at| [(at, 1), (at, 2)]) {
            let wrong = changed(&bytes, chunk, |content| content[at] ^= flip);
            let extract = |archive: Archive<_>| archive.extract(&Query::uniform(0.0));
            match Archive::open(wrong).and_then(extract) {
                Ok(taken) => taken.level.mesh().validate().unwrap(),
                Err(why) => refused += usize::from(why.to_string().contains("wedge of another")),
            }
        }
    }
    assert!(refused > 0);
}
