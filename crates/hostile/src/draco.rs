//! Documents around Draco streams, so that mutations hit the streams alone.

use meshlod_fixtures as fixtures;
use serde_json::{Value, json};

const FILES: [&str; 3] = ["edgebreaker.glb", "sequential.glb", "unquantized.glb"];

/// Length of the header of a GLB, up to the JSON.
const JSON: usize = 20;

/// Puts a stream into the document of one of our files. The input is the number of the file, the
/// numbers of indices and of points, in two bytes each, and the stream; a zero leaves the file's
/// number.
pub fn document(input: &[u8]) -> Option<Vec<u8>> {
    let (&[file, i0, i1, p0, p1], stream) = input.split_first_chunk()?;
    let (mut json, _) = parts(FILES[usize::from(file) % FILES.len()]);
    let counts = [u16::from_le_bytes([i0, i1]), u16::from_le_bytes([p0, p1])];
    for (i, accessor) in json["accessors"].as_array_mut()?.iter_mut().enumerate() {
        let count = counts[usize::from(i > 0)];
        if count > 0 {
            accessor["count"] = count.into();
        }
    }
    json["bufferViews"][0]["byteLength"] = stream.len().into();
    json["buffers"] = json!([{ "byteLength": stream.len() }]);
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = |bytes: usize| (bytes as u32).to_le_bytes();
    let total = JSON + text.len() + 8 + stream.len();
    let mut glb = [*b"glTF", 2u32.to_le_bytes(), length(total)].concat();
    glb.extend([length(text.len()), *b"JSON"].concat());
    glb.extend(text);
    glb.extend([length(stream.len()), *b"BIN\0"].concat());
    glb.extend(stream);
    Some(glb)
}

/// Returns inputs with the streams of our files.
pub fn seeds() -> Vec<Vec<u8>> {
    let seed = |(i, name): (usize, &&str)| [&[i as u8, 0, 0, 0, 0], &parts(name).1[..]].concat();
    FILES.iter().enumerate().map(seed).collect()
}

/// Returns the document and the stream of one of our files.
fn parts(name: &str) -> (Value, Vec<u8>) {
    let glb = std::fs::read(fixtures::own_file("draco").join(name)).expect("our own file");
    let length = u32::from_le_bytes(std::array::from_fn(|k| glb[12 + k])) as usize;
    let json = serde_json::from_slice(&glb[JSON..JSON + length]).expect("our own file");
    (json, glb[JSON + length + 8..].to_vec())
}
