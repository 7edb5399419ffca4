//! Options for reading and writing mesh files.

use serde::{Deserialize, Serialize};

use crate::precision::Precision;

/// Policy for merging vertices at equal or close positions when a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weld {
    /// Keeps the vertices as they are in the file.
    Off,
    /// Merges vertices at bit-identical positions in glTF and STL, which split vertices at seams.
    ///
    /// Each set of attributes of a merged vertex becomes a wedge. Other formats index their
    /// vertices and are left as they are.
    #[default]
    Exact,
    /// Merges vertices within this distance of each other, in model units, in every format.
    Within(f64),
}

/// Options for reading a mesh file with [`read()`](crate::read) or
/// [`read_bytes`](crate::read_bytes).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReadOptions {
    /// Policy for merging vertices.
    pub weld: Weld,
}

/// Options for writing a mesh file with [`write()`](crate::write()).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WriteOptions {
    /// Precision of coordinates in PLY, OBJ, OFF, SMF and text STL. Binary STL and glTF always use
    /// 32 bits; glTF stores them relative to the centre of the mesh where necessary, see
    /// [`gltf::write_glb`](crate::gltf::write_glb).
    pub precision: Precision,
}

/// Callback that loads the files a mesh file refers to by name: buffers, images, material
/// libraries.
///
/// Takes the name in the file, with `%20` and other escapes decoded, and returns `None` if the file
/// does not exist.
pub type Resolve<'a> = &'a mut dyn FnMut(&str) -> Option<Vec<u8>>;
