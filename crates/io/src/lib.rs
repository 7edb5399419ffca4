//! Reads and writes mesh files: PLY, OBJ, STL, OFF, SMF and glTF.
//!
//! Each format has its own module, which turns bytes into a mesh or scene, or a typed error.
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

mod error;
mod files;
mod format;
pub mod gltf;
mod limits;
mod memory;
pub mod meshopt;
mod notes;
pub mod obj;
pub mod off;
mod options;
pub mod ply;
mod polygon;
mod precision;
mod remarks;
mod scene;
pub mod smf;
pub mod stl;
mod text;
mod vertex_attributes;

pub use error::{FileLocation, IoError, ParseError, Unsupported};
pub use files::replace::{
    abandon_files, check_place, remove_abandoned, write_file, write_file_with,
};
pub use files::{
    WrittenFile, finish_obj_stream, open_gltf_stream, read, write, write_compressed, write_lods,
    write_needle, write_ply_stream, write_strips,
};
pub use format::{Format, StoredDigits};
pub use limits::merged_instances;
pub use memory::{read_bytes, write_to};
pub use meshlod_mesh::{merge_equal_wedges, weld};
pub use notes::{Note, NoteKind, grouped};
pub use options::{ReadOptions, Resolve, Weld, WriteOptions};
pub use polygon::triangulate;
pub use precision::Precision;
pub use scene::flatten::{MeshInstance, transform};
pub use scene::image_file::ImageHeader;
pub use scene::material::{Material, MtlMap, MtlStatement, Shading};
pub use scene::{Image, Node, Scene, SceneMesh};
