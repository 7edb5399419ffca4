//! Files beside the document: their names, made of their bytes, and the ids of what is in them.

use serde_json::{Map, Value, json};

use crate::error::Unsupported;
use crate::gltf::document::{container, uri};
use crate::scene::Image;

/// Suffix of the folder of the files of a document.
pub(crate) const FOLDER: &str = "_levels";

/// File of a level of a mesh or a size of an image, and what its entry in `lods` says of it.
pub(crate) struct PartFile {
    pub file: Image,
    /// Path of the file, as the client resolves it.
    pub path: String,
    pub hash: String,
}

impl PartFile {
    /// Joins a document and its buffer to a file `NAME.HASH.glb` in the folder of the document
    /// `stem`: a file never changes its contents, so that no version of the document and no cache
    /// ever has those of another.
    ///
    /// # Errors
    /// Above 4 GB.
    pub fn new(
        stem: &str,
        name: &str,
        json: Map<String, Value>,
        buffer: &[u8],
    ) -> Result<Self, Unsupported> {
        let bytes = container::join(Value::Object(json).to_string().as_bytes(), buffer)?;
        let mut hash = id([&bytes[..]]);
        hash.truncate(12);
        let name = format!("{stem}{FOLDER}/{name}.{hash}.glb");
        Ok(Self { path: path_of(&name), file: Image { name, bytes }, hash })
    }
}

/// Encodes the name of a file as the client takes it: it resolves what begins with `http` by itself.
fn path_of(name: &str) -> String {
    let uri = uri::of_file(name);
    match uri.strip_prefix('h').filter(|_| uri.starts_with("http")) {
        Some(rest) => format!("%68{rest}"),
        None => uri,
    }
}

/// Returns the head of the document of a part, to which no scene belongs yet.
pub(crate) fn head() -> Map<String, Value> {
    let head = json!({
        "asset": { "version": "2.0", "generator": concat!("meshlod ", env!("CARGO_PKG_VERSION")) },
    });
    head.as_object().cloned().unwrap_or_default()
}

/// Computes an id of texts or bytes, 32 hexadecimal digits: FNV-1a of 128 bits over all of them and
/// their lengths.
pub(crate) fn id<'a>(pieces: impl IntoIterator<Item = &'a [u8]>) -> String {
    const PRIME: u128 = (1 << 88) + 0x13b;
    let mut hash: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    let mut step = |byte: &u8| hash = (hash ^ u128::from(*byte)).wrapping_mul(PRIME);
    for piece in pieces {
        piece.iter().for_each(&mut step);
        piece.len().to_le_bytes().iter().for_each(&mut step);
    }
    format!("{hash:032x}")
}

/// Reports whether a file in the folder of a document has a name that [`PartFile::new`] gives.
pub(crate) fn is_part_name(name: &str) -> bool {
    let mut words = name.split('.');
    let what =
        words.next().is_some_and(|what| what.starts_with("mesh") || what.starts_with("image"));
    let is_hex = |word: &str| word.len() == 12 && word.bytes().all(|b| b.is_ascii_hexdigit());
    what && words.next().is_some_and(is_hex)
        && words.next() == Some("glb")
        && words.next().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_differ_by_every_byte_and_every_border() {
        let ids = [
            id([&b"ab"[..], b"c"]),
            id([&b"a"[..], b"bc"]),
            id([&b"abc"[..]]),
            id([&b"abd"[..]]),
            id([&b""[..]]),
        ];
        for (i, one) in ids.iter().enumerate() {
            assert!(one.len() == 32 && ids[..i].iter().all(|other| other != one), "{ids:?}");
        }
    }

    #[test]
    fn names_are_recognised_and_no_path_is_absolute() {
        let part = PartFile::new("httpd & co", "mesh0_LOD1", head(), b"").unwrap();
        assert!(part.path.starts_with("%68ttpd%20%26%20co_levels/mesh0_LOD1."), "{}", part.path);
        let name = part.file.name.rsplit_once('/').unwrap().1;
        assert!(is_part_name(name), "{name}");
        for name in ["mesh0.glb", "mesh0.0123456789ab.gltf", "x.0123456789ab.glb", "mesh.0.glb"] {
            assert!(!is_part_name(name), "{name}");
        }
    }
}
