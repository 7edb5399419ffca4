//! Facts about a file format: its names, its reader and writer, and the parts of a scene it holds.

use std::io::{self, Write};

use super::Format;
use crate::error::ParseError;
use crate::options::{Resolve, Weld};
use crate::precision::Precision;
use crate::scene::Scene;

/// Row of the [table of formats](super::table::TABLE).
#[derive(Clone, Copy)]
pub(crate) struct FormatFacts {
    pub format: Format,
    /// Suffixes of file names in lower case; the first one names the format.
    pub suffixes: &'static [&'static str],
    /// Parses a file. Only formats with [`VertexSharing::PerPrimitive`] weld vertices themselves.
    pub read: fn(&[u8], Resolve<'_>, Weld) -> Result<Scene, ParseError>,
    /// Writes a scene as one file, without the files beside it.
    pub write: fn(&Scene, Precision, &mut dyn Write) -> io::Result<()>,
    pub stores: Stores,
}

/// Parts of a scene that files of a format store, and how.
#[derive(Clone, Copy)]
pub(crate) struct Stores {
    pub holds: Holds,
    pub vertices: VertexSharing,
    pub coordinates: Coordinates,
    pub layers: HeldLayers,
    pub seams: SeamSplits,
    /// True if colours of vertices keep their opacity.
    pub has_opacity: bool,
    pub comments: Comments,
    /// True if a scene of several solids is written as text, with their names.
    pub has_solids: bool,
}

/// Parts of a scene that a format has a place for, beside a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Holds {
    /// Everything, as a glTF document with buffers and images.
    Document,
    /// Materials and their images, named by a library beside the file.
    Library,
    /// Textures beside the file, scalars at faces and comments.
    Properties,
    /// Nothing: the file is one mesh.
    MeshAlone,
}

/// Relation of the vertices in a file to those of its mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum VertexSharing {
    /// Faces index the vertices, and vertices without faces are kept.
    Indexed,
    /// Each primitive has vertices of its own, split where their attributes differ.
    PerPrimitive,
    /// Each corner of a face is a vertex.
    PerCorner,
}

/// Number type of coordinates in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Coordinates {
    /// 32-bit floats.
    Binary32,
    /// 32-bit or 64-bit floats, as the precision says.
    Binary,
    /// Decimal text of 32-bit or 64-bit floats, as the precision says.
    Decimal,
}

/// Vertex attributes that a format stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HeldLayers {
    /// No attributes.
    None,
    /// Normals, the first texture coordinates and the first colours.
    Basic,
    /// Normals, the first colours, and the texture coordinates that a material uses.
    BasicByMaterial,
    /// All attributes.
    All,
}

/// Attributes whose seams split vertices in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SeamSplits {
    /// No attributes: seams are stored as such, or noted elsewhere.
    None,
    /// Colours alone.
    Colors,
    /// All attributes.
    All,
}

/// Place of the comments of a scene in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Comments {
    /// No place: they are left out.
    None,
    /// Lines that begin with `#`.
    Lines,
    /// A place of the format's own, which its reader and writer know.
    Own,
}

/// Number format in which a file stores coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoredDigits {
    /// 32-bit floats.
    F32,
    /// 64-bit floats, in binary or as decimal text that reads back as the same value.
    F64,
    /// Decimal text of 32-bit floats, usually read back as 64-bit floats of other values.
    Decimal,
}
