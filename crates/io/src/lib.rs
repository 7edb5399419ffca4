//! Reads and writes mesh files: PLY, OBJ, STL, OFF, SMF and glTF.
//!
//! Every format has a module of its own that turns bytes into a mesh or scene, or a typed error.
//!
//! [`read()`] and [`write()`] choose the format by the file's suffix. The contents of a file are a
//! [`Scene`], and [`Scene::flatten`] merges it into one mesh. A scene read from glTF keeps its
//! document, so that writing it back as glTF replaces only the geometry.
//!
//! ```
//! use meshlod_io::{Format, ReadOptions, read_bytes};
//!
//! let off = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
//! let scene = read_bytes(off, Format::Off, &mut |_| None, &ReadOptions::default())?;
//! assert_eq!(scene.into_mesh().faces.len(), 1);
//! # Ok::<(), meshlod_io::ParseError>(())
//! ```
#![forbid(unsafe_code)]

#[cfg(feature = "draco")]
mod contained;
mod error;
mod files;
mod flatten;
mod format;
pub mod gltf;
mod image_file;
mod influences;
mod limits;
mod line_writer;
mod material;
pub mod meshopt;
mod normals;
mod notes;
pub mod obj;
pub mod off;
pub mod ply;
mod polygon;
mod precision;
mod remarks;
mod replace;
mod scene;
pub mod smf;
mod staged;
pub mod stl;
mod text_cursor;
mod vertex_attributes;

pub use error::{FileLocation, IoError, ParseError, Unsupported};
pub use files::{
    ReadOptions, Resolve, Weld, WriteOptions, read, read_bytes, write, write_compressed,
    write_lods, write_strips,
};
pub use flatten::{MeshInstance, transform};
pub use format::Format;
pub use image_file::ImageHeader;
pub use limits::merged_instances;
pub use material::{Material, MtlMap, MtlStatement, Shading};
pub use meshlod_mesh::{merge_equal_wedges, weld};
pub use notes::{Note, NoteKind};
pub use precision::Precision;
pub use replace::{abandon_files, check_place, remove_abandoned, write_file};
pub use scene::{Image, Node, Scene, SceneMesh};
