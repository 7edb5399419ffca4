//! Counts in the header of a Draco stream, checked before decoding.
//!
//! The decoder allocates tables by these counts, and a stream of 100 bytes can declare millions of
//! faces and 255 corner tables.

/// Reason for refusing a stream beyond its [`Ceiling`].
pub(crate) const TOO_LARGE: &str =
    "decompresses to far more than the file has data for; export it without Draco";

/// Limits on the decoded size of a stream.
pub(crate) struct Ceiling {
    pub faces: usize,
    /// Bytes of all arrays together.
    pub bytes: usize,
}

/// Only supported version of the bitstream, the one that glTF requires.
const VERSION: [u8; 2] = [2, 2];

/// Flag for metadata after the header.
const HAS_METADATA: u16 = 0x8000;

/// Limit on the nesting of metadata, which the decoder reads recursively.
const MAX_DEPTH: usize = 16;

/// Bytes per face in one corner table.
const CORNERS: u64 = 12;

/// Checks that the faces declared by a stream, and a corner table for each attribute with its own
/// seams, stay within a ceiling.
///
/// # Errors
/// The reason, without the place.
/// # References
/// [ZSG17]; the layout is that of the bitstream's specification, version 2.2.
pub(crate) fn check(stream: &[u8], ceiling: &Ceiling) -> Result<(), String> {
    let mut front = Front(stream);
    let counts = front.counts()?.ok_or("its Draco stream ends in its header; export it again")?;
    if counts.faces > ceiling.faces as u64 {
        let (found, declared) = (counts.faces, ceiling.faces);
        return Err(format!(
            "its Draco stream has {found} faces, but its accessors have room for {declared}; \
             export it again"
        ));
    }
    let bytes = counts.faces.saturating_mul(CORNERS * (1 + counts.tables));
    if bytes > ceiling.bytes as u64 {
        return Err(TOO_LARGE.to_owned());
    }
    Ok(())
}

struct StreamCounts {
    faces: u64,
    /// Number of attributes with their own connectivity.
    tables: u64,
}

/// Rest of a stream.
struct Front<'a>(&'a [u8]);

