//! Buffers of a document: the GLB chunk, data URIs and files, in memory or left where they are.

use std::borrow::Cow;
use std::io;
use std::sync::Arc;

use serde_json::Value;

use super::extensions::MESHOPT;
use super::schema::Buffer;
use super::stored::{ScratchFile, StoreFiles, StoredBytes};
use super::uri::Uri;
use super::{missing, schema, uri};
use crate::error::ParseError;

/// Buffers of a document.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    pub parts: Vec<BufferPart>,
    /// Bytes in the file, before decompression.
    pub stored: usize,
    /// Files that decompressed bytes go into; without them they stay in memory.
    pub files: Option<Arc<dyn StoreFiles>>,
}

/// Bytes of a buffer.
#[derive(Debug)]
pub(crate) enum BufferPart {
    Held(Vec<u8>),
    Stored(StoredBytes),
}

impl BufferPart {
    /// Returns the number of bytes.
    pub fn length(&self) -> usize {
        match self {
            Self::Held(bytes) => bytes.len(),
            Self::Stored(stored) => stored.length,
        }
    }
}

impl Buffers {
    pub fn new(bytes: Vec<Vec<u8>>) -> Self {
        Self::of(bytes.into_iter().map(BufferPart::Held).collect())
    }

    fn of(parts: Vec<BufferPart>) -> Self {
        let stored = parts.iter().map(BufferPart::length).sum();
        Self { parts, stored, files: None }
    }

    /// Returns a buffer by index.
    pub fn part(&self, index: usize) -> Result<&BufferPart, ParseError> {
        self.parts.get(index).ok_or_else(|| missing("buffer", index, self.parts.len()))
    }

    /// Returns some bytes of a buffer; `None` if they are not all in it.
    pub fn range(
        &self,
        index: usize,
        at: usize,
        length: usize,
    ) -> Result<Option<Cow<'_, [u8]>>, ParseError> {
        let part = self.part(index)?;
        match at.checked_add(length) {
            Some(end) if end <= part.length() => {}
            _ => return Ok(None),
        }
        Ok(Some(match part {
            BufferPart::Held(bytes) => Cow::Borrowed(&bytes[at..at + length]),
            BufferPart::Stored(stored) => {
                let failed = |error: io::Error| {
                    let reason = format!("{length} bytes at {at} cannot be read: {error}");
                    ParseError::part(format!("buffer {index}"), reason)
                };
                Cow::Owned(stored.read(at, length).map_err(failed)?)
            }
        }))
    }

    /// Returns the bytes of a buffer in memory, as those of all scenes are.
    pub fn held(&self, index: usize) -> &[u8] {
        match self.parts.get(index) {
            Some(BufferPart::Held(bytes)) => bytes,
            _ => &[],
        }
    }

    /// Begins a buffer, which will be the next one.
    pub fn grow(&self) -> Growing {
        Growing { files: self.files.clone(), scratch: None, held: Vec::new(), length: 0 }
    }

    /// Adds a buffer unless it is empty.
    pub fn push(&mut self, growing: Growing) -> Result<(), ParseError> {
        if growing.length > 0 {
            self.parts.push(growing.finish().map_err(not_kept)?);
        }
        Ok(())
    }
}

/// Buffer in the making: in memory, or in a file.
pub(crate) struct Growing {
    files: Option<Arc<dyn StoreFiles>>,
    scratch: Option<Box<dyn ScratchFile>>,
    held: Vec<u8>,
    length: usize,
}

impl Growing {
    /// Returns the number of bytes.
    pub fn len(&self) -> usize {
        self.length
    }

    /// Appends bytes at the next multiple of 8; returns where they begin.
    pub fn add(&mut self, bytes: &[u8]) -> Result<usize, ParseError> {
        let start = self.length.next_multiple_of(8);
        let gap = start - self.length;
        self.length = start + bytes.len();
        let Some(files) = &self.files else {
            self.held.resize(start, 0);
            self.held.extend_from_slice(bytes);
            return Ok(start);
        };
        if self.scratch.is_none() {
            self.scratch = Some(files.scratch().map_err(not_kept)?);
        }
        if let Some(scratch) = &mut self.scratch {
            scratch.add(&[0; 8][..gap]).and_then(|()| scratch.add(bytes)).map_err(not_kept)?;
        }
        Ok(start)
    }

    fn finish(self) -> io::Result<BufferPart> {
        Ok(match self.scratch {
            Some(scratch) => {
                BufferPart::Stored(StoredBytes::new(scratch.finish()?, 0..self.length as u64))
            }
            None => BufferPart::Held(self.held),
        })
    }
}

fn not_kept(error: io::Error) -> ParseError {
    ParseError::part("decompressed geometry", format!("cannot be kept in a file: {error}"))
}

/// Loads the buffers of a document from the GLB chunk, data URIs and files. Fallback buffers are
/// left empty.
pub(crate) fn load(
    json: &Value,
    mut chunk: Option<BufferPart>,
    resolve: &mut dyn FnMut(&str) -> Option<BufferPart>,
) -> Result<Buffers, ParseError> {
    let declared: Vec<Buffer> = schema::array(json, "buffers", "buffer")?;
    let load = |(i, buffer): (usize, &Buffer)| {
        let named = buffer.uri.is_some() || (i == 0 && chunk.is_some());
        if is_fallback(&json["buffers"][i]) || !named && is_decompression_target(json, i) {
            return Ok(BufferPart::Held(Vec::new()));
        }
        let wrong = |reason| ParseError::part(format!("buffer {i}"), reason);
        let part = match (&buffer.uri, if i == 0 { chunk.take() } else { None }) {
            (None, Some(chunk)) => chunk,
            (None, None) => return Err(wrong("has neither a URI nor a GLB chunk".to_owned())),
            (Some(uri), _) => match uri::parse(uri).map_err(wrong)? {
                Uri::Data(bytes) => BufferPart::Held(bytes),
                Uri::File(name) => resolve(&name).ok_or_else(|| {
                    wrong(format!("refers to the file {name:?}, which cannot be read"))
                })?,
            },
        };
        if part.length() < buffer.byte_length {
            let (found, expected) = (part.length(), buffer.byte_length);
            return Err(wrong(format!("has {found} bytes, but {expected} are declared")));
        }
        Ok(part)
    };
    let parts = declared.iter().enumerate().map(load).collect::<Result<_, _>>()?;
    Ok(Buffers::of(parts))
}

/// Reports whether a buffer is only a fallback, into which compressed views are decoded.
pub(crate) fn is_fallback(buffer: &Value) -> bool {
    MESHOPT.iter().any(|name| buffer["extensions"][*name]["fallback"] == true)
}

/// Reports whether a compressed view is decoded into a buffer.
pub(crate) fn is_decompression_target(json: &Value, buffer: usize) -> bool {
    let views = json.get("bufferViews").and_then(Value::as_array);
    let mut of_buffer = views.into_iter().flatten().filter(|view| view["buffer"] == buffer);
    of_buffer.any(|view| MESHOPT.iter().any(|name| view["extensions"].get(name).is_some()))
}
