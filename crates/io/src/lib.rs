//! Mesh files in and out, one format a module: bytes in, typed errors out.
//!
//! [`read()`] and [`write()`] go by path, and the suffix decides. What a file holds is a [`Scene`];
//! [`Scene::flatten`] makes one mesh of it. A scene from glTF keeps its document, so that writing
//! it as glTF changes geometry alone.
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
mod flatten;
mod format;
pub mod gltf;
mod line_writer;
pub mod meshopt;
pub mod obj;
pub mod off;
pub mod ply;
mod polygon;
mod replace;
mod scene;
pub mod smf;
pub mod stl;
mod text_cursor;
mod vertex_attributes;

pub use error::{FileLocation, IoError, ParseError, Unsupported};
pub use files::{
    ReadOptions, Resolve, Weld, WriteOptions, read, read_bytes, write, write_compressed, write_lods,
};
pub use flatten::MeshInstance;
pub use format::Format;
pub use meshlod_mesh::{merge_equal_wedges, weld};
pub use replace::{abandon_files, write_file};
pub use scene::{Image, Material, Node, Scene, SceneMesh};

/// How coordinates are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// As 32-bit floats: what most programs read.
    #[default]
    F32,
    /// As 64-bit floats, bit for bit.
    F64,
}