impl Front<'_> {
    /// Reads up to the counts; `None` if the stream ends before them.
    fn counts(&mut self) -> Result<Option<StreamCounts>, String> {
        let Some((&[d, r, a, c, o, major, minor, kind, method, low, high], rest)) =
            self.0.split_first_chunk()
        else {
            return Ok(None);
        };
        self.0 = rest;
        if &[d, r, a, c, o] != b"DRACO" || kind != 1 {
            return Err("its stream is not a mesh compressed by Draco; export it again".to_owned());
        }
        if [major, minor] != VERSION {
            return Err(format!(
                "its Draco stream is of version {major}.{minor}; export it again by a program that \
                 writes 2.2"
            ));
        }
        if u16::from_le_bytes([low, high]) & HAS_METADATA != 0 && self.skip_metadata()?.is_none() {
            return Ok(None);
        }
        Ok(if method == 1 { self.edgebreaker() } else { self.sequential() })
    }

    fn edgebreaker(&mut self) -> Option<StreamCounts> {
        let _traversal = self.byte()?;
        let _vertices = self.varint()?;
        Some(StreamCounts { faces: self.varint()?, tables: self.byte()?.into() })
    }

    fn sequential(&mut self) -> Option<StreamCounts> {
        Some(StreamCounts { faces: self.varint()?, tables: 0 })
    }

    /// Skips the metadata of all attributes, then those of the mesh.
    fn skip_metadata(&mut self) -> Result<Option<()>, String> {
        let Some(attributes) = self.varint() else { return Ok(None) };
        for _ in 0..attributes {
            if self.varint().is_none() || self.skip_entries(0)?.is_none() {
                return Ok(None);
            }
        }
        self.skip_entries(0)
    }

    fn skip_entries(&mut self, depth: usize) -> Result<Option<()>, String> {
        if depth > MAX_DEPTH {
            return Err(format!(
                "its Draco stream has metadata nested deeper than {MAX_DEPTH}; export it without"
            ));
        }
        let Some(entries) = self.varint() else { return Ok(None) };
        for _ in 0..entries {
            let value = self.skip_name().and_then(|()| self.varint());
            if value.and_then(|length| self.skip(length)).is_none() {
                return Ok(None);
            }
        }
        let Some(parts) = self.varint() else { return Ok(None) };
        for _ in 0..parts {
            if self.skip_name().is_none() || self.skip_entries(depth + 1)?.is_none() {
                return Ok(None);
            }
        }
        Ok(Some(()))
    }

    fn skip_name(&mut self) -> Option<()> {
        let length = self.byte()?;
        self.skip(length.into())
    }

    fn skip(&mut self, length: u64) -> Option<()> {
        self.0 = self.0.get(usize::try_from(length).ok()?..)?;
        Some(())
    }

    fn byte(&mut self) -> Option<u8> {
        let (&first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(first)
    }

    /// Reads a number in groups of seven bits, the lowest first.
    fn varint(&mut self) -> Option<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(number);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Version 2.2 of a mesh by this method, with metadata or not, then `rest`.
    fn stream(method: u8, flags: u16, rest: &[u8]) -> Vec<u8> {
        [b"DRACO\x02\x02\x01", &[method][..], &flags.to_le_bytes(), rest].concat()
    }

    fn check_within(stream: &[u8], faces: usize, bytes: usize) -> Result<(), String> {
        check(stream, &Ceiling { faces, bytes })
    }

    #[test]
    fn faces_and_tables_are_bounded() {
        // 4 vertices, 300 faces, 2 tables.
        let edgebreaker = stream(1, 0, &[0, 4, 0xac, 0x02, 2]);
        assert_eq!(check_within(&edgebreaker, 300, 3 * 300 * 12), Ok(()));
        let error = check_within(&edgebreaker, 300, 3 * 300 * 12 - 1).unwrap_err();
        assert_eq!(error, TOO_LARGE);
        let error = check_within(&edgebreaker, 299, usize::MAX).unwrap_err();
        assert!(error.contains("300 faces") && error.contains("room for 299"), "{error}");
        let sequential = stream(0, 0, &[0xac, 0x02]);
        assert_eq!(check_within(&sequential, 300, 300 * 12), Ok(()));
        assert!(check_within(&sequential, 300, 300 * 12 - 1).is_err());
    }

    #[test]
    fn metadata_are_skipped_as_deep_as_they_may_be() {
        // One attribute, 7, with an entry "a" of two bytes; then parts "p" in each other.
        let nested = |depth: usize| {
            let mut rest = vec![1, 7, 1, 1, b'a', 2, 9, 9, 0];
            rest.extend([0, 1, 1, b'p'].repeat(depth));
            rest.extend([0, 0, 5]);
            stream(0, HAS_METADATA, &rest)
        };
        assert_eq!(check_within(&nested(MAX_DEPTH), 5, 60), Ok(()));
        assert!(check_within(&nested(MAX_DEPTH), 4, 60).is_err());
        let error = check_within(&nested(MAX_DEPTH + 1), 5, 60).unwrap_err();
        assert!(error.contains("nested deeper"), "{error}");
        let whole = nested(2);
        for end in 0..whole.len() {
            assert!(check_within(&whole[..end], 5, 60).is_err(), "{end} bytes");
        }
    }

    #[test]
    fn other_streams_are_refused_by_what_they_are() {
        let cloud = b"DRACO\x02\x02\0\0\0\0\x05";
        assert!(check_within(cloud, 9, 999).unwrap_err().contains("not a mesh"));
        let old = b"DRACO\x01\x01\x01\0\0\0\x05";
        assert!(check_within(old, 9, 999).unwrap_err().contains("version 1.1"));
        let endless = stream(0, 0, &[0xff; 12]);
        assert!(check_within(&endless, 9, 999).unwrap_err().contains("ends in its header"));
    }
}
