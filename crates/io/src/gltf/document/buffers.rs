//! Buffers of a document: loaded from the GLB chunk, data URIs and files.

use serde_json::Value;

use super::extensions::MESHOPT;
use super::schema::Buffer;
use super::uri::Uri;
use super::{schema, uri};
use crate::error::ParseError;
use crate::options::Resolve;

/// Buffers of a document.
#[derive(Debug)]
pub(crate) struct Buffers {
    pub bytes: Vec<Vec<u8>>,
    /// Bytes in the file, before decompression.
    pub stored: usize,
}

impl Buffers {
    pub fn new(bytes: Vec<Vec<u8>>) -> Self {
        Self { stored: bytes.iter().map(Vec::len).sum(), bytes }
    }
}

/// Loads the buffers of a document from the GLB chunk, data URIs and files. Fallback buffers are
/// left empty.
pub(crate) fn load(
    json: &Value,
    chunk: Option<&[u8]>,
    resolve: Resolve<'_>,
) -> Result<Buffers, ParseError> {
    let declared: Vec<Buffer> = schema::array(json, "buffers", "buffer")?;
    let load = |(i, buffer): (usize, &Buffer)| {
        let named = buffer.uri.is_some() || (i == 0 && chunk.is_some());
        if is_fallback(&json["buffers"][i]) || !named && is_decompression_target(json, i) {
            return Ok(Vec::new());
        }
        let wrong = |reason| ParseError::part(format!("buffer {i}"), reason);
        let bytes = match (&buffer.uri, chunk) {
            (None, Some(chunk)) if i == 0 => chunk.to_vec(),
            (None, _) => return Err(wrong("has neither a URI nor a GLB chunk".to_owned())),
            (Some(uri), _) => match uri::parse(uri).map_err(wrong)? {
                Uri::Data(bytes) => bytes,
                Uri::File(name) => resolve(&name).ok_or_else(|| {
                    wrong(format!("refers to the file {name:?}, which cannot be read"))
                })?,
            },
        };
        if bytes.len() < buffer.byte_length {
            let (found, expected) = (bytes.len(), buffer.byte_length);
            return Err(wrong(format!("has {found} bytes, but {expected} are declared")));
        }
        Ok(bytes)
    };
    let bytes = declared.iter().enumerate().map(load).collect::<Result<_, _>>()?;
    Ok(Buffers::new(bytes))
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
