//! GLB container: a JSON chunk and a binary chunk in one file.

use std::ops::Range;

use super::extensions::OLD;
use crate::error::{ParseError, Unsupported};

const MAGIC: &[u8; 4] = b"glTF";
const JSON: &[u8; 4] = b"JSON";
const BIN: &[u8; 4] = b"BIN\0";
const HEADER: usize = 12;

/// Reader of four bytes at a place of a file.
pub(crate) type Word<'w> = &'w dyn Fn(usize) -> Result<[u8; 4], ParseError>;

/// Places of the chunks of a GLB in its file.
pub(crate) struct Chunks {
    pub json: Range<usize>,
    pub bin: Option<Range<usize>>,
}

/// Splits a file into JSON and binary chunk; a file without the GLB magic is JSON only.
pub(crate) fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ParseError> {
    if !is_glb(bytes) {
        return plain_json(bytes).map(|json| (json, None));
    }
    let word = |at: usize| Ok(bytes[at..].first_chunk().copied().unwrap_or_default());
    let Chunks { json, bin } = chunks(bytes.len(), &word)?;
    Ok((unpadded(&bytes[json]), bin.map(|bin| &bytes[bin])))
}

/// Reports whether a file that begins so is a GLB.
pub(crate) fn is_glb(begins: &[u8]) -> bool {
    begins.starts_with(MAGIC)
}

/// Returns the JSON of a chunk without the padding of some writers, zeros instead of spaces.
pub(crate) fn unpadded(json: &[u8]) -> &[u8] {
    &json[..json.len() - json.iter().rev().take_while(|&&byte| byte == 0).count()]
}

/// Finds the chunks of a GLB of this length; `word` reads four bytes at a place, which are there.
pub(crate) fn chunks(length: usize, word: Word<'_>) -> Result<Chunks, ParseError> {
    let version = number(length, 4, word)?;
    if version != 2 {
        return Err(ParseError::byte(
            4,
            match version {
                1 => format!("a GLB of glTF 1.0; only 2.0 is supported{OLD}"),
                _ => format!("GLB version {version}; only version 2 is supported"),
            },
        ));
    }
    let declared = number(length, 8, word)?;
    if declared < HEADER || declared > length {
        let reason = format!("the header declares {declared} bytes, but the file has {length}");
        return Err(ParseError::byte(8, reason));
    }
    let (kind, json) = chunk(declared, HEADER, word)?;
    if &kind != JSON {
        return Err(ParseError::byte(HEADER + 4, "the first chunk of a GLB must be JSON"));
    }
    // Chunks of other types are extensions and may be skipped; only the second chunk may be BIN.
    if json.end == declared {
        return Ok(Chunks { json, bin: None });
    }
    let (kind, bin) = chunk(declared, json.end, word)?;
    Ok(Chunks { json, bin: (&kind == BIN).then_some(bin) })
}

/// Joins JSON and binary chunk into a GLB file.
pub(crate) fn join(json: &[u8], bin: &[u8]) -> Result<Vec<u8>, Unsupported> {
    let padded = |chunk: &[u8]| chunk.len().next_multiple_of(4);
    let bin_size = if bin.is_empty() { 0 } else { 8 + padded(bin) };
    let length = HEADER + 8 + padded(json) + bin_size;
    let Ok(total) = u32::try_from(length) else {
        let reason = format!("{length} bytes exceed the 4 GB limit of GLB; write .gltf instead");
        return Err(Unsupported::new("file", reason));
    };
    let mut out = Vec::with_capacity(length);
    out.extend_from_slice(MAGIC);
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&total.to_le_bytes());
    let mut push = |kind: &[u8; 4], chunk: &[u8], fill: u8| {
        out.extend_from_slice(&(padded(chunk) as u32).to_le_bytes());
        out.extend_from_slice(kind);
        out.extend_from_slice(chunk);
        out.resize(out.len().next_multiple_of(4), fill);
    };
    push(JSON, json, b' ');
    if !bin.is_empty() {
        push(BIN, bin, 0);
    }
    Ok(out)
}

pub(crate) fn plain_json(bytes: &[u8]) -> Result<&[u8], ParseError> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    match text.first() {
        Some(b'{') => Ok(text),
        Some(b'<') => Err(ParseError::part(
            "header",
            "this is a web page (HTML), not glTF; download the file itself",
        )),
        Some(_) => Err(ParseError::part(
            "header",
            "neither GLB (it does not start with \"glTF\") nor JSON",
        )),
        None => Err(ParseError::part("header", "the file is empty")),
    }
}

fn chunk(length: usize, at: usize, word: Word<'_>) -> Result<([u8; 4], Range<usize>), ParseError> {
    let start = at + 8;
    if start > length {
        return Err(ends(at));
    }
    let (size, kind) = (number(length, at, word)?, word(at + 4)?);
    let left = length - start;
    if size > left {
        let reason = format!("the chunk declares {size} bytes, but only {left} are left");
        return Err(ParseError::byte(at, reason));
    }
    Ok((kind, start..start + size))
}

fn number(length: usize, at: usize, word: Word<'_>) -> Result<usize, ParseError> {
    if at + 4 > length {
        return Err(ends(at));
    }
    word(at).map(|word| u32::from_le_bytes(word) as usize)
}

fn ends(at: usize) -> ParseError {
    ParseError::byte(at, "the file ends inside a GLB header")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_joined_comes_apart_again() {
        let glb = join(b"{}", b"12345").unwrap();
        assert_eq!(glb.len() % 4, 0);
        assert_eq!(split(&glb).unwrap(), (&b"{}  "[..], Some(&b"12345\0\0\0"[..])));
        assert_eq!(split(&join(b"{  }", b"").unwrap()).unwrap(), (&b"{  }"[..], None));
    }

    #[test]
    fn every_cut_of_a_glb_is_an_error() {
        let glb = join(b"{}", b"12345").unwrap();
        for end in 0..glb.len() {
            split(&glb[..end]).unwrap_err();
        }
    }

    #[test]
    fn lengths_that_lie_are_errors() {
        let glb = join(b"{}", b"12345").unwrap();
        for (at, value) in [(8, 0u32), (8, 11), (8, u32::MAX), (12, u32::MAX), (24, u32::MAX)] {
            let mut wrong = glb.clone();
            wrong[at..at + 4].copy_from_slice(&value.to_le_bytes());
            split(&wrong).unwrap_err();
        }
    }

    #[test]
    fn a_web_page_is_called_one() {
        let error = split(b"\n\n<!DOCTYPE html>").unwrap_err().to_string();
        assert!(error.contains("web page"), "{error}");
    }
}
