//! Files of a recording by name, as they are read.

use serde::de::DeserializeOwned;

use crate::recording::npy::{self, Array, Element};
use crate::recording::{RecordingError, VERSION};

/// Where the files of a recording come from: a closure that returns the bytes of a name, or the
/// reason why it cannot.
pub struct Source<'a> {
    load: Box<Load<'a>>,
}

/// Function that returns the bytes of a file, or the reason why it cannot.
type Load<'a> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'a;

impl<'a> Source<'a> {
    /// Creates a source; `load` gets names without folders, such as `scene.json`.
    pub fn new(load: impl FnMut(&str) -> Result<Vec<u8>, String> + 'a) -> Self {
        Self { load: Box::new(load) }
    }

    /// Returns the bytes of a file.
    pub(super) fn bytes(&mut self, file: &str) -> Result<Vec<u8>, RecordingError> {
        let missing = |reason| RecordingError::Missing { file: file.into(), reason };
        // Names of mesh files come from `scene.json`, which is not trusted.
        if file.is_empty() || file.contains(['/', '\\', ':']) || file.starts_with('.') {
            return Err(missing("not a file name within the folder".into()));
        }
        (self.load)(file).map_err(missing)
    }

    /// Reads a JSON file whose object has a `version`.
    pub(super) fn json<T: DeserializeOwned>(&mut self, file: &str) -> Result<T, RecordingError> {
        let bytes = self.bytes(file)?;
        let broken = |error: serde_json::Error| RecordingError::Json {
            file: file.into(),
            reason: error.to_string(),
        };
        // The version comes first: other errors of a later version mean nothing.
        let Versioned { version } = serde_json::from_slice(&bytes).map_err(broken)?;
        if version != VERSION {
            return Err(RecordingError::Version { file: file.into(), found: version });
        }
        serde_json::from_slice(&bytes).map_err(broken)
    }

    /// Reads an array; `None` stands for any length along an axis.
    pub(super) fn array<T: Element>(
        &mut self,
        file: &str,
        shape: &[Option<usize>],
    ) -> Result<Array<T>, RecordingError> {
        let bytes = self.bytes(file)?;
        let array = npy::read::<T>(&bytes)
            .map_err(|error| RecordingError::Array { file: file.into(), error })?;
        let fits = |(found, wanted): (&usize, &Option<usize>)| wanted.is_none_or(|n| n == *found);
        if array.shape.len() == shape.len() && array.shape.iter().zip(shape).all(fits) {
            return Ok(array);
        }
        let side = |n: &Option<usize>| n.map_or("any".into(), |n| n.to_string());
        let expected = shape.iter().map(side).collect::<Vec<_>>().join(", ");
        let expected = format!("[{expected}]");
        Err(RecordingError::Shape { file: file.into(), found: array.shape, expected })
    }
}

/// The version of a JSON file.
#[derive(serde::Deserialize)]
struct Versioned {
    version: u32,
}
