//! Multiresolution files without entropy coding, so that mutations hit the numbers themselves.

use meshlod_fixtures as fixtures;
use meshlod_multires::{
    Archive, BuildError, Forest, HeightField, HeightPrecision, Resource, Storage,
};
use meshlod_samples as samples;
use meshlod_simplify::{Method, Options};

/// Offsets of the number of chunks and of the table of chunks in a file of contractions
/// (docs/formats/mlod.md).
const CHUNKS: usize = 36;
const TABLE: usize = 88;
/// Length of an entry of the table.
const ENTRY: usize = 44;
/// Offset of the size of the coarsest mesh, which its checksum follows.
const BASE: usize = 28;
/// Magic bytes of a height field, and the offsets of its checksum, of the length of the rest, of
/// the rest, and of the heights.
const FIELD: &[u8] = b"meshlodh";
const FIELD_CHECKSUM: usize = 12;
const FIELD_LENGTH: usize = 16;
const FIELD_BODY: usize = 24;
const HEIGHTS: usize = FIELD_BODY + 72;

/// Writes matching checksums and lengths, for both kinds of files.
pub fn seal(bytes: &mut [u8]) {
    if bytes.starts_with(FIELD) && bytes.len() >= FIELD_BODY {
        let length = (bytes.len() - FIELD_BODY) as u64;
        bytes[FIELD_LENGTH..FIELD_BODY].copy_from_slice(&length.to_le_bytes());
        let checksum = crc32fast::hash(&bytes[FIELD_LENGTH..]);
        bytes[FIELD_CHECKSUM..FIELD_LENGTH].copy_from_slice(&checksum.to_le_bytes());
    } else {
        Archive::rewrite_checksums(bytes);
    }
}

/// Builds small files of all kinds.
pub(crate) fn seeds() -> Vec<Vec<u8>> {
    let meshes = [
        fixtures::tetrahedron(),
        fixtures::cube(),
        fixtures::fan(),
        fixtures::grid(4),
        fixtures::hourglass(),
        fixtures::moebius(5),
        fixtures::two_objects(),
        samples::torus(80),
        fixtures::seam_strip(),
        fixtures::charted(&samples::torus(60)),
    ];
    let methods = [Method::Qem, Method::LeeJang, Method::LindstromTurkFaces];
    let files = meshes.iter().flat_map(|mesh| {
        methods.into_iter().flat_map(move |method| {
            let options = Options { method, ..Options::default() };
            [Forest::new, Forest::lossless].map(|record| contractions(record(mesh, &options)))
        })
    });
    let files: Vec<Vec<u8>> = files.collect();
    let attached = with_resources(&files[0]);
    let fields = [fixtures::grid(4), samples::terrain(100)];
    let precisions = [HeightPrecision::Exact, HeightPrecision::Within(0.01)];
    let fields = fields.iter().filter_map(|mesh| HeightField::from_mesh(mesh).ok());
    let fields = fields.flat_map(|field| {
        precisions.map(|precision| plain_field(&field.to_file(precision).expect("a precision").0))
    });
    files.into_iter().chain([attached]).chain(fields).collect()
}

/// Builds a file with chunks small enough that there are several.
fn contractions(forest: Result<Forest, BuildError>) -> Vec<u8> {
    let storage = Storage { updates_per_chunk: 8, ..Storage::default() };
    plain(&Archive::write(&forest.expect("a mesh"), &storage).expect("a proof").0.into_source())
}

/// Attaches resources to a file, before its chunks and after them.
fn with_resources(bytes: &[u8]) -> Vec<u8> {
    let archive = Archive::open(bytes.to_vec()).expect("a file");
    let resource = |after_chunks| Resource { after_chunks, bytes: vec![7; 100] };
    let attached = archive.with_resources(&[resource(0), resource(1)]);
    attached.expect("they are short").into_source()
}

/// Decompresses a file of contractions.
fn plain(bytes: &[u8]) -> Vec<u8> {
    let index = TABLE + ENTRY * word(bytes, CHUNKS);
    let (mut head, mut pieces, mut from) = (bytes[..index].to_vec(), Vec::new(), index);
    for at in std::iter::once(BASE).chain((TABLE..index).step_by(ENTRY)) {
        let end = from + word(bytes, at);
        let piece = unpressed(&bytes[from..end]);
        head[at..at + 4].copy_from_slice(&(piece.len() as u32).to_le_bytes());
        pieces.extend(piece);
        from = end;
    }
    head.extend(pieces);
    seal(&mut head);
    head
}

/// Decompresses a height field.
fn plain_field(bytes: &[u8]) -> Vec<u8> {
    let (mut out, mut rest) = (bytes[..HEIGHTS].to_vec(), &bytes[HEIGHTS..]);
    // Each part has its bit width in one byte, and its length.
    while rest.len() >= 5 {
        let (part, after) = rest.split_at(5 + word(rest, 1));
        let packed = if part.len() > 5 { unpressed(&part[5..]) } else { Vec::new() };
        out.push(part[0]);
        out.extend((packed.len() as u32).to_le_bytes());
        out.extend(packed);
        rest = after;
    }
    out.extend(rest);
    seal(&mut out);
    out
}

/// Rewrites a Zstandard frame (RFC 8878) with its content in raw blocks.
fn unpressed(frame: &[u8]) -> Vec<u8> {
    const WINDOW: u8 = 0x70;
    const LONGEST: usize = 1 << 16;
    let content = zstd::decode_all(frame).expect("a frame");
    let mut out = [&0xFD2F_B528u32.to_le_bytes()[..], &[0, WINDOW]].concat();
    let count = content.len().div_ceil(LONGEST).max(1);
    for i in 0..count {
        let block = &content[LONGEST * i..content.len().min(LONGEST * (i + 1))];
        let header = (block.len() as u32) << 3 | u32::from(i + 1 == count);
        out.extend(&header.to_le_bytes()[..3]);
        out.extend(block);
    }
    out
}

fn word(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(std::array::from_fn(|k| bytes[at + k])) as usize
}
